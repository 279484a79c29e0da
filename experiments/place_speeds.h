#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "simulation/monitored_simulation.h"

namespace tccm::simulation {

/// What speed a monitor allows to a hand that moves to and fro, across the laser's view, where the
/// laser is tilted by an angle when it looks at it: over the phase of the tilt.
class PlaceSpeeds {
 public:
  struct Config {
    Monitor::Config monitor;
    double speed_mps = 0.4;  ///< commanded
    double duration_s = 25.0;
    std::size_t phases = 12;  ///< parts of a period
    PathController::Config controller;
    std::vector<std::string> links = {"*"};  ///< of the hand; those that do not move are left out

    /// @throws ConfigError
    void validate() const;
  };
  struct Result {
    double tilt_rad = 0.0;
    /// At which the laser looks at the middles of the hand's parts, halfway.
    std::vector<double> part_tilts_rad;
    std::vector<double> allowed_mps;  ///< by phase, from the start of a period on, on average
    double mean_mps = 0.0;            ///< allowed, over all phases
    double travelled_mps = 0.0;       ///< the hand's own, on average
    double simulated_s = 0.0;
  };

  /// @param model what the monitor takes the robot for.
  /// @param tilt_rad above 0, below a right angle: the laser looks ahead and down.
  /// @throws ConfigError, also where the hand cannot be there.
  PlaceSpeeds(const Config& config, const std::shared_ptr<const RobotModel>& model, double tilt_rad,
              std::uint64_t seed);

  [[nodiscard]] Result run();

 private:
  void note(const Verdict& verdict);

  Config config_;
  MonitoredSimulation simulation_;
  Time start_;
  std::vector<double> sums_mps_;
  std::vector<std::size_t> counts_;
  Result result_;
};

}  // namespace tccm::simulation
