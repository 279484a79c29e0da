#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tccm_monitor/robot/joint_states.h"
#include "tccm_monitor/robot/kinematics.h"

namespace tccm {

/// Places the robot's primitives over the time of a scan, from joint states around it.
class BodySampler {
 public:
  struct Config {
    JointStates::Config joints;
    /// Time between two samples. Half of it at a hand's speed is the error of its place.
    double sample_s = 0.004;

    /// @throws ConfigError
    void validate() const;
  };

  /// @throws ConfigError
  BodySampler(std::shared_ptr<const RobotModel> model, const Config& config);

  [[nodiscard]] JointStates& joints() { return joints_; }
  [[nodiscard]] const JointStates& joints() const { return joints_; }

  /// Samples from first to last, both included; fewer samples than before keep their memory.
  /// @param T_fixed_root the robot's root over that time.
  /// @return empty, or why the body is unknown at that time: no_transform, no_joint_states.
  [[nodiscard]] std::string sample(Time first, Time last, const PosePath& T_fixed_root);
  [[nodiscard]] const std::vector<BodySample>& samples() const { return samples_; }

 private:
  std::shared_ptr<const RobotModel> model_;
  Config config_;
  JointStates joints_;
  Kinematics kinematics_;
  std::vector<Shape> shapes_;
  std::vector<double> positions_;
  std::vector<BodySample> samples_;
};

}  // namespace tccm
