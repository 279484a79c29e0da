#pragma once

#include <sensor_msgs/JointState.h>
#include <tccm_monitor/CuboidMap.h>
#include <tccm_monitor/MonitorStatus.h>
#include <tccm_monitor/ScanReport.h>
#include <trajectory_msgs/JointTrajectory.h>

#include <array>
#include <limits>
#include <map>
#include <memory>
#include <string>

#include "nodelets/attachments.h"
#include "nodelets/checker_services.h"
#include "nodelets/diagnosed_nodelet.h"
#include "nodelets/input_diagnostics.h"
#include "nodelets/permission_publisher.h"
#include "nodelets/tuning.h"
#include "ros/transform_listener.h"

namespace tccm {

/// Nodelet: `cuboid_map`, `scan_report`, `joint_states`, `trajectory` and tf in;
/// `motion_permission`, flags and `monitor_status` out, from a timer whatever comes in, and at once
/// with each new map and when it gets worse.
class CollisionChecker : public DiagnosedNodelet {
 public:
  CollisionChecker() : DiagnosedNodelet("verdict") {}

 private:
  /// How long scans take; NaN where that is not known.
  struct Latencies {
    static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    double scan_to_verdict_s = kUnknown;   ///< from the newest scan's last beam to the first check
    double transform_wait_s = kUnknown;    ///< of that scan
    double ready_to_verdict_s = kUnknown;  ///< from when scan and transforms were there
    double longest_s = 0.0;                ///< of the last, forgotten slowly
  };

  void setUp() override;
  void advertise();
  void subscribe();
  void receiveMap(const tccm_monitor::CuboidMap::ConstPtr& message);
  void receiveReport(const tccm_monitor::ScanReport::ConstPtr& message);
  void receiveJoints(const sensor_msgs::JointState::ConstPtr& message);
  void receiveTrajectory(const trajectory_msgs::JointTrajectory::ConstPtr& message);
  void receiveTransforms();
  void placeRootsInFixedFrame();
  /// Checks, and publishes where it got worse. Whatever goes wrong is a fault.
  void check();
  void checkNow(const ros::Time& now);
  void becomeFault(Reason reason, const std::string& detail);
  /// What the core cannot know.
  [[nodiscard]] Cause outsideCause() const;
  void noteLatency();
  void publishPermission();
  void publish();
  void publishPictures();
  /// The map of the last check, with col as it found it.
  void publishCheckedMap();
  /// Whether simulated time stands still, so that nothing can grow old by it.
  [[nodiscard]] bool clockStalls();
  void tellChange(const Verdict& verdict);
  void tellOnce();
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) override;
  void diagnoseEvidence(diagnostic_updater::DiagnosticStatusWrapper& status) const;

  CheckerConfig config_;
  std::unique_ptr<Checker> checker_;
  std::unique_ptr<Attachments> attachments_;
  std::unique_ptr<CheckerServices> services_;
  std::unique_ptr<Tuning> tuning_;
  std::unique_ptr<PermissionPublisher> permission_;
  std::unique_ptr<TransformListener> transforms_;
  Verdict fault_;                     ///< stands in where no check could be made
  const Verdict* verdict_ = &fault_;  ///< the last
  std::array<std::shared_ptr<CuboidMap>, 2> maps_;
  std::size_t newest_map_ = 0;
  tccm_monitor::CuboidMap::ConstPtr map_message_;  ///< of the newest map
  std::size_t maps_dropped_ = 0;
  std::string map_defect_;
  tccm_monitor::ScanReport assembled_;  ///< the newest report of a scan that was assembled
  std::map<std::string, std::size_t> scans_dropped_;
  ros::Publisher status_publisher_, marker_publisher_, image_publisher_, checked_map_publisher_;
  ros::Subscriber map_subscriber_, report_subscriber_, joints_subscriber_, trajectory_subscriber_;
  ros::WallTimer publish_timer_, picture_timer_;
  std::unique_ptr<InputDiagnostics> map_rate_, joints_rate_, scan_rate_;
  std::uint32_t seen_serial_ = 0;
  Latencies latencies_;
  double check_us_ = 0.0;
  double check_us_max_ = 0.0;
  std::size_t checks_ = 0;
  ros::Time checked_;          ///< at the last check
  ros::Time clock_;            ///< at the last publication
  ros::WallTime clock_moved_;  ///< when it last differed from the one before
  Reason told_ = Reason::kClear;
  bool told_anything_ = false;
  bool told_velocity_ = false;
  Level published_ = Level::kFault;
};

}  // namespace tccm
