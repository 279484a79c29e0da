#pragma once

#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>

#include <chrono>
#include <deque>
#include <memory>
#include <mutex>
#include <utility>

namespace tccm {

/// Runs the callbacks of one nodelet, one after the other, and none before start() or after stop():
/// what they use is made before the one and ended after the other, in any order, without a lock.
/// Until start() messages and calls wait. A nodelet manager's own threads offer neither: they call
/// back while the nodelet is still being made.
class CallbackThread {
 public:
  CallbackThread() : queue_(std::make_shared<ros::CallbackQueue>()), spinner_(1, queue_.get()) {}
  CallbackThread(const CallbackThread&) = delete;
  CallbackThread& operator=(const CallbackThread&) = delete;
  ~CallbackThread() {
    stop();
    retire(std::move(queue_));
  }

  /// What is subscribed, served and timed through the copy calls back here.
  [[nodiscard]] ros::NodeHandle copyOf(ros::NodeHandle node) {
    node.setCallbackQueue(queue_.get());
    return node;
  }
  void start() { spinner_.start(); }
  /// Waits for the callback that runs. What still waits is dropped.
  void stop() {
    queue_->disable();
    spinner_.stop();
    queue_->clear();
  }

 private:
  using Queue = std::shared_ptr<ros::CallbackQueue>;
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kKept{60};

  /// roscpp knows a server's queue by a bare pointer, and may put a call into it that came as the
  /// server ended. Disabled, it takes none; but it has to be there for a while.
  static void retire(Queue queue) {
    static std::mutex mutex;
    static std::deque<std::pair<Clock::time_point, Queue>> retired;
    const std::lock_guard<std::mutex> lock(mutex);
    const Clock::time_point now = Clock::now();
    while (!retired.empty() && now - retired.front().first > kKept) retired.pop_front();
    retired.emplace_back(now, std::move(queue));
  }

  Queue queue_;
  ros::AsyncSpinner spinner_;
};

}  // namespace tccm
