#include "simulation/truth.h"

#include <nlohmann/json.hpp>

namespace tccm::simulation {
namespace {

nlohmann::json stampOrNull(const std::optional<Time>& stamp) {
  return stamp ? nlohmann::json(toSeconds(*stamp)) : nlohmann::json();
}

nlohmann::json numberOrNull(const std::optional<double>& number) {
  return number ? nlohmann::json(*number) : nlohmann::json();
}

}  // namespace

nlohmann::json toJson(const HandSample& sample) {
  return {{"stamp_s", toSeconds(sample.stamp)},
          {"palm_m", {sample.palm.x(), sample.palm.y(), sample.palm.z()}},
          {"speed_mps", sample.speed_mps},
          {"hand_obstacle_m", numberOrNull(sample.obstacle_m)},
          {"braking", sample.braking}};
}

nlohmann::json toJson(const Truth& truth) {
  nlohmann::json hand = nlohmann::json::array();
  for (const HandSample& sample : truth.hand) hand.push_back(toJson(sample));
  return {{"obstacle_appeared_s", stampOrNull(truth.appeared)},
          {"obstacle_in_place_s", stampOrNull(truth.in_place)},
          {"first_beam_s", stampOrNull(truth.first_beam)},
          {"stop_asserted_s", stampOrNull(truth.stop_asserted)},
          {"halted_s", stampOrNull(truth.halted)},
          {"hand_obstacle_min_m", numberOrNull(truth.obstacle_min_m)},
          {"hand", hand}};
}

}  // namespace tccm::simulation
