#include "check/trajectory_check.h"

#include <algorithm>

#include "base/line_of.h"

namespace tccm {
namespace {

/// In the unit of CollisionCheck::work(): some 0.3 s. A trajectory of 100 points takes a
/// thousandth.
constexpr std::size_t kWorkMax = 60'000'000;
constexpr double kTravelMax = 1e4;         // [rad or m] of one joint; there is no need to begin
constexpr std::size_t kWorkOfPose = 30;    // for each joint and shape
constexpr double kSplineTolerance = 5e-4;  // [rad or m]

std::string atTime(const std::string& what, double time_s) {
  return lineOf("%.150s after %.3f s", what.c_str(), time_s);
}

}  // namespace

void TrajectoryCheck::Config::describe(ParameterTable& table) {
  table.add("trajectory_step_m", &step_m, "m", {1e-4, 0.1},
            "as `way_step_m`, for `check_trajectory`: a contact that is passed over is no deeper "
            "than half of it");
  table.add("trajectory_occlusion_poses", &occlusion_poses, "", {1, 1000},
            "so many waypoints, spread evenly, are looked at for occlusion");
}

TrajectoryCheck::TrajectoryCheck(const std::shared_ptr<const CheckedRobot>& robot,
                                 const Config& config, double clearance_radius_m,
                                 double old_periods)
    : robot_(robot),
      config_(validated(config)),
      pose_(robot, old_periods),
      way_(robot, config.step_m),
      clearance_radius_m_(clearance_radius_m),
      path_(robot->model->variables().size()) {}

TrajectoryAnswer TrajectoryCheck::check(const Surroundings& around,
                                        const JointTrajectory& trajectory,
                                        const std::vector<double>& from,
                                        const std::vector<Pose>& T_fixed_roots) {
  TrajectoryAnswer answer;
  const std::string defect = defectOf(trajectory, *robot_->model, from);
  if (!defect.empty()) {
    answer.cause = {Reason::kBadQuestion, defect};
    return answer;
  }
  if (!makePath(trajectory, *robot_->model, from, kSplineTolerance, path_)) return tooLong();
  path_.travelUntil(path_.end(), positions_);
  if (*std::max_element(positions_.begin(), positions_.end()) > kTravelMax) return tooLong();
  const Way way{around.map, path_, T_fixed_roots};
  if (!findClearances(way, trajectory, answer)) return tooLong();
  findCollision(way, trajectory, answer);
  if (way_.isTooLong()) return tooLong();
  if (answer.cause.reason == Reason::kClear && robot_->config.check_occlusion) {
    findOcclusion(around, way, trajectory, answer);
  }
  return answer;
}

TrajectoryAnswer TrajectoryCheck::tooLong() {
  TrajectoryAnswer answer;
  answer.cause = {Reason::kCheckLate,
                  "it is too long to judge within a second: ask for a part of it"};
  return answer;
}

bool TrajectoryCheck::findClearances(const Way& way, const JointTrajectory& trajectory,
                                     TrajectoryAnswer& answer) {
  const RobotModel& model = *robot_->model;
  const std::size_t begun = robot_->collision.work();
  const std::size_t each = kWorkOfPose * (model.joints().size() + model.shapes().size());
  for (std::size_t i = 0; i < trajectory.points.size(); ++i) {
    place(way, trajectory.points[i].time_s);
    answer.clearances_m.push_back(pose_.leastClearance(way.map, clearance_radius_m_));
    const std::size_t done = robot_->collision.work() - begun + (i + 1) * each;
    if (done > kWorkMax) return false;
    way_.allow(kWorkMax - done);
  }
  return true;
}

void TrajectoryCheck::place(const Way& way, double time_s) {
  way.path.positionsAt(time_s, positions_);
  pose_.place(positions_, way.T_fixed_roots);
}

void TrajectoryCheck::findCollision(const Way& way, const JointTrajectory& trajectory,
                                    TrajectoryAnswer& answer) {
  double from_s = way.path.begin();
  for (std::size_t i = 0; i < trajectory.points.size(); ++i) {
    const double to_s = trajectory.points[i].time_s;
    if (const auto found = way_.firstContact(way, from_s, to_s, i == 0)) {
      const std::string& link = robot_->model->linkOf(found->contact.shape);
      answer.index = i;
      answer.time_s = from_s + found->time_s;
      answer.contact = found->contact;
      answer.cause = {Reason::kCollision, atTime(link + " touches the map", answer.time_s), link};
      return;
    }
    from_s = to_s;
  }
}

void TrajectoryCheck::findOcclusion(const Surroundings& around, const Way& way,
                                    const JointTrajectory& trajectory, TrajectoryAnswer& answer) {
  const std::size_t points = trajectory.points.size();
  const auto poses = std::min(points, static_cast<std::size_t>(config_.occlusion_poses));
  for (std::size_t k = 1; k <= poses; ++k) {
    const std::size_t i = k * points / poses - 1;  // the last one is among them
    const double time_s = trajectory.points[i].time_s;
    place(way, time_s);
    pose_.findOcclusion(around, findings_);
    const std::string hidden = pose_.mostHiddenLink(findings_);
    if (hidden.empty()) continue;
    answer.index = i;
    answer.time_s = time_s;
    answer.cause = {Reason::kOcclusion, atTime(hidden + " is hidden from the sensor", time_s),
                    hidden};
    return;
  }
}

}  // namespace tccm
