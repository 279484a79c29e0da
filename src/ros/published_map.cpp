#include "ros/published_map.h"

#include <algorithm>

#include "ros/conversions.h"

namespace tccm {

void toMessage(const PublishedMap& published, tccm_monitor::CuboidMap& message) {
  toMessage(*published.map, published.frame, message);
  message.attached_stamp = published.attached_stamp;
}

void fromMessage(const tccm_monitor::CuboidMap& message, PublishedMap& published) {
  // Of a sensor that has failed the checker keeps the last map that was good.
  if (!published.map || published.map.use_count() > 1) {
    published.map = std::make_shared<CuboidMap>();
  }
  published.frame = message.header.frame_id;
  published.attached_stamp = message.attached_stamp;
  published.defect = fromMessage(message, *published.map);
}

std::uint32_t serializedLength(const PublishedMap& published) {
  using ros::serialization::serializationLength;
  static const std::uint32_t without_lists = serializationLength(tccm_monitor::CuboidMap());
  static const std::uint32_t cuboid = serializationLength(tccm_monitor::Cuboid());
  constexpr std::size_t kPass = 2 * sizeof(std::uint32_t) + sizeof(std::uint16_t) + 2;
  const LookImage& looks = published.map->looks;
  const auto rows = static_cast<std::size_t>(std::max(0, looks.rowEnd() - looks.rowBegin()));
  const std::size_t passes =
      rows * static_cast<std::size_t>(looks.grid().columns()) * LookImage::kPasses;
  return without_lists +
         static_cast<std::uint32_t>(published.frame.size() +
                                    published.map->cuboids.size() * cuboid + passes * kPass);
}

}  // namespace tccm
