#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "check/clearance_check.h"
#include "check/pose_check.h"
#include "check/way_check.h"
#include "robot/joint_trajectory.h"

namespace tccm {

/// What a controller asks before it moves: is this way free, all of it, between the waypoints as
/// well?
class TrajectoryCheck {
 public:
  struct Config {
    PoseCheck::Config pose;
    double clearance_radius_m = 0.2;
    /// No primitive moves further between two poses that are looked at; a contact that is passed
    /// over is no deeper than half of it.
    double step_m = 0.004;
    int occlusion_poses = 8;  ///< so many, spread over the waypoints, are looked at for occlusion

    /// @throws ConfigError
    void validate() const;
  };

  struct Answer {
    Cause cause;                       ///< kClear: all of it is free
    std::optional<std::size_t> index;  ///< of the waypoint at the end of the stretch concerned
    double time_s = 0.0;               ///< of the first violation, from the trajectory's start
    std::optional<Contact> contact;
    /// At each waypoint, of all links to the nearest cuboid [m]; infinite beyond the radius.
    std::vector<double> clearances_m;
  };

  /// @throws ConfigError
  TrajectoryCheck(std::shared_ptr<const RobotModel> model, const Config& config);

  void exempt(const ExemptRegions& regions);

  /// @param from where the robot is, one position for each variable.
  /// @param T_fixed_roots one for each of the model's roots; they stand still.
  [[nodiscard]] Answer check(const CuboidMap& map, const JointTrajectory& trajectory,
                             const std::vector<double>& from,
                             const std::vector<Pose>& T_fixed_roots);

 private:
  void findCollision(const CuboidMap& map, const JointTrajectory& trajectory,
                     const std::vector<Pose>& T_fixed_roots, Answer& answer);
  void findOcclusion(const CuboidMap& map, const JointTrajectory& trajectory,
                     const std::vector<Pose>& T_fixed_roots, Answer& answer);

  std::shared_ptr<const RobotModel> model_;
  Config config_;
  PoseCheck pose_;
  WayCheck way_;
  ClearanceCheck clearance_;
  JointPath path_;
  PoseFindings findings_;
  std::vector<double> positions_;
};

}  // namespace tccm
