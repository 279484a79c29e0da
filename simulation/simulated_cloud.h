#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "scan/cloud.h"
#include "simulation/snapshot.h"

namespace tccm::simulation {

/// What a point of a cloud really shows: a BeamTruth, kept small, as there are millions a second.
struct PointTruth {
  static constexpr std::uint32_t kNothing = std::numeric_limits<std::uint32_t>::max();

  std::uint32_t label = kNothing;  ///< of the surface on the ray's axis
  /// Of the other surface where the range lies between two, as BeamTruth has it; else kNothing.
  std::uint32_t mixed_with = kNothing;

  [[nodiscard]] bool found() const { return label != kNothing; }
  [[nodiscard]] bool mixed() const { return mixed_with != kNothing; }
  /// Which of two mixed surfaces is the nearer one is not told.
  [[nodiscard]] BeamTruth beam() const {
    BeamTruth truth;
    if (found()) truth.label = label;
    truth.mixed = mixed();
    if (mixed()) {
      truth.mixed_near = label;
      truth.mixed_far = mixed_with;
    }
    return truth;
  }
};

struct SimulatedCloud {
  Cloud cloud;
  std::vector<PointTruth> truth;  ///< one for each point
};

}  // namespace tccm::simulation
