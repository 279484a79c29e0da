#pragma once

#include <sensor_msgs/JointState.h>
#include <std_srvs/Trigger.h>
#include <tccm_monitor/AddExemption.h>
#include <tccm_monitor/CheckState.h>
#include <tccm_monitor/CheckTrajectory.h>
#include <tccm_monitor/CuboidMap.h>
#include <tccm_monitor/LiftExemption.h>
#include <tccm_monitor/ListExemptions.h>
#include <tccm_monitor/MonitorStatus.h>
#include <tccm_monitor/MotionPermission.h>
#include <tccm_monitor/ReportGoal.h>
#include <tccm_monitor/ScanReport.h>
#include <tccm_monitor/SetKeepOut.h>
#include <trajectory_msgs/JointTrajectory.h>

#include <cmath>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "nodelets/attachments.h"
#include "nodelets/diagnosed_nodelet.h"
#include "nodelets/scan_tracer.h"
#include "nodelets/sensor_feed.h"
#include "nodelets/tuning.h"
#include "ros/advice.h"
#include "ros/stop_cause.h"
#include "ros/stops/stop_recorder.h"
#include "ros/transform_history.h"

namespace tccm {

using tccm_monitor::AddExemption;
using tccm_monitor::CheckState;
using tccm_monitor::CheckTrajectory;
using tccm_monitor::LiftExemption;
using tccm_monitor::ListExemptions;
using tccm_monitor::ReportGoal;
using tccm_monitor::SetKeepOut;

/// Nodelet: `cuboid_map` and `scan_report` of each sensor, `joint_states`, `trajectory` and tf in;
/// `motion_permission`, flags and `monitor_status` out, from a timer whatever comes in, and at once
/// with each new map and when it gets worse.
class CollisionChecker : public DiagnosedNodelet {
 public:
  CollisionChecker() : DiagnosedNodelet("verdict") {}
  ~CollisionChecker() override { end(); }

 private:
  /// How long scans take; NaN where that is not known.
  struct Latencies {
    double scan_to_verdict_s = NAN;   ///< from the newest scan's last beam to the first check
    double transform_wait_s = NAN;    ///< of that scan
    double ready_to_verdict_s = NAN;  ///< from when scan and transforms were there
    double longest_s = 0.0;           ///< of the last, forgotten slowly
  };

  void setUp() override;
  /// Tells what is not compared with tf, as often as that becomes more, and stops that were lost.
  void nowAndThen() override;
  /// [s] that arms behind a TrajectoryGate take to halt.
  [[nodiscard]] double gatesStopDuration() const;
  void makeFeeds();
  void receiveMap(const SensorFeed& feed);
  void tellAttachments();
  void receiveReport(const SensorFeed& feed, const tccm_monitor::ScanReport& message);
  void receiveJoints(const ros::MessageEvent<sensor_msgs::JointState const>& event);
  void receiveTrajectory(const trajectory_msgs::JointTrajectory::ConstPtr& message);
  void receiveTransforms(const tf2_msgs::TFMessage& message, bool is_static);
  /// Where stops are to be kept.
  void makeRecorder();
  /// Once each time that it changes.
  void tellStopDefect();
  /// Now and then, off the way from a scan to its verdict.
  void compareWithModel();
  /// Checks, and publishes where it got worse. Whatever goes wrong is a fault.
  void check();
  void checkNow(const ros::Time& now);
  void becomeFault(Reason reason, const std::string& detail);
  /// Answers a question where time has begun. @param ask (Time now) -> Cause.
  template <typename Response, typename Ask>
  bool respond(Response& response, Ask&& ask);
  bool checkState(CheckState::Request& request, CheckState::Response& response);
  bool checkTrajectory(CheckTrajectory::Request& request, CheckTrajectory::Response& response);
  bool addExemption(AddExemption::Request& request, AddExemption::Response& response);
  bool setKeepOut(SetKeepOut::Request& request, SetKeepOut::Response& response);
  bool liftExemption(LiftExemption::Request& request, LiftExemption::Response& response);
  bool listExemptions(ListExemptions::Request& request, ListExemptions::Response& response);
  bool reportGoal(ReportGoal::Request& request, ReportGoal::Response& response);
  bool reset(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  /// What the core cannot know.
  [[nodiscard]] Cause outsideCause() const;
  void noteLatency(const SensorFeed& feed);
  /// What controllers obey. A permission is dated now, whatever the verdict's age.
  void publishPermission();
  void publish();
  void publishPictures();
  void publishCheckedMap();
  /// For others, such as a planner: what would stop the arm.
  void publishOccupied();
  /// Whether simulated time stands still, so that nothing can grow old by it.
  [[nodiscard]] bool clockStalls();
  void tellChange(const Verdict& verdict);
  /// What helps against what the last check found; empty where nothing has to.
  [[nodiscard]] std::string advice() const;
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) override;
  void diagnoseAgreement(diagnostic_updater::DiagnosticStatusWrapper& status) const;
  void diagnoseEvidence(diagnostic_updater::DiagnosticStatusWrapper& status) const;
  void diagnoseStops(diagnostic_updater::DiagnosticStatusWrapper& status) const;

  CheckerConfig config_;
  std::unique_ptr<Checker> checker_;
  std::unique_ptr<Attachments> attachments_;
  std::unique_ptr<Tuning> tuning_;
  std::unique_ptr<TransformHistory> transforms_;
  Verdict fault_;                              ///< stands in where no check could be made
  const Verdict* verdict_ = &fault_;           ///< the last
  std::list<SensorFeed> feeds_;                ///< in the sensors' order; they stay where they are
  ScanReport report_;                          ///< the newest, reused
  tccm_monitor::MotionPermission permission_;  ///< the last, reused
  ros::Publisher permission_publisher_, stop_publisher_, collision_publisher_, occlusion_publisher_,
      scale_publisher_, status_publisher_;
  ros::Publisher marker_publisher_, image_publisher_, checked_map_publisher_, occupied_publisher_;
  sensor_msgs::PointCloud2 occupied_;  ///< reused
  std::uint32_t permissions_ = 0;
  std::vector<ros::ServiceServer> services_;
  std::vector<ros::Subscriber> inputs_;
  ros::WallTimer publish_timer_, picture_timer_, export_timer_;
  std::unique_ptr<diagnostic_updater::TopicDiagnostic> joints_rate_;
  std::uint32_t seen_serial_ = 0;
  Latencies latencies_;
  ScanTracer trace_;
  double check_us_ = 0.0;
  double check_us_max_ = 0.0;
  std::size_t checks_ = 0;
  ros::Time checked_;          ///< at the last check
  ros::Time clock_;            ///< at the last publication
  ros::WallTime clock_moved_;  ///< when it last differed from the one before
  ToldChanges told_;
  StopCause stop_cause_;
  Advice advice_ = Advice::ofThePage();
  std::unique_ptr<StopRecorder> recorder_;  ///< null: stops are not kept
  std::string told_stop_defect_;
  bool told_velocity_ = false;
  bool told_limit_ = false;
  std::size_t told_not_compared_ = 0;
  Level published_ = Level::kFault;
};

}  // namespace tccm
