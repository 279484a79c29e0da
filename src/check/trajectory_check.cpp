#include "check/trajectory_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr double kSplineTolerance = 5e-4;  // [rad or m]

std::string atTime(const std::string& what, double time_s) {
  char text[200];
  std::snprintf(text, sizeof text, "%.150s after %.3f s", what.c_str(), time_s);
  return text;
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
      kinematics_(robot->sharedModel()),
      pose_(robot, old_periods),
      way_(robot, config.step_m, 0.0),
      clearance_(robot, clearance_radius_m),
      path_(robot->model().variables().size()) {}

TrajectoryAnswer TrajectoryCheck::check(const CuboidMap& map, const JointTrajectory& trajectory,
                                        const std::vector<double>& from,
                                        const std::vector<Pose>& T_fixed_roots) {
  TrajectoryAnswer answer;
  const std::string defect = defectOf(trajectory, robot_->model());
  if (!defect.empty()) {
    answer.cause = {Reason::kBadQuestion, defect};
    return answer;
  }
  makePath(trajectory, robot_->model(), from, kSplineTolerance, path_);
  for (const JointTrajectory::Point& point : trajectory.points) {
    path_.positionsAt(point.time_s, positions_);
    answer.clearances_m.push_back(
        clearance_.least(map, kinematics_.update(positions_, T_fixed_roots)));
  }
  findCollision(map, trajectory, T_fixed_roots, answer);
  if (answer.cause.reason == Reason::kClear && robot_->config().check_occlusion) {
    findOcclusion(map, trajectory, T_fixed_roots, answer);
  }
  return answer;
}

void TrajectoryCheck::findCollision(const CuboidMap& map, const JointTrajectory& trajectory,
                                    const std::vector<Pose>& T_fixed_roots,
                                    TrajectoryAnswer& answer) {
  double from_s = path_.begin();
  for (std::size_t i = 0; i < trajectory.points.size(); ++i) {
    const double to_s = trajectory.points[i].time_s;
    const auto found = way_.firstContact(map, path_, from_s, to_s, T_fixed_roots, i == 0);
    if (found) {
      const std::string& link = robot_->model().linkOf(found->contact.shape);
      answer.index = i;
      answer.time_s = from_s + found->time_s;
      answer.contact = found->contact;
      answer.cause = {Reason::kCollision, atTime(link + " touches the map", answer.time_s), link};
      return;
    }
    from_s = to_s;
  }
}

void TrajectoryCheck::findOcclusion(const CuboidMap& map, const JointTrajectory& trajectory,
                                    const std::vector<Pose>& T_fixed_roots,
                                    TrajectoryAnswer& answer) {
  const std::size_t points = trajectory.points.size();
  const auto poses = std::min(points, static_cast<std::size_t>(config_.occlusion_poses));
  for (std::size_t k = 1; k <= poses; ++k) {
    const std::size_t i = k * points / poses - 1;  // the last one is among them
    path_.positionsAt(trajectory.points[i].time_s, positions_);
    pose_.findOcclusion(map, kinematics_.update(positions_, T_fixed_roots), findings_);
    const std::string hidden = pose_.mostHiddenLink(findings_);
    if (hidden.empty()) continue;
    answer.index = i;
    answer.time_s = trajectory.points[i].time_s;
    answer.cause = {Reason::kOcclusion,
                    atTime(hidden + " is hidden from the sensor", answer.time_s), hidden};
    return;
  }
}

}  // namespace tccm
