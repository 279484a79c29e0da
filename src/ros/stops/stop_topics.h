#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tccm {

/// What a stop's bag has on which topic.
struct StopTopic {
  std::string name, type, md5, definition;
};

/// Of topics that there is one of. Those of sensors follow.
enum class StopTopicId : std::uint8_t {
  kConfiguration,
  kRobotDescription,
  kPrimitives,
  kCalls,
  kState,
  kJoints,
  kTransforms,
  kStaticTransforms,
  kTrajectory,
};
/// Of topics that each sensor has.
enum class SensorTopicId : std::uint8_t { kReport, kMap, kMapChange, kPoints, kCloud };
constexpr std::uint8_t kTopicsOfSensor = 5;

[[nodiscard]] constexpr std::uint8_t topicIndex(StopTopicId id) {
  return static_cast<std::uint8_t>(id);
}
[[nodiscard]] constexpr std::uint8_t topicIndex(std::size_t sensor, SensorTopicId id) {
  return static_cast<std::uint8_t>(static_cast<std::size_t>(StopTopicId::kTrajectory) + 1 +
                                   sensor * kTopicsOfSensor + static_cast<std::size_t>(id));
}

/// By these indices. @param sensors names; empty: the only one.
[[nodiscard]] std::vector<StopTopic> stopTopics(const std::vector<std::string>& sensors);

}  // namespace tccm
