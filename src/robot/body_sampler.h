#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "config/parameter_table.h"
#include "robot/joint_states.h"
#include "robot/kinematics.h"
#include "robot/link_use.h"

namespace tccm {

/// Places the robot's primitives over the time of a scan, from joint states around it.
class BodySampler {
 public:
  struct Config {
    JointStates::Config joints;
    LinkUse filtered{Expansion{1.0, 0.025}};
    double attached_padding_m = 0.06;
    double lateness_s = 0.02;
    double sample_s = 0.004;  ///< half of it at a hand's speed is the error of its place

    void describe(ParameterTable& table);
    /// @throws ConfigError
    void validate() const { filtered.validate(kSelfFilterKeys); }
  };

  /// @throws ConfigError
  BodySampler(std::shared_ptr<const RobotModel> model, const Config& config);

  [[nodiscard]] JointStates& joints() { return joints_; }
  [[nodiscard]] const JointStates& joints() const { return joints_; }

  /// The same robot with other objects in its hand. @throws ConfigError, and nothing changes.
  void setModel(std::shared_ptr<const RobotModel> model);
  [[nodiscard]] const RobotModel& model() const { return *model_; }

  /// Samples from first to last, both included; fewer samples than before keep their memory.
  /// @param T_fixed_roots the robot's roots over that time, in the model's order.
  /// @return empty, or why the body is unknown at that time: no_transform, no_joint_states.
  [[nodiscard]] std::string sample(Time first, Time last,
                                   const std::vector<PosePath>& T_fixed_roots);
  [[nodiscard]] const std::vector<BodySample>& samples() const { return samples_; }
  /// The link, by the model's order, that a sample's shape belongs to or is held by.
  [[nodiscard]] std::size_t linkOf(std::size_t shape) const {
    return model_->shapes()[used_.shapes[shape]].link;
  }

 private:
  /// Fills roots_. @return false where one is not known at that time.
  [[nodiscard]] bool placeRoots(Time stamp, const std::vector<PosePath>& T_fixed_roots);
  void growBySpeed();

  std::shared_ptr<const RobotModel> model_;
  Config config_;
  JointStates joints_;
  Kinematics kinematics_;
  UsedShapes used_;
  Body body_;  ///< what all samples have in common, paddings but for the speed
  std::vector<double> radii_m_;
  std::vector<Pose> roots_;
  std::vector<double> positions_;
  std::vector<BodySample> samples_;
};

}  // namespace tccm
