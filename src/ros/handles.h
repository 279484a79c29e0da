#pragma once

#include <ros/node_handle.h>
#include <ros/single_subscriber_publisher.h>

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "ros/message_pool.h"

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

/// Counts who listens as they come and go: to ask the publisher each time takes a lock.
/// @param who a node's name; empty: all of them.
template <typename Message>
[[nodiscard]] ros::Publisher advertiseCounting(ros::NodeHandle node, const std::string& topic,
                                               std::uint32_t queue, int& listeners,
                                               const std::string& who = {}) {
  const auto counts = [&listeners, who](int change) {
    return [&listeners, who, change](const ros::SingleSubscriberPublisher& listener) {
      if (who.empty() || listener.getSubscriberName() == who) listeners += change;
    };
  };
  return required(node.advertise<Message>(topic, queue, counts(1), counts(-1)), node, topic);
}

template <typename Object, typename Request, typename Response>
[[nodiscard]] ros::ServiceServer serve(ros::NodeHandle node, const std::string& service,
                                       bool (Object::*answer)(Request&, Response&),
                                       Object* object) {
  return required(node.advertiseService(service, answer, object), node, service);
}

/// What comes from another process is read into messages that were used before: a cloud of
/// megabytes is not allocated and filled with zeros each time.
/// @tparam Received a pointer to a constant message, or a ros::MessageEvent of one.
template <typename Object, typename Received>
[[nodiscard]] ros::Subscriber hear(ros::NodeHandle node, const std::string& topic,
                                   std::uint32_t queue, void (Object::*receive)(const Received&),
                                   Object* object) {
  using Message = typename ros::ParameterAdapter<const Received&>::Message;
  // Subscribers of a process share what they hear: any of their threads may ask for a message.
  const auto pool = std::make_shared<SharedMessagePool<Message>>();
  ros::SubscribeOptions options;
  options.initByFullCallbackType<const Received&>(
      topic, queue, [receive, object](const Received& received) { (object->*receive)(received); },
      [pool] { return pool->take(); });
  options.transport_hints = ros::TransportHints().tcpNoDelay();
  return required(node.subscribe(options), node, topic);
}

}  // namespace tccm
