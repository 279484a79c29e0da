#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <dynamic_reconfigure/server.h>
#include <nodelet/nodelet.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <tccm_monitor/CheckState.h>
#include <tccm_monitor/CollisionCheckerConfig.h>
#include <tccm_monitor/CuboidMap.h>
#include <tccm_monitor/MonitorStatus.h>

#include <array>
#include <boost/thread/recursive_mutex.hpp>
#include <memory>
#include <string>

#include "tccm_monitor/check/checker.h"
#include "tccm_monitor/ros/attachments.h"
#include "tccm_monitor/ros/settings.h"
#include "tccm_monitor/ros/transform_listener.h"

namespace tccm {

/// Nodelet: `cuboid_map`, `joint_states` and tf in; `stop`, `collision`, `occlusion` and
/// `monitor_status` out, from a timer whatever comes in, and at once when it gets worse. All its
/// callbacks run one after the other.
class CollisionChecker : public nodelet::Nodelet {
 private:
  using Reconfiguration = tccm_monitor::CollisionCheckerConfig;

  void onInit() override;
  void setUp();
  void setUpReconfiguration();
  void receiveMap(const tccm_monitor::CuboidMap::ConstPtr& message);
  void receiveJoints(const sensor_msgs::JointState::ConstPtr& message);
  void receiveTransforms();
  void check();
  void publish();
  void publishPictures();
  /// Whether simulated time stands still, so that nothing can grow old by it.
  [[nodiscard]] bool clockStalls();
  void tellChange(const Verdict& verdict);
  bool checkState(tccm_monitor::CheckState::Request& request,
                  tccm_monitor::CheckState::Response& response);
  void reconfigure(Reconfiguration& wanted, std::uint32_t level);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);

  CheckerSettings settings_;
  std::unique_ptr<Checker> checker_;
  std::unique_ptr<Attachments> attachments_;
  std::unique_ptr<TransformListener> transforms_;
  boost::recursive_mutex reconfiguration_mutex_;  ///< the server wants one to be shared with it
  std::unique_ptr<dynamic_reconfigure::Server<Reconfiguration>> reconfiguration_;
  const Verdict* verdict_ = nullptr;  ///< the last; nothing before the first check
  std::array<std::shared_ptr<CuboidMap>, 2> maps_;
  std::size_t newest_map_ = 0;
  std::string map_defect_;
  ros::Publisher stop_publisher_, collision_publisher_, occlusion_publisher_;
  ros::Publisher status_publisher_, marker_publisher_, image_publisher_;
  ros::Subscriber map_subscriber_, joints_subscriber_;
  ros::ServiceServer state_service_;
  ros::WallTimer publish_timer_, picture_timer_, diagnostics_timer_;
  std::unique_ptr<diagnostic_updater::Updater> diagnostics_;
  std::uint32_t seen_serial_ = 0;
  double scan_to_verdict_s_ = 0.0;
  double check_us_ = 0.0;
  double check_us_max_ = 0.0;
  std::size_t checks_ = 0;
  ros::Time checked_;          ///< at the last check
  ros::Time clock_;            ///< at the last publication
  ros::WallTime clock_moved_;  ///< when it last differed from the one before
  Reason told_ = Reason::kClear;
  bool told_anything_ = false;
  Level published_ = Level::kFault;
};

}  // namespace tccm
