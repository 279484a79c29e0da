#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <diagnostic_updater/publisher.h>
#include <nodelet/nodelet.h>
#include <ros/ros.h>

#include <boost/shared_ptr.hpp>
#include <limits>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "nodelets/callback_thread.h"
#include "ros/handles.h"
#include "ros/message_pool.h"

namespace tccm {

/// What the nodelets have in common. All callbacks of one run one after the other, from when it is
/// set up until it ends.
class DiagnosedNodelet : public nodelet::Nodelet {
 protected:
  /// @param what the diagnostics are about.
  explicit DiagnosedNodelet(std::string what) : what_(std::move(what)) {}

  /// Nothing is called back before it has returned. What it throws is logged as one line and thrown
  /// on: the nodelet is not loaded, and its manager lives on.
  virtual void setUp() = 0;
  /// Nothing is called back from then on. Each nodelet's destructor begins with it: its members end
  /// before those of this class do.
  void end() {
    if (thread_) thread_->stop();
  }
  virtual void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) = 0;
  /// Twice a second.
  virtual void nowAndThen() {}

  /// In the nodelet's namespace.
  [[nodiscard]] const ros::NodeHandle& node() const { return *node_; }
  /// In its private one.
  [[nodiscard]] const ros::NodeHandle& privateNode() const { return *private_node_; }
  /// Advertises them: after what may be refused.
  [[nodiscard]] diagnostic_updater::Updater& diagnostics() {
    if (!diagnostics_) {
      diagnostics_.emplace(node(), privateNode(), getName());
      diagnostics_->setHardwareID("none");
      diagnostics_->add(what_, this, &DiagnosedNodelet::diagnose);
    }
    return *diagnostics_;
  }
  /// Rate and age of an input's messages (REP 107), to be told of each. Older is an error, as are
  /// fewer than one in age_max_s, and a stamp that leads by more than future_max_s.
  [[nodiscard]] std::unique_ptr<diagnostic_updater::TopicDiagnostic> watch(const std::string& topic,
                                                                           double age_max_s,
                                                                           double future_max_s) {
    double& rate_min_hz = rates_min_hz_.emplace_back(1.0 / age_max_s);
    return std::make_unique<diagnostic_updater::TopicDiagnostic>(
        topic, diagnostics(),
        diagnostic_updater::FrequencyStatusParam(&rate_min_hz, &rate_max_hz_, 0.0),
        diagnostic_updater::TimeStampStatusParam(-future_max_s, age_max_s));
  }
  template <typename Received, typename Derived>
  [[nodiscard]] ros::Subscriber hear(const std::string& topic, std::uint32_t queue,
                                     void (Derived::*receive)(const Received&)) {
    return tccm::hear(node(), topic, queue, receive, static_cast<Derived*>(this));
  }
  /// By wall time, also where simulated time stands still.
  template <typename Callback>
  [[nodiscard]] ros::WallTimer timer(double period_s, Callback callback) {
    return node().createWallTimer(ros::WallDuration(period_s),
                                  [callback](const ros::WallTimerEvent&) { callback(); });
  }

 private:
  void onInit() final {
    try {
      thread_.emplace();
      node_.emplace(thread_->copyOf(getNodeHandle()));
      private_node_.emplace(thread_->copyOf(getPrivateNodeHandle()));
      setUp();
    } catch (const std::exception& error) {
      ROS_FATAL("%s refuses to start: %s", getName().c_str(), error.what());
      throw;
    }
    diagnostics_timer_ = timer(0.5, [this] {
      nowAndThen();
      diagnostics().update();
    });
    thread_->start();
  }

  std::string what_;
  std::optional<CallbackThread> thread_;
  std::optional<ros::NodeHandle> node_, private_node_;
  std::list<double> rates_min_hz_;  ///< of what is watched, where they stay
  double rate_max_hz_ = std::numeric_limits<double>::infinity();
  std::optional<diagnostic_updater::Updater> diagnostics_;
  ros::WallTimer diagnostics_timer_;
};

}  // namespace tccm
