#pragma once

#include <ros/node_handle.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace tccm {

// What a nodelet publishes, hears and serves. roscpp returns an empty handle where it cannot, and
// says so in the log alone; here that is a refusal to start.

/// @throws std::runtime_error where the handle is empty.
template <typename Handle>
[[nodiscard]] Handle required(Handle handle, const ros::NodeHandle& node, const std::string& name) {
  if (handle) return handle;
  const std::string why =
      std::is_same_v<Handle, ros::ServiceServer>
          ? "this process serves it already: unload what does first"
          : "this process has a topic of this name with another type: remap one of them";
  throw std::runtime_error(node.resolveName(name) + ": roscpp refuses it; most likely " + why);
}

template <typename Message>
[[nodiscard]] ros::Publisher advertise(ros::NodeHandle node, const std::string& topic,
                                       std::uint32_t queue, bool latch = false) {
  return required(node.advertise<Message>(topic, queue, latch), node, topic);
}

template <typename Object, typename Request, typename Response>
[[nodiscard]] ros::ServiceServer serve(ros::NodeHandle node, const std::string& service,
                                       bool (Object::*answer)(Request&, Response&),
                                       Object* object) {
  return required(node.advertiseService(service, answer, object), node, service);
}

template <typename Object, typename Message>
[[nodiscard]] ros::Subscriber hear(ros::NodeHandle node, const std::string& topic,
                                   std::uint32_t queue, void (Object::*receive)(const Message&),
                                   Object* object) {
  return required(node.subscribe(topic, queue, receive, object, ros::TransportHints().tcpNoDelay()),
                  node, topic);
}

}  // namespace tccm
