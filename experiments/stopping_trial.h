#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "experiments/outcome.h"
#include "experiments/robot_part.h"
#include "experiments/sensor_choice.h"
#include "simulation/monitored_simulation.h"
#include "tccm_monitor/cuboid_map.h"

namespace tccm::simulation {

/// The paper's experiment (section VI.B): an arm stretches over a table, something appears before
/// its hand, and the arm brakes when its permission goes.
class StoppingTrial {
 public:
  struct Config {
    Monitor::Config monitor;
    PathController::Config controller;  ///< speed included
    SensorChoice sensors;
    Scanner::Config scanner;
    double tilt_period_s = 1.575;
    ObstacleKind obstacle = ObstacleKind::kPole;
    double obstacle_speed_mps = 0.0;  ///< 0: it appears in its place at once
    /// It reaches for the palm, from a direction between these two, counterclockwise from the
    /// hand's heading [rad].
    std::optional<std::array<double, 2>> reaches_from_rad;
    double gap_min_m = 0.14, gap_max_m = 0.16;
    double aside_max_m = 0.04;    ///< to either side of the middle of the way
    double turn_max_rad = 0.5;    ///< to either side
    double body_error_m = 0.003;  ///< by which each part of the robot is displaced
    Time start = Simulator::Config().start;
    Guardian* guardian = nullptr;  ///< whom the arm obeys; nobody: the core classes
    bool obeys_scale = false;      ///< or the arm brakes only when the permission goes
    /// Of its speed, that the hand must have when the obstacle appears.
    double appear_speed_share = 0.99;

    /// @throws ConfigError
    void validate() const;
  };

  /// Why an arm touches.
  enum class Cause {
    kNotLookedAt,       ///< no beam met what is in the way before the contact
    kLookedAtTooLate,   ///< once the first such beam's scan was judged, it could not brake in time
    kSupportedTooLate,  ///< that beam came in time, the scan that gave it its support did not
    kAvoidable,         ///< braking once that scan was judged would have been in time
  };

  struct Result {
    std::uint64_t seed = 0;
    double gap_m = 0.0, aside_m = 0.0, turn_rad = 0.0;
    std::optional<double> reaches_from_rad;
    double tilt_phase = 0.0;  ///< of a period, when the obstacle appeared, 0..1
    /// Not started: no obstacle came, as the arm was never on its way at full speed.
    Outcome outcome = Outcome::kUndecided;
    std::string reason;  ///< why the permission went
    /// From the arm to the obstacle, at rest, by FCL; nothing where none came.
    std::optional<double> left_m;
    // [s] after the obstacle appeared
    std::optional<double> beam_s;      ///< the first beam that shows it was measured
    std::optional<double> way_beam_s;  ///< the first that shows what of it is in the way
    std::optional<double> support_s;   ///< the scan was judged that gives that its support
    std::optional<double> due_s;       ///< a contact came within the time that a stop is due in
    std::optional<double> stop_s;      ///< permission went
    std::optional<double> contact_s;   ///< of the arm with it
    double contact_speed_mps = 0.0;    ///< of the palm, then
    std::optional<int> delay_scans;    ///< from when a stop was due and the part supported
    /// Of a contact: whether braking once a scan with that evidence of what is in the way was
    /// judged would have come in time.
    bool avoidable_from_beam = false, avoidable_from_support = false;
    std::optional<Cause> cause;  ///< of a contact
    double simulated_s = 0.0;
    /// Of each scan from the obstacle on, from beams to verdict: no result of the seed.
    std::vector<double> processing_us;
  };

  /// @param model what the monitor takes the robot for. @throws ConfigError
  StoppingTrial(const Config& config, std::shared_ptr<const RobotModel> model, std::uint64_t seed);

  /// The same for the same seed, but for processing_us.
  [[nodiscard]] Result run();

 private:
  /// The arm when something was judged.
  struct Judged {
    Time stamp;
    double way_m;  ///< along its path
    double speed_mps;
    int scan;
  };
  /// An accepted return from the part of the obstacle that is in the way.
  struct Evidence {
    Grid::Place place;
    int scan;
  };
  [[nodiscard]] Simulator::Config simulatorConfig(std::uint64_t seed);
  void noteObstacle();
  void findContact(double from_m);
  void noteProcessing();
  void noteScan(const SimulatedScan& scan);
  void noteCloud(const MappedCloud& cloud);
  void noteFirstBeam();
  void noteEvidence(const SimulatedScan& scan);
  void noteEvidence(const MappedCloud& cloud);
  void noteSupport();
  [[nodiscard]] bool showsObstacle(const BeamTruth& beam) const;
  void notePermission(bool permitted, const std::string& reason);
  [[nodiscard]] Body armAt(double way_m);
  [[nodiscard]] bool isInTheWay(const Grid::Place& place) const;
  [[nodiscard]] bool isInTheWayAsBefore(const Grid::Place& place);
  [[nodiscard]] bool hasSupport(const Evidence& evidence) const;
  [[nodiscard]] Judged judgedNow() const;
  [[nodiscard]] double sinceAppeared(Time stamp) const { return toSeconds(stamp - *appeared_); }
  [[nodiscard]] Cause causeOfContact() const;
  /// Whether braking from then on would end before the contact.
  [[nodiscard]] bool brakesInTime(const std::optional<Judged>& from) const;
  [[nodiscard]] const Body& armNow();
  [[nodiscard]] Body obstacleNow() const;
  [[nodiscard]] std::optional<Outcome> outcomeSoFar();

  Config config_;
  std::shared_ptr<const RobotModel> model_;
  ArmPath path_;
  Kinematics kinematics_;
  Grid grid_;
  Result result_;
  MonitoredSimulation simulation_;
  RobotPart arm_;
  Time start_;
  std::optional<Time> appeared_;
  std::size_t first_obstacle_ = 0;  ///< index into the world
  Body obstacle_;                   ///< in its place
  std::vector<Body> ahead_;         ///< the arm along its path up to there, padded
  double contact_m_ = 0.0;          ///< along the path: there it would touch the obstacle
  std::vector<Evidence> evidence_;
  std::map<std::pair<CellIndex, Height>, bool> in_the_way_;  ///< by what was asked for
  int scans_ = 0;
  int timed_scans_ = 0;
  std::optional<Judged> way_beam_, support_, due_;
  bool permitted_ = false;
  int at_rest_ = 0;  ///< robot samples
};

[[nodiscard]] const char* name(StoppingTrial::Cause cause);

}  // namespace tccm::simulation
