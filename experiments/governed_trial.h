#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "experiments/look_oracle.h"
#include "experiments/sensor_choice.h"
#include "simulation/monitored_simulation.h"

namespace tccm::simulation {

/// An arm that obeys a governed speed: whatever appears a distance ahead of a link, at any moment,
/// must be seen and braked for before the link is there. The beams really measured say when. What
/// would appear nearer to another part of the robot, or inside of it, was not promised.
class GovernedTrial {
 public:
  struct Config {
    Monitor::Config monitor;
    SensorChoice sensors;
    double distance_m = 0.15;       ///< that things appear ahead
    std::string motion = "wander";  ///< or "reach_about"
    double speed_mps = 0.4;         ///< commanded, of the faster palm
    double duration_s = 20.0;
    /// Watched.
    std::vector<std::string> links = {
        "left_elbow_link", "right_elbow_link", "left_wrist_pitch_link",  "right_wrist_pitch_link",
        "left_palm_link",  "right_palm_link",  "left_inner_finger_link", "right_inner_finger_link"};
    double slow_mps = 0.005;  ///< what moves more slowly goes nowhere
    PathController::Config controller;
    LookOracle::Config oracle;

    /// @throws ConfigError
    void validate() const;
  };

  /// A link at one instant, and how far it would have gone before it stood.
  struct Case {
    Time stamp;
    std::string link;
    double way_m = 0.0;   ///< until it would stand, or turned away from the place
    double left_m = 0.0;  ///< from it to the place, where it came nearest until then
    double wait_s = 0.0;  ///< until the first look at the place ahead
    bool looked = true;   ///< false: nobody did until the end
  };
  struct Result {
    std::uint64_t seed = 0;
    std::string motion;
    std::size_t cases = 0;       ///< links in motion and nothing of the robot ahead, at 100 Hz
    std::size_t violations = 0;  ///< of them went further than the distance
    std::size_t reached = 0;     ///< of them came to the place
    Case worst;
    double way_m = 0.0;        ///< of the faster palm
    double permitted_s = 0.0;  ///< with a permission
    double slowed_s = 0.0;     ///< of that, at a scale below 1
    double standing_s = 0.0;   ///< of that, at no speed to speak of
    double simulated_s = 0.0;
  };

  /// @param model what the monitor takes the robot for. @throws ConfigError
  GovernedTrial(const Config& config, const std::shared_ptr<const RobotModel>& model,
                std::uint64_t seed);

  /// The same for the same seed.
  [[nodiscard]] Result run();

 private:
  struct Instant {
    Time stamp;
    double speed_mps;             ///< of the faster palm
    std::vector<Vector3> points;  ///< middles of the links watched, fixed frame [m]
  };
  void note();
  void countTime(const Instant& instant);
  [[nodiscard]] std::vector<double> ways(std::size_t link) const;
  void judge(std::size_t link);
  /// @param way of the link, from the start until each instant [m].
  [[nodiscard]] Case caseAt(std::size_t link, std::size_t instant, const Vector3& ahead,
                            const std::vector<double>& way) const;

  Config config_;
  MonitoredSimulation simulation_;
  LookOracle oracle_;
  std::vector<std::size_t> shapes_;  ///< the first of each link watched
  std::vector<Instant> instants_;
  bool permitted_ = false;  ///< as of the newest verdict, as the scale
  double scale_ = 0.0;
  Result result_;
};

}  // namespace tccm::simulation
