#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "experiments/visibility_scene.h"
#include "simulation/motion.h"
#include "simulation/scanner.h"

namespace tccm::simulation {

/// A list, separated by commas. @param entry what each entry has to be.
template <typename Entry>
void addList(CLI::App& command, const std::string& name, std::vector<Entry>& entries,
             const CLI::Validator& entry, const std::string& description = "") {
  command.add_option(name, entries, description)->delimiter(',')->check(entry);
}

/// From 0 to 1.
inline void addShare(CLI::App& command, const std::string& name, double& share,
                     const std::string& description = "") {
  command.add_option(name, share, description)->check(CLI::Range(0.0, 1.0));
}

inline void addNoise(CLI::App& command, double& noise_m) {
  command.add_option("--noise-m", noise_m, "standard deviation of a range");
}

inline void addMixedPixels(CLI::App& command, Scanner::Config& scanner) {
  command.add_option("--mixed-share", scanner.mixed_share, "of the beams that straddle an edge");
  command.add_option("--mixed-persistence", scanner.mixed_persistence,
                     "chance that the next such beam does as this one did: 0 independent, towards "
                     "1 longer runs");
}

inline void addLinksThatCount(CLI::App& command, LinksThatCount& counted) {
  addShare(command, "--in-range-min", counted.in_range_min,
           "share of a link's silhouette that the laser must look at");
  command.add_option("--silhouette-min-pixels", counted.silhouette_min_pixels)
      ->check(CLI::Range(0.0, 1e4));
}

/// @param whose what it is that brakes.
inline void addBraking(CLI::App& command, PathController::Config& controller,
                       const std::string& whose) {
  command.add_option("--latency-s", controller.latency_s, "from the stop to the brake");
  command.add_option("--deceleration", controller.acceleration_mps2, "of " + whose + " [m/s^2]");
}

}  // namespace tccm::simulation
