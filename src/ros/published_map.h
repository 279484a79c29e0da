#pragma once

#include <ros/message_traits.h>
#include <ros/serialization.h>
#include <tccm_monitor/CuboidMap.h>

#include <boost/shared_ptr.hpp>
#include <cstdint>
#include <memory>
#include <string>

#include "tccm_monitor/cuboid_map.h"

namespace tccm {

/// A map on its topic. Others hear it as a tccm_monitor/CuboidMap; who hears it in the process that
/// publishes it gets it as it is, and nobody turns cuboids and looks into a message and back.
struct PublishedMap {
  using ConstPtr = boost::shared_ptr<const PublishedMap>;

  std::shared_ptr<CuboidMap> map;  ///< not changed any more by whoever publishes it
  std::string frame;
  ros::Time attached_stamp;  ///< as CuboidMap.msg's
  std::string defect;  ///< why what came from another process is no map; empty where it is one
};

/// Reuses the message's memory.
void toMessage(const PublishedMap& published, tccm_monitor::CuboidMap& message);
/// Sets the defect where the message is no map. @param published reused: its map where nobody else
/// has it.
void fromMessage(const tccm_monitor::CuboidMap& message, PublishedMap& published);
/// The bytes of its message, without making it.
[[nodiscard]] std::uint32_t serializedLength(const PublishedMap& published);

}  // namespace tccm

namespace ros {
namespace message_traits {

template <>
struct MD5Sum<tccm::PublishedMap> : MD5Sum<tccm_monitor::CuboidMap> {
  using MD5Sum<tccm_monitor::CuboidMap>::value;
  static const char* value(const tccm::PublishedMap& /*published*/) { return value(); }
};
template <>
struct DataType<tccm::PublishedMap> : DataType<tccm_monitor::CuboidMap> {
  using DataType<tccm_monitor::CuboidMap>::value;
  static const char* value(const tccm::PublishedMap& /*published*/) { return value(); }
};
template <>
struct Definition<tccm::PublishedMap> : Definition<tccm_monitor::CuboidMap> {
  using Definition<tccm_monitor::CuboidMap>::value;
  static const char* value(const tccm::PublishedMap& /*published*/) { return value(); }
};

}  // namespace message_traits

namespace serialization {

template <>
struct Serializer<tccm::PublishedMap> {
  template <typename Stream>
  static void write(Stream& stream, const tccm::PublishedMap& published) {
    thread_local tccm_monitor::CuboidMap message;  // reused
    toMessage(published, message);
    stream.next(message);
  }
  template <typename Stream>
  static void read(Stream& stream, tccm::PublishedMap& published) {
    thread_local tccm_monitor::CuboidMap message;
    stream.next(message);
    fromMessage(message, published);
  }
  static std::uint32_t serializedLength(const tccm::PublishedMap& published) {
    return tccm::serializedLength(published);
  }
};

}  // namespace serialization
}  // namespace ros
