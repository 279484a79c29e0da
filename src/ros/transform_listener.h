#pragma once

#include <ros/node_handle.h>
#include <tf2/buffer_core.h>
#include <tf2_msgs/TFMessage.h>

#include <functional>

#include "ros/transform_history.h"

namespace tccm {

/// Feeds a TransformHistory from /tf and /tf_static, in the callback queue of the node it is given:
/// no thread of its own, so that what it feeds needs no lock.
class TransformListener {
 public:
  /// @param heard called after each message.
  TransformListener(ros::NodeHandle node, Duration gap_max, std::function<void()> heard);

  [[nodiscard]] const TransformHistory& history() const { return history_; }

 private:
  void receive(const tf2_msgs::TFMessage& message, bool is_static);

  tf2::BufferCore buffer_;
  TransformHistory history_;
  std::function<void()> heard_;
  ros::Subscriber moving_;
  ros::Subscriber static_;
};

}  // namespace tccm
