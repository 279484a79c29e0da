#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "experiments/robot_part.h"
#include "simulation/monitored_simulation.h"

namespace tccm::simulation {

/// A person's hand comes over the table and lies there; the robot's arm moves between it and the
/// sensor; behind the arm the hand goes away. Once the arm has left, the map may show the hand no
/// longer.
class GhostTrial {
 public:
  struct Config {
    Monitor::Config monitor;
    double noise_m = 0.01;
    double deadline_tilt_periods = 2.0;  ///< since the hand's place is in view again
    PathController::Config controller;

    /// @throws ConfigError
    void validate() const;
  };

  struct Result {
    std::uint64_t seed = 0;
    std::size_t seen_max = 0;  ///< cuboids where the hand lay, before the arm came
    std::size_t held_max = 0;  ///< held ones of them, once the hand was gone
    double hidden_s = 0.0;     ///< from the hand's leaving until its place was in view again
    /// From then until the last cuboid was gone from there; nothing where one was left at the end.
    std::optional<double> gone_after_s;
    std::size_t left = 0;       ///< cuboids there, live and held, at the deadline
    std::size_t left_held = 0;  ///< held ones of them
    double simulated_s = 0.0;
  };

  /// @throws ConfigError
  GhostTrial(const Config& config, const std::shared_ptr<const RobotModel>& model,
             std::uint64_t seed);

  /// The same for the same seed.
  [[nodiscard]] Result run();

 private:
  struct Count {
    std::size_t live = 0;
    std::size_t held = 0;
    [[nodiscard]] std::size_t all() const { return live + held; }
  };
  [[nodiscard]] Count cuboidsInPlace() const;
  [[nodiscard]] bool placeIsHidden();
  void look();

  Config config_;
  Simulator::Config setting_;
  Body hand_;  ///< where it lies
  MonitoredSimulation simulation_;
  RobotPart arm_;
  std::vector<Vector3> surface_;  ///< of the hand, towards the sensor, fixed frame [m]
  Time last_hidden_;              ///< any of it, since the hand left
  std::vector<std::pair<Time, Count>> counts_;  ///< cuboids there, at each scan since then
  Result result_;
};

}  // namespace tccm::simulation
