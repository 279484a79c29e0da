#include "check/pose_check.h"

#include <algorithm>

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

PoseCheck::PoseCheck(std::shared_ptr<const CheckedRobot> robot, double old_periods)
    : robot_(std::move(robot)),
      collision_body_(robot_->collisionBody()),
      occlusion_body_(robot_->occlusionBody()),
      occlusion_(robot_->config().occlusion, linksOf(robot_->model(), occlusion_body_.shapes),
                 old_periods) {}

void PoseCheck::check(const CuboidMap& map, const Posture& posture, PoseFindings& findings) {
  findContacts(map, posture, findings);
  findOcclusion(map, posture, findings);
}

void PoseCheck::findContacts(const CuboidMap& map, const Posture& posture, PoseFindings& findings) {
  collision_body_.place(posture);
  robot_->collision().find(map, collision_body_.body, findings.contacts);
  for (Contact& contact : findings.contacts) {
    contact.shape = static_cast<std::uint32_t>(collision_body_.shapes[contact.shape]);
  }
  findings.collision = !findings.contacts.empty();
}

void PoseCheck::findOcclusion(const CuboidMap& map, const Posture& posture,
                              PoseFindings& findings) {
  findings.links.clear();
  findings.occluding_cuboids.clear();
  findings.occlusion = false;
  if (!robot_->config().check_occlusion) return;
  occlusion_body_.place(posture);
  const OcclusionCheck::Result& hidden = occlusion_.find(map, occlusion_body_.body);
  findings.links = hidden.links;
  findings.occluding_cuboids.reserve(hidden.cuboids.capacity());
  findings.occluding_cuboids = hidden.cuboids;
  findings.occlusion =
      std::any_of(hidden.links.begin(), hidden.links.end(),
                  [this](const LinkVisibility& link) { return occlusion_.isOccluded(link); });
}

std::string PoseCheck::mostHiddenLink(const PoseFindings& findings) const {
  const LinkVisibility* most = nullptr;
  for (const LinkVisibility& link : findings.links) {
    if (!occlusion_.isOccluded(link)) continue;
    if (!most || link.occluded_fraction > most->occluded_fraction) most = &link;
  }
  return most ? robot_->model().links()[most->link] : std::string();
}

}  // namespace tccm
