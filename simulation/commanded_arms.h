#pragma once

#include <memory>
#include <string>
#include <vector>

#include "simulation/controlled_arm.h"
#include "tccm_monitor/robot_model.h"
#include "tccm_monitor/time.h"

namespace tccm::simulation {

/// A commanded joint trajectory. Without points: stop and hold.
struct ArmCommand {
  struct Point {
    Duration time_from_start{0};
    std::vector<double> positions;   ///< [rad], one for each joint
    std::vector<double> velocities;  ///< [rad/s], the same, or empty
  };
  Time start;
  std::vector<std::string> joints;
  std::vector<Point> points;
};

/// Both arms' joints, as ros_controllers' JointTrajectoryController drives them: a new command
/// replaces the one before from where the arms are, whatever they were doing; between points with
/// velocities the way is cubic, else straight. Joints that a command leaves out, and all of them
/// after its end and after an empty one, are braked, and hold. Arms may have controllers of their
/// own: then nothing else drives their joints.
class CommandedArms {
 public:
  struct Config {
    double deceleration_rps2 = 6.0;                      ///< of each joint when it is braked
    std::vector<ControlledArm::Config> controlled = {};  ///< arms with controllers of their own

    /// @throws ConfigError
    void validate() const;
  };

  /// @param positions of the model's variables, at rest. @throws ConfigError
  CommandedArms(const Config& config, std::shared_ptr<const RobotModel> model,
                std::vector<double> positions, Time now);

  /// Takes effect with the next step. @return empty, or in one line why the command is not taken:
  /// the one before goes on then.
  [[nodiscard]] std::string command(const ArmCommand& command);
  /// @param now not before that of earlier calls.
  void step(Time now);

  /// In the order of the configuration.
  [[nodiscard]] std::vector<ControlledArm>& controlled() { return controlled_; }
  [[nodiscard]] const std::vector<ControlledArm>& controlled() const { return controlled_; }
  [[nodiscard]] const std::vector<double>& positions() const { return positions_; }    ///< [rad]
  [[nodiscard]] const std::vector<double>& velocities() const { return velocities_; }  ///< [rad/s]
  /// Braking or holding: no command is being followed.
  [[nodiscard]] bool holds() const;
  [[nodiscard]] bool moves() const;

 private:
  /// Of the joints of driven_, in their order.
  struct Knot {
    Time at;
    std::vector<double> positions;
    std::vector<double> velocities;  ///< or empty
  };
  void addControlled(Time now);
  [[nodiscard]] std::string defectOf(const ArmCommand& command) const;
  void stepControlled(Time now, std::vector<bool>& followed);
  void follow(Time until);
  void keepWithinLimits();
  void brake(std::size_t variable, double elapsed_s);

  Config config_;
  std::shared_ptr<const RobotModel> model_;
  std::vector<double> positions_;
  std::vector<double> velocities_;
  std::vector<ControlledArm> controlled_;
  std::vector<bool> has_controller_;  ///< one for each variable
  std::vector<std::size_t> driven_;   ///< variables that the command names
  std::vector<Knot> knots_;           ///< rising in time, the first not after now; or none
  Time now_;
};

}  // namespace tccm::simulation
