#include "check/occlusion_judge.h"

namespace tccm {
namespace {

constexpr double kMoreVisible = 0.02;  // of a silhouette: the link comes out of its hiding place

/// Whether what the robot does uncovers every link that is hidden now, and hides no other.
bool comesOut(const Situation& situation) {
  // The links are the same at both poses.
  for (std::size_t i = 0; i < situation.here.links.size(); ++i) {
    const LinkVisibility& now = situation.here.links[i];
    const LinkVisibility& then = situation.ahead.links[i];
    if (situation.check_here.isOccluded(now)) {
      if (then.occluded_fraction > now.occluded_fraction - kMoreVisible) return false;
    } else if (situation.check_here.isOccluded(then)) {
      return false;
    }
  }
  return true;
}

}  // namespace

void OcclusionJudge::Config::describe(ParameterTable& table) {
  table.add("occlusion_stops", &stops, "a hidden link stops the robot; `false`: it slows it down",
            Tunable::kYes);
  table.add("occlusion_slow_scale", &slow_scale, "", {0.0, 1.0}, "to this speed scale");
}

OcclusionJudge::OcclusionJudge(std::shared_ptr<const CheckedRobot> robot, const Config& config,
                               double moving_out_scale)
    : robot_(std::move(robot)), config_(validated(config)), moving_out_scale_(moving_out_scale) {}

void OcclusionJudge::judge(const Situation& situation, Causes& causes) const {
  if (!situation.here.occlusion && !situation.ahead.occlusion) return;
  const bool ahead = !situation.here.occlusion;
  const std::string link =
      situation.check_here.mostHiddenLink(ahead ? situation.ahead : situation.here);
  if (!ahead && comesOut(situation)) {
    causes.push_back(Cause::slowing(Reason::kMovingOut, moving_out_scale_,
                                    link + " comes out of where it is hidden", link));
    return;
  }
  const Reason reason = ahead ? Reason::kOcclusionAhead : Reason::kOcclusion;
  const std::string text = link + " is hidden from the sensor" + (ahead ? " ahead" : "");
  causes.push_back(config_.stops ? Cause::stopping(reason, text, link)
                                 : Cause::slowing(reason, config_.slow_scale, text, link));
}

}  // namespace tccm
