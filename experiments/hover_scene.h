#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "simulation/arm_path.h"
#include "simulation/world.h"

namespace tccm::simulation {

/// The limits that a hovering hand's trials are drawn between.
struct HoverRanges {
  double gap_min_m = 0.06;  ///< between the hovering hand and the object
  double gap_max_m = 0.12;
  double noise_min_m = 0.003;  ///< standard deviation of a range
  double noise_max_m = 0.01;

  /// @throws ConfigError
  void validate() const;
};

/// An object on a table, and a hand that comes over it, hovers, and goes straight down on it.
struct HoverScene {
  std::string object;    ///< "box", "mug", "can", "ball" or "bottle"
  std::string approach;  ///< "above", "left", "right" or "behind"
  double gap_m = 0.0;    ///< between the hovering hand and the object, as the crow flies
  double noise_m = 0.0;
  double tilt_phase_rad = 0.0;
  World things;  ///< the object's parts; the table is not among them
  /// From aside of the object, where nothing hides it, over it, and down until the hand would be
  /// inside of it.
  ArmPath path;
  double via_m = 0.0;    ///< along the path: the last turn before the hand hovers
  double hover_m = 0.0;  ///< along the path: there the hand hovers
  double touch_m = 0.0;  ///< along the path: there it would touch the object
};

/// The same for the same seed. @throws ConfigError
[[nodiscard]] HoverScene hoverScene(const std::shared_ptr<const RobotModel>& model,
                                    const HoverRanges& ranges, std::uint64_t seed);

/// The right arm's links that could touch something below the hand.
[[nodiscard]] std::vector<std::string> hoveringLinks();

}  // namespace tccm::simulation
