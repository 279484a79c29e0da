#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "tccm_monitor/pose.h"
#include "tccm_monitor/time.h"

namespace tccm::simulation {

/// The right hand (wrist, palm, fingers) at one instant.
struct HandSample {
  Time stamp;
  Vector3 palm;                      ///< centre, fixed frame [m]
  double speed_mps;                  ///< along its path, negative on the way back, unless commanded
  std::optional<double> obstacle_m;  ///< distance to the obstacle, once it is there
  bool braking;                      ///< or holding: the controller obeys a stop
};

/// What really happened, to judge a monitor by.
struct Truth {
  std::optional<Time> appeared;       ///< the obstacle is in the scene
  std::optional<Time> in_place;       ///< and no longer moves
  std::optional<Time> first_beam;     ///< the first return from the obstacle that is no mixed pixel
  std::optional<Time> stop_asserted;  ///< the last time the controller began to hear a stop
  std::optional<Time> halted;         ///< the last time the hand came to rest on a stop
  std::optional<double> obstacle_min_m;  ///< least distance so far
  std::vector<HandSample> hand;          ///< at 100 Hz
};

[[nodiscard]] nlohmann::json toJson(const HandSample& sample);
/// Stamps in seconds; null for what did not happen.
[[nodiscard]] nlohmann::json toJson(const Truth& truth);

}  // namespace tccm::simulation
