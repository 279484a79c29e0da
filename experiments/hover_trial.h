#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "experiments/hover_scene.h"
#include "experiments/outcome.h"
#include "experiments/robot_part.h"
#include "simulation/monitored_simulation.h"

namespace tccm::simulation {

/// A robot whose hand hovers over an object, and hides it, and then moves straight down, as the
/// monitor permits.
class HoverTrial {
 public:
  struct Config {
    Monitor::Config monitor;
    HoverRanges ranges;
    double hover_s = 4.0;
    double down_mps = 0.1;
    double approach_mps = 0.2;
    double approach_from_above_mps = 0.04;  ///< the last part of the way
    PathController::Config controller;      ///< its latency and deceleration

    /// @throws ConfigError
    void validate() const;
  };

  struct Result {
    std::uint64_t seed = 0;
    std::string object, approach;
    double gap_m = 0.0;
    double noise_m = 0.0;
    /// Not started: downwards was not permitted when the time had come; undecided: nothing came
    /// of it within half a minute.
    Outcome outcome = Outcome::kUndecided;
    /// Of the verdict that stopped it, at which it was not started, or that permitted the contact.
    std::string reason;
    double left_m = 0.0;       ///< between hand and object at the end; 0 where it was touched
    double stop_left_m = 0.0;  ///< the same when permission went; 0 where it did not
    std::size_t held_max = 0;  ///< intervals held
    double held_mean = 0.0;    ///< over all scans
    double simulated_s = 0.0;
  };

  /// @param model what the monitor takes the robot for. @throws ConfigError
  HoverTrial(const Config& config, std::shared_ptr<const RobotModel> model, std::uint64_t seed);

  /// The same for the same seed.
  [[nodiscard]] Result run();

 private:
  [[nodiscard]] Simulator::Config simulatorConfig() const;
  void countHeld();
  void noteVerdict(const Verdict& verdict);
  [[nodiscard]] double clearanceNow();
  [[nodiscard]] bool goesDown() const;
  /// Nothing while it goes on.
  [[nodiscard]] std::optional<Outcome> outcomeSoFar();

  Config config_;
  std::uint64_t seed_;
  HoverScene scene_;
  MonitoredSimulation simulation_;
  RobotPart arm_;
  SampledBody things_;
  Time start_;
  Result result_;
  std::optional<Time> down_since_;
  bool permitted_ = false;  ///< as of the newest verdict
  std::size_t scans_ = 0;
  std::size_t held_sum_ = 0;
  int at_rest_ = 0;  ///< robot samples in a row, on the way down, at rest on a stop
};

}  // namespace tccm::simulation
