#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robot/kinematics.h"
#include "simulation/arm_path.h"
#include "simulation/body_error.h"
#include "simulation/clearance.h"
#include "simulation/cloud_sensors.h"
#include "simulation/commanded_arms.h"
#include "simulation/motion.h"
#include "simulation/obstacle.h"
#include "simulation/robot_sample.h"
#include "simulation/scanner.h"
#include "simulation/scanning_head.h"
#include "simulation/truth.h"
#include "simulation/world.h"
#include "tccm_monitor/robot_model.h"

namespace tccm::simulation {

/// What came up during a step.
struct StepOutput {
  std::optional<RobotSample> robot;   ///< at 100 Hz
  std::optional<SimulatedScan> scan;  ///< once its last beam is measured
  CloudSensors::Output clouds;
};

/// The motion of arms that do nothing but what they are commanded. They begin where "reach" does.
constexpr char kCommanded[] = "commanded";

/// Those of motionNames() and "wander": what needs no commands.
[[nodiscard]] std::vector<std::string> simulatedMotions();

/// The dual-arm robot in a scene, its sensors looking, its arms moving, an obstacle that appears.
/// Deterministic: the same configuration and the same stops and commands give the same output. The
/// fixed frame is base_link, on the floor. Labels in BeamTruth and PointTruth: up to 25 the model's
/// shapes, from kFirstObject on the world's objects.
class Simulator {
 public:
  struct Config {
    Time start{std::chrono::seconds(1000)};
    std::string scene = "table";
    World objects;  ///< in the scene as well
    std::string motion = "reach";
    std::optional<ArmPath> path;  ///< in place of the motion
    PathController::Config controller;
    CommandedArms::Config commanded;  ///< of the motion kCommanded alone
    ScanningHead::Config head;
    std::vector<SensorKind> sensors = {SensorKind::kLaser};
    Scanner::Config scanner;
    CloudSensors::Config clouds;
    std::uint64_t seed = 1;
    ObstacleKind obstacle = ObstacleKind::kNone;
    ObstaclePurpose purpose = ObstaclePurpose::kCollision;
    /// After the start; the obstacle waits for the next moment when the hand is on its way out at
    /// full speed and has room left to run into it; where it is commanded, for the next when it
    /// moves ahead.
    double appear_s = 8.0;
    double appear_speed_share = 0.99;  ///< of the hand's speed, that is full speed
    double appear_from_m = 0.0;        ///< along its path, or at the last place with room left
    double gap_m = 0.15;  ///< between hand and obstacle when the obstacle is in its place
    ObstacleStance stance;
    /// Above 0: the obstacle is brought in from 0.4 m aside at this speed, and is in its place when
    /// a hand that went on would be gap_m away. 0: it appears in its place.
    double obstacle_speed_mps = 0.0;
    /// It reaches for the palm itself instead, and comes from this direction: about the upright,
    /// counterclockwise from the hand's heading. Its speed is above 0.
    std::optional<double> reaches_from_rad;
    /// How the body that the beams meet differs from the description. Distances in Truth are those
    /// of the description.
    BodyError body_error;
    double wander_length_m = 60.0;     ///< of the motion "wander" until it turns back
    double wander_clearance_m = 0.12;  ///< which "wander" keeps from the scene, see WanderConfig
    bool keeps_hand_samples = true;    ///< false: Truth has the newest alone

    /// @throws ConfigError
    void validate() const;
    [[nodiscard]] bool has(SensorKind kind) const;
  };
  static constexpr std::size_t kFirstObject = 1000;

  /// @throws ConfigError, also where no obstacle could ever appear as asked for.
  explicit Simulator(const Config& config);

  /// Moves on by 1 ms.
  StepOutput step();
  /// What the controller hears from now on; arms that are commanded do not care.
  void setStop(bool stop);
  /// As PathController::setSpeedScale().
  void setSpeedScale(double scale) { controller_.setSpeedScale(scale); }
  /// As ScanningHead::setFault().
  void setTiltFault(TiltFault fault) { head_.setFault(fault); }
  /// From now on. @return empty, or in one line why the command is not taken. @pre the motion is
  /// kCommanded
  [[nodiscard]] std::string command(const ArmCommand& command);
  /// That of one of the arms which have one, in the order of the configuration. @pre the motion is
  /// kCommanded
  [[nodiscard]] TrajectoryController& armController(std::size_t arm) {
    return commanded_->controlled()[arm].controller();
  }
  /// Of all arms that have controllers. @param scale from 0 to 1. @pre the motion is kCommanded
  void setArmsSpeedScale(double scale) {
    for (ControlledArm& arm : commanded_->controlled()) arm.setSpeedScale(scale);
  }

  /// From now on these are the obstacle, in their places at once, and what was put there before is
  /// gone. @pre none is configured
  void put(const World& objects);

  [[nodiscard]] Time now() const { return now_; }
  [[nodiscard]] const RobotModel& model() const { return *model_; }
  [[nodiscard]] const World& world() const { return world_; }
  [[nodiscard]] const Truth& truth() const { return truth_; }
  [[nodiscard]] const PathController& controller() const { return controller_; }
  [[nodiscard]] const ScanningHead& head() const { return head_; }

 private:
  void moveArms();
  void noteStops();
  [[nodiscard]] bool armsMove() const;
  [[nodiscard]] bool armsBrake() const;
  [[nodiscard]] std::vector<double> joints() const;
  [[nodiscard]] std::vector<double> jointVelocities() const;
  [[nodiscard]] double handSpeed() const;
  [[nodiscard]] Vector3 commandedPalmVelocity() const;
  [[nodiscard]] Vector3 palmAt(const std::vector<double>& joints) const;
  [[nodiscard]] HandState handAfter(double way) const;
  [[nodiscard]] HandState handAt(const std::vector<double>& joints, const Vector3& heading) const;
  [[nodiscard]] Snapshot snapshot() const;
  [[nodiscard]] double handTravel() const;
  [[nodiscard]] double roomForObstacle() const;
  void requireRoomForObstacle() const;
  [[nodiscard]] bool handIsOnItsWay() const;
  void maybeAddObstacle();
  [[nodiscard]] World obstacleBefore(const HandState& hand) const;
  [[nodiscard]] Vector3 comesFrom(const HandState& hand) const;
  void addObstacle(double hand_travel_m);
  void addObstacle(const World& obstacle);
  [[nodiscard]] std::optional<SimulatedScan> maybeFinishScan();
  void noteFirstBeam(const SimulatedScan& scan);
  void noteFirstBeam(const SimulatedCloud& cloud);
  [[nodiscard]] bool wantsFirstBeam() const { return first_obstacle_ && !truth_.first_beam; }
  void recordTruth();

  Config config_;
  std::shared_ptr<const RobotModel> model_;
  std::vector<PlacedShape> true_shapes_;  ///< in the frames of the model's shapes
  Kinematics kinematics_;
  World world_;
  ArmPath path_;
  PathController controller_;
  std::optional<CommandedArms> commanded_;  ///< in place of path and controller
  ScanningHead head_;
  Scanner scanner_;
  CloudSensors clouds_;
  Truth truth_;
  Time now_;
  Time scan_start_;
  std::vector<Snapshot> snapshots_;  ///< since the scan's start
  bool stop_ = false;
  std::optional<std::size_t> first_obstacle_;  ///< index into the world
  std::optional<SampledBody> sampled_obstacle_;
  std::optional<SampledBody> sampled_hand_;
  std::vector<std::size_t> hand_shapes_;  ///< indices into the model's shapes
  std::size_t tilt_;                      ///< variable
  std::size_t head_yaw_;                  ///< variable
  std::size_t sensor_;                    ///< link
  std::size_t palm_;                      ///< link
};

}  // namespace tccm::simulation
