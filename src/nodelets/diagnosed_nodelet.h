#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <nodelet/nodelet.h>
#include <ros/ros.h>

#include <memory>
#include <string>

namespace tccm {

/// What the nodelets have in common. All callbacks of one run one after the other.
class DiagnosedNodelet : public nodelet::Nodelet {
 protected:
  /// @param what the diagnostics are about.
  explicit DiagnosedNodelet(std::string what) : what_(std::move(what)) {}

  /// What it throws is logged as one line and thrown on, so that the nodelet manager does not load
  /// the nodelet and lives on. Whatever may be refused comes before the first topic or service: the
  /// manager deletes the queues of callbacks before the nodelet, whose publishers would use them.
  virtual void setUp() = 0;
  virtual void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) = 0;
  /// Twice a second.
  virtual void nowAndThen() {}

  /// @pre the configuration was read: what refuses to start must not have advertised anything.
  [[nodiscard]] diagnostic_updater::Updater& diagnostics() {
    if (!diagnostics_) {
      diagnostics_ = std::make_unique<diagnostic_updater::Updater>(
          getNodeHandle(), getPrivateNodeHandle(), getName());
      diagnostics_->setHardwareID("none");
      diagnostics_->add(what_, this, &DiagnosedNodelet::diagnose);
    }
    return *diagnostics_;
  }
  /// By wall time, also where simulated time stands still.
  template <typename Callback>
  ros::WallTimer timer(double period_s, Callback callback) {
    return getNodeHandle().createWallTimer(ros::WallDuration(period_s),
                                           [callback](const ros::WallTimerEvent&) { callback(); });
  }

 private:
  void onInit() final {
    try {
      setUp();
    } catch (const std::exception& error) {
      ROS_FATAL("%s refuses to start: %s", getName().c_str(), error.what());
      throw;
    }
    diagnostics_timer_ = timer(0.5, [this] {
      nowAndThen();
      diagnostics().update();
    });
  }

  std::string what_;
  std::unique_ptr<diagnostic_updater::Updater> diagnostics_;
  ros::WallTimer diagnostics_timer_;
};

}  // namespace tccm
