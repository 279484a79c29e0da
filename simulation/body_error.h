#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tccm_monitor/robot_model.h"
#include "tccm_monitor/shape.h"

namespace tccm::simulation {

/// How a robot differs from its description.
struct BodyError {
  enum class Kind {
    kThicker,    ///< every primitive is larger by size_m on each side
    kThinner,    ///< every primitive is smaller by size_m on each side
    kDisplaced,  ///< every primitive is size_m aside, each in a direction of its own
  };
  Kind kind = Kind::kDisplaced;
  double size_m = 0.0;

  /// @throws ConfigError
  void validate() const;
};

/// "thicker", "thinner" or "displaced". @throws ConfigError
[[nodiscard]] BodyError::Kind bodyErrorKind(const std::string& name);

/// What the described primitives really are, each in the frame of the described one.
/// @throws ConfigError where a primitive is too thin to become thinner.
[[nodiscard]] std::vector<PlacedShape> trueShapes(const std::vector<LinkShape>& described,
                                                  const BodyError& error, std::uint64_t seed);

}  // namespace tccm::simulation
