#include "ros/transform_listener.h"

#include <utility>

namespace tccm {
namespace {

constexpr Duration kKept = std::chrono::seconds(10);  // what tf2 keeps by default

}  // namespace

TransformListener::TransformListener(ros::NodeHandle node, Duration gap_max,
                                     std::function<void()> heard)
    : history_(buffer_, gap_max, kKept), heard_(std::move(heard)) {
  using Message = tf2_msgs::TFMessage::ConstPtr;
  const auto hints = ros::TransportHints().tcpNoDelay();
  moving_ = node.subscribe<tf2_msgs::TFMessage>(
      "/tf", 1000, [this](const Message& m) { receive(*m, false); }, ros::VoidConstPtr(), hints);
  static_ = node.subscribe<tf2_msgs::TFMessage>(
      "/tf_static", 100, [this](const Message& m) { receive(*m, true); }, ros::VoidConstPtr(),
      hints);
}

void TransformListener::receive(const tf2_msgs::TFMessage& message, bool is_static) {
  history_.add(message, is_static);
  if (heard_) heard_();
}

}  // namespace tccm
