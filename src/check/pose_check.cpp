#include "check/pose_check.h"

#include <algorithm>

#include "base/stopwatch.h"
#include "check/used_body.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

std::vector<std::uint32_t> linksOf(const RobotModel& model,
                                   const std::vector<std::size_t>& shapes) {
  std::vector<std::uint32_t> links;
  for (const std::size_t i : shapes) {
    links.push_back(static_cast<std::uint32_t>(model.shapes()[i].link));
  }
  return links;
}

}  // namespace

void PoseCheck::Config::validate() const {
  collision_use.validate(kCollisionKeys);
  occlusion_use.validate(kOcclusionKeys);
  collision.validate();
  occlusion.validate();
}

PoseCheck::PoseCheck(std::shared_ptr<const RobotModel> model, const Config& config)
    : model_(std::move(model)),
      config_((config.validate(), config)),
      kinematics_(model_),
      collision_used_(model_->shapesFor(config.collision_use, kCollisionKeys)),
      occlusion_used_(model_->shapesFor(config.occlusion_use, kOcclusionKeys)),
      collision_body_(bodyOf(*model_, collision_used_)),
      occlusion_body_(bodyOf(*model_, occlusion_used_)),
      collision_(config.collision),
      occlusion_(config.occlusion, linksOf(*model_, occlusion_used_.shapes)) {}

void PoseCheck::check(const CuboidMap& map, const std::vector<double>& positions,
                      const std::vector<Pose>& T_fixed_roots, PoseFindings& findings) {
  Stopwatch stopwatch;
  kinematics_.update(positions, T_fixed_roots);
  place(collision_used_.shapes, kinematics_.shapePoses(), collision_body_);
  const std::vector<Contact>& contacts = collision_.find(map, collision_body_);
  findings.contacts.reserve(contacts.capacity());  // once for all
  findings.contacts = contacts;
  for (Contact& contact : findings.contacts) {
    contact.shape = static_cast<std::uint32_t>(collision_used_.shapes[contact.shape]);
  }
  findings.collision = !findings.contacts.empty();
  findings.collision_us = stopwatch.lapMicroseconds();
  findings.links.clear();
  findings.occluding_cuboids.clear();
  findings.occlusion = false;
  if (!config_.check_occlusion) return;
  place(occlusion_used_.shapes, kinematics_.shapePoses(), occlusion_body_);
  const OcclusionCheck::Result& hidden = occlusion_.find(map, occlusion_body_);
  findings.links = hidden.links;
  findings.occluding_cuboids.reserve(hidden.cuboids.capacity());
  findings.occluding_cuboids = hidden.cuboids;
  findings.occlusion =
      std::any_of(hidden.links.begin(), hidden.links.end(),
                  [this](const LinkVisibility& link) { return occlusion_.isOccluded(link); });
  findings.occlusion_us = stopwatch.lapMicroseconds();
}

std::string PoseCheck::mostHiddenLink(const PoseFindings& findings) const {
  const LinkVisibility* most = nullptr;
  for (const LinkVisibility& link : findings.links) {
    if (!occlusion_.isOccluded(link)) continue;
    if (!most || link.occluded_fraction > most->occluded_fraction) most = &link;
  }
  return most ? model_->links()[most->link] : std::string();
}

}  // namespace tccm
