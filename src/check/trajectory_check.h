#pragma once

#include <memory>
#include <vector>

#include "check/moving_out.h"
#include "check/pose_check.h"
#include "check/way_check.h"
#include "config/parameter_table.h"
#include "robot/joint_path.h"

namespace tccm {

/// What a controller asks before it moves: is this way free, all of it, between the waypoints as
/// well?
class TrajectoryCheck {
 public:
  struct Config {
    double step_m = 0.004;
    int occlusion_poses = 8;

    void describe(ParameterTable& table);
  };

  /// @param clearance_radius_m, old_periods as PoseCheck takes them.
  /// @throws ConfigError
  TrajectoryCheck(const std::shared_ptr<const CheckedRobot>& robot, const Config& config,
                  double clearance_radius_m, double old_periods);

  /// @param from where the robot is, one position for each variable.
  /// @param T_fixed_roots one for each of the model's roots; they stand still.
  /// @return CHECK_LATE for one that cannot be judged within a second; MOVING_OUT, which is free,
  /// for one that opens each contact of its begin and comes to no other.
  [[nodiscard]] TrajectoryAnswer check(const Surroundings& around,
                                       const JointTrajectory& trajectory,
                                       const std::vector<double>& from,
                                       const std::vector<Pose>& T_fixed_roots);

 private:
  [[nodiscard]] static TrajectoryAnswer tooLong();
  /// @return false where there are too many waypoints to be judged in time.
  [[nodiscard]] bool findClearances(const Surroundings& around, const Way& way,
                                    const JointTrajectory& trajectory, TrajectoryAnswer& answer);
  void place(const Way& way, double time_s);
  /// @return until when contacts of the way's begin last that it opens; its begin where there are
  /// none, or where one stays.
  [[nodiscard]] double findLeft(const Surroundings& around, const Way& way);
  /// Up to where something was found before.
  void findContact(const Surroundings& around, const Way& way, const JointTrajectory& trajectory,
                   TrajectoryAnswer& answer);
  /// From one instant of the way to another. @return false at a contact.
  [[nodiscard]] bool isFree(const Way& way, double from_s, double to_s, std::size_t index,
                            TrajectoryAnswer& answer);
  void findOcclusion(const Surroundings& around, const Way& way, const JointTrajectory& trajectory,
                     TrajectoryAnswer& answer);

  std::shared_ptr<const CheckedRobot> robot_;
  Config config_;
  PoseCheck pose_;
  WayCheck way_;
  MovingOut moving_out_;
  double clearance_radius_m_;
  JointPath path_;
  PoseFindings findings_, later_;
  std::vector<double> positions_;
};

}  // namespace tccm
