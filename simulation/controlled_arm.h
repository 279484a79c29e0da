#pragma once

#include <memory>
#include <vector>

#include "simulation/trajectory_controller.h"
#include "tccm_monitor/robot_model.h"
#include "tccm_monitor/time.h"

namespace tccm::simulation {

/// An arm whose joints are driven by a TrajectoryController of its own: each comes to where it is
/// to be, as far as its speed and its lag let it.
class ControlledArm {
 public:
  struct Config {
    TrajectoryController::Config controller;
    /// Time constant with which the joints come to where they are to be; 0: they are there.
    double lag_s = 0.0;

    /// @throws ConfigError
    void validate() const;
  };

  /// @param positions of the model's variables. A joint's speed is that of the model at most.
  /// @throws ConfigError also for joints that the model has not.
  ControlledArm(const Config& config, std::shared_ptr<const RobotModel> model,
                const std::vector<double>& positions, Time now);

  /// Moves its joints on. @param positions, velocities of the model's variables.
  void step(Time now, std::vector<double>& positions, std::vector<double>& velocities);

  /// As by the speed slider of a robot's driver: the controller's time goes on by that share of
  /// what passes, also while it stops. @param scale from 0 to 1
  void setSpeedScale(double scale) { scale_ = scale; }

  [[nodiscard]] TrajectoryController& controller() { return controller_; }
  [[nodiscard]] const TrajectoryController& controller() const { return controller_; }
  /// Of its joints, in the controller's order, among the model's.
  [[nodiscard]] const std::vector<std::size_t>& variables() const { return variables_; }

 private:
  Config config_;
  std::shared_ptr<const RobotModel> model_;
  std::vector<std::size_t> variables_;
  TrajectoryController controller_;
  Time now_;
  Time clock_;  ///< the controller's
  double scale_ = 1.0;
};

}  // namespace tccm::simulation
