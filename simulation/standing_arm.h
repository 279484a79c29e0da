#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robot/kinematics.h"
#include "simulation/controlled_arm.h"
#include "simulation/depth_camera.h"
#include "simulation/mount.h"
#include "simulation/robot_sample.h"
#include "simulation/world.h"

namespace tccm::simulation {

/// Any robot that stands on the floor before a depth camera; one controller drives its joints.
/// Deterministic: the same configuration, goals and boxes give the same output. The fixed frame is
/// the robot's root. Labels in PointTruth: the model's shapes, after them the world's objects.
class StandingArm {
 public:
  struct Config {
    ControlledArm::Config arm;
    /// Of joints that do not begin in the middle of their limits, or at 0 where they have none.
    std::map<std::string, double> posture = {};  // [rad or m]
    DepthCamera::Config camera;
    Vector3 camera_m{1.6, -1.0, 1.4};  ///< where the camera is, in the robot's root
    Vector3 look_at_m{0.3, 0.0, 0.5};  ///< what it looks at
    double floor_m = 0.0;              ///< height of the floor there
    double box_m = 0.12;               ///< edge of the boxes that are put before it
    Time start{std::chrono::seconds(1000)};
    std::uint64_t seed = 1;

    /// @throws ConfigError
    void validate() const;
  };
  /// What came up during a step.
  struct Output {
    std::optional<RobotSample> robot;     ///< at 100 Hz
    std::optional<SimulatedCloud> cloud;  ///< at the camera's rate
  };

  /// @throws ConfigError also for joints that the model has not.
  StandingArm(const Config& config, std::shared_ptr<const RobotModel> model);

  /// One millisecond.
  Output step();
  /// A box around that place. @param p_root [m]
  void putBox(const Vector3& p_root);
  void takeBoxes();

  [[nodiscard]] TrajectoryController& controller() { return arm_.controller(); }
  [[nodiscard]] Time now() const { return now_; }
  [[nodiscard]] const RobotModel& model() const { return *model_; }
  [[nodiscard]] const World& world() const { return world_; }
  /// Of the camera's optical frame, on the robot's root.
  [[nodiscard]] const Mount& mount() const { return mount_; }

 private:
  [[nodiscard]] Snapshot snapshot() const;

  Config config_;
  std::shared_ptr<const RobotModel> model_;
  std::vector<double> positions_, velocities_;
  ControlledArm arm_;
  Kinematics kinematics_;
  Mount mount_;
  DepthCamera camera_;
  World world_;
  std::size_t bare_;  ///< objects of the world without boxes
  Time now_;
  Time next_frame_;
};

}  // namespace tccm::simulation
