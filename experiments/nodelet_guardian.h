#pragma once

#include <ros/ros.h>
#include <tccm_monitor/MotionPermission.h>

#include <optional>

#include "simulation/guardian.h"

namespace tccm::simulation {

/// The nodelets of a running ROS system, in simulated time at the pace of the wall clock: they hear
/// clock, transforms, joint states and scans, and the arms obey their motion_permission.
class NodeletGuardian : public Guardian {
 public:
  /// Waits for the nodelets, with a clock that stands. @throws InputError where there is no master,
  /// or no nodelet that gives a permission.
  explicit NodeletGuardian(Time start);

  /// For others that need the clock before a simulation begins.
  void pause();
  Word watch(const Simulator& simulator, const StepOutput& output) override;
  /// When the next simulation is to start: later than what the nodelets have heard of.
  [[nodiscard]] Time nextStart() const;

 private:
  void hear(const tccm_monitor::MotionPermission& permission) { heard_ = permission; }
  void publishClock(Time now);
  void keepPace(Time now);
  void reset(Time now);

  ros::NodeHandle node_;
  ros::Publisher clock_, scan_, joints_, transforms_;
  ros::Subscriber permission_;
  ros::ServiceClient reset_;
  std::optional<tccm_monitor::MotionPermission> heard_;
  Time now_;
  std::optional<Time> began_;  ///< the simulation that runs
  ros::WallTime wall_began_;
  Time reset_next_;
};

}  // namespace tccm::simulation
