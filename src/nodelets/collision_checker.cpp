#include "nodelets/collision_checker.h"

#include <sensor_msgs/Image.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Float64.h>
#include <visualization_msgs/MarkerArray.h>

#include <algorithm>
#include <pluginlib/class_list_macros.hpp>
#include <utility>

#include "base/stopwatch.h"
#include "check/model_agreement.h"
#include "nodelets/markers.h"
#include "nodelets/status_conversions.h"
#include "ros/checker_frames.h"
#include "ros/conversions.h"
#include "ros/server_config.h"

namespace tccm {
namespace {

constexpr double kClockStallMax = 0.5;  // [s] of wall time; recordings' clocks come in bursts
constexpr double kLatencyMax = 0.2;  // [s] by which margins grow; a slower machine is late anyway
constexpr double kLatencyForgotten = 0.99;  // kept of the longest latency at each new map

/// A std_msgs/Bool or Float64.
template <typename Message, typename Value>
void publishValue(const ros::Publisher& publisher, Value value) {
  Message message;
  message.data = value;
  publisher.publish(message);
}

}  // namespace

void CollisionChecker::setUp() {
  config_ = configFrom<CheckerConfig>(privateNode());
  tellDifferences(privateNode(), config_);
  config_.fixed_frame = withoutSlash(config_.fixed_frame);
  config_.checker.inputs.fixed_frame = config_.fixed_frame;
  double& stop_duration_s = config_.checker.braking.stop_duration_s;
  stop_duration_s = std::max(stop_duration_s, gatesStopDuration());
  checker_ = std::make_unique<Checker>(sharedRobotModel(node()), config_.checker);
  NODELET_INFO("Self-test passed: a cuboid in any of %zu primitives is found.",
               checker_->checkHere().collisionBody().shapes.size());
  becomeFault(Reason::kInit, "nothing was checked yet");
  // Poses are asked for that are as old as they may be; the agreement looks back for 3 s.
  const Duration oldest = fromSeconds(config_.checker.inputs.transform_timeout_s);
  transforms_ = std::make_unique<TransformHistory>(oldest, oldest + std::chrono::seconds(4));
  permission_publisher_ =
      advertise<tccm_monitor::MotionPermission>(node(), "motion_permission", 10);
  stop_publisher_ = advertise<std_msgs::Bool>(node(), "stop", 10);
  collision_publisher_ = advertise<std_msgs::Bool>(node(), "collision", 10);
  occlusion_publisher_ = advertise<std_msgs::Bool>(node(), "occlusion", 10);
  scale_publisher_ = advertise<std_msgs::Float64>(node(), "speed_scale", 10);
  status_publisher_ = advertise<tccm_monitor::MonitorStatus>(node(), "monitor_status", 10);
  marker_publisher_ = advertise<visualization_msgs::MarkerArray>(node(), "robot_markers", 2);
  image_publisher_ = advertise<sensor_msgs::Image>(node(), "occlusion_image", 2);
  checked_map_publisher_ = advertise<tccm_monitor::CuboidMap>(node(), "checked_map", 2);
  occupied_publisher_ = advertise<sensor_msgs::PointCloud2>(node(), "occupied_points", 2);
  trace_.begin(node());
  const CheckInputs::Config& limits = config_.checker.inputs;
  joints_rate_ = watch("joint_states", limits.joint_timeout_s, limits.future_max_s);
  makeFeeds();
  if (!config_.stops.folder.empty()) makeRecorder();
  attachments_ = std::make_unique<Attachments>(node(), config_, *checker_);
  services_ = {serve(node(), "check_state", &CollisionChecker::checkState, this),
               serve(node(), "check_trajectory", &CollisionChecker::checkTrajectory, this),
               serve(node(), "add_exemption", &CollisionChecker::addExemption, this),
               serve(node(), "set_keep_out", &CollisionChecker::setKeepOut, this),
               serve(node(), "lift_exemption", &CollisionChecker::liftExemption, this),
               serve(node(), "list_exemptions", &CollisionChecker::listExemptions, this),
               serve(node(), "report_goal", &CollisionChecker::reportGoal, this),
               serve(node(), "reset", &CollisionChecker::reset, this)};
  tuning_ = std::make_unique<Tuning>(privateNode(), config_, *checker_);
  inputs_ = hearTransforms(node(), *transforms_, [this](const auto& message, bool is_static) {
    receiveTransforms(message, is_static);
  });
  for (SensorFeed& feed : feeds_) feed.begin(node());
  inputs_.push_back(hear("joint_states", 200, &CollisionChecker::receiveJoints));
  inputs_.push_back(hear("trajectory", 20, &CollisionChecker::receiveTrajectory));
  publish_timer_ = timer(1.0 / config_.publish_rate_hz, [this] {
    checker_->inputs().setClockStalls(clockStalls());
    attachments_->hurry();
    compareWithModel();
    check();
    publish();
  });
  picture_timer_ = timer(1.0 / config_.marker_rate_hz, [this] { publishPictures(); });
  export_timer_ = timer(1.0 / config_.export_rate_hz, [this] { publishOccupied(); });
}

double CollisionChecker::gatesStopDuration() const {
  GateConfig gate;
  // Of keys that nothing reads the gate tells.
  load(parametersOf(ros::NodeHandle(node(), MonitorConfig::kGateSection)),
       MonitorConfig::kGateSection, gate);
  if (!gate.controllers.empty()) {
    NODELET_INFO("Arms take up to %.3g s to halt, as %s has it.", gate.stopDurationMax(),
                 node().resolveName(MonitorConfig::kGateSection).c_str());
  }
  return gate.stopDurationMax();
}

void CollisionChecker::makeFeeds() {
  const CheckInputs::Config& limits = config_.checker.inputs;
  const auto watched = [&](const std::string& topic) {
    return watch(topic, limits.map_age_max_s, limits.future_max_s);
  };
  const SensorFeed::Takers takers{
      [this](SensorFeed& feed) { receiveMap(feed); },
      [this](const SensorFeed& feed, const tccm_monitor::ScanReport& report) {
        receiveReport(feed, report);
      }};
  for (const SensorInput& sensor : checker_->inputs().sensors()) {
    feeds_.emplace_back(feeds_.size(), sensor.name(), config_.fixed_frame, takers, watched);
  }
}

void CollisionChecker::receiveMap(const SensorFeed& feed) {
  trace_.forget();
  trace_.note("the checker has it");
  const Time now = toTime(ros::Time::now());
  checker_->setMap(now, feed.published()->map, feed.sensor());
  if (recorder_) recorder_->mapComes(now, feed.published(), feed.sensor());
  tellAttachments();
  check();
  trace_.note("checked");
  publishPermission();
  trace_.note("the permission is published");
  noteLatency(feed);
  trace_.publish(toRos(feed.published()->map->stamp));
  if (recorder_) recorder_->commit();
}

/// What all sensors' maps have taken into account.
void CollisionChecker::tellAttachments() {
  ros::Time took = ros::TIME_MAX, since = ros::TIME_MAX;
  for (const SensorFeed& feed : feeds_) {
    // Nobody waits for one that has failed and need not be there.
    if (!checker_->inputs().outText(feed.sensor()).empty()) continue;
    if (!feed.published()) return;
    const CuboidMap& map = *feed.published()->map;
    took = std::min(took, feed.published()->attached_stamp);
    since = std::min(since, toRos(map.stamp - map.window));
  }
  attachments_->mapCame(took, since);
}

void CollisionChecker::receiveReport(const SensorFeed& feed,
                                     const tccm_monitor::ScanReport& message) {
  fromMessage(message, report_);
  if (report_.outcome == ScanReport::Outcome::kWaiting) {
    checker_->agreement().watchSensor(withoutSlash(message.header.frame_id));
  }
  const Time now = toTime(ros::Time::now());
  checker_->addScanReport(now, report_, feed.sensor());
  if (recorder_) recorder_->report(now, message, feed.sensor());
}

void CollisionChecker::receiveJoints(
    const ros::MessageEvent<sensor_msgs::JointState const>& event) {
  const auto& message = event.getConstMessage();
  joints_rate_->tick(message->header.stamp);
  const Time now = toTime(ros::Time::now());
  checker_->addJoints(now, toTime(message->header.stamp), message->name, message->position,
                      message->velocity, event.getPublisherName());
  if (recorder_) recorder_->joints(now, *message, event.getPublisherName());
  check();
}

void CollisionChecker::receiveTrajectory(
    const trajectory_msgs::JointTrajectory::ConstPtr& message) {
  const ros::Time now = ros::Time::now();
  if (now.isZero()) return;
  const std::string defect = checker_->command(toTime(now), tccm::fromMessage(*message));
  if (!defect.empty())
    NODELET_ERROR("A commanded trajectory is not understood: %s.", defect.c_str());
  if (recorder_) recorder_->trajectory(toTime(now), *message);
  check();
}

void CollisionChecker::receiveTransforms(const tf2_msgs::TFMessage& message, bool is_static) {
  placeFrames(*transforms_, config_.fixed_frame, *checker_);
  if (recorder_) recorder_->transforms(toTime(ros::Time::now()), message, is_static);
}

void CollisionChecker::becomeFault(Reason reason, const std::string& detail) {
  fault_ = Verdict();
  fault_.level = levelOf(reason);
  fault_.reason = reason;
  fault_.reasons = {reason};
  fault_.detail = detail;
  verdict_ = &fault_;
}

Cause CollisionChecker::outsideCause() const {
  Cause cause;
  if (const char* unknown = attachments_->unknown()) cause = {Reason::kInit, unknown};
  const double limit_us = 1e6 * config_.check_time_max_periods / config_.publish_rate_hz;
  if (check_us_ > limit_us) {
    cause = {Reason::kCheckLate,
             "the last check took " + std::to_string(static_cast<long>(check_us_)) +
                 " us, at most " + std::to_string(static_cast<long>(limit_us)) + " are allowed"};
  }
  return cause;
}

void CollisionChecker::check() {
  try {
    checkNow(ros::Time::now());
  } catch (const std::exception& error) {  // silence would be worse
    NODELET_ERROR_THROTTLE(1.0, "The check failed: %s.", error.what());
    const Time now = toTime(ros::Time::now());
    const Cause cause{Reason::kInternal, error.what()};
    verdict_ = &checker_->fail(now, cause);
    if (recorder_) recorder_->fail(now, cause, *verdict_);
  }
  tellChange(*verdict_);
  stop_cause_.follow(*verdict_, checker_->map());
  if (verdict_->level > published_) publish();
}

void CollisionChecker::checkNow(const ros::Time& now) {
  if (now + ros::Duration(config_.checker.inputs.future_max_s) < checked_) {
    attachments_->timeJumpedBack();
  }
  checked_ = now;
  if (now.isZero()) {  // simulated time has not begun, or begins anew
    checker_->startAnew();
    if (recorder_) recorder_->startAnew(Time());
    return becomeFault(Reason::kInit, "simulated time has not begun");
  }
  transforms_->setNow(toTime(now));
  placeRootsInFixedFrame(config_.fixed_frame, *checker_);
  const Cause outside = outsideCause();
  checker_->setOutsideCause(outside);
  Stopwatch stopwatch;
  verdict_ = &checker_->check(toTime(now));
  check_us_ = stopwatch.lapMicroseconds();
  if (recorder_) {
    recorder_->check(toTime(now), outside, *verdict_, *checker_, config_);
  }
  check_us_max_ = std::max(check_us_max_, check_us_);
  ++checks_;
  const Cause late = outsideCause();  // as long as this check took
  if (late.reason == Reason::kCheckLate) {
    verdict_ = &checker_->fail(toTime(now), late);
    if (recorder_) recorder_->fail(toTime(now), late, *verdict_);
  }
  if (checker_->map() && verdict_->serial != seen_serial_) {
    seen_serial_ = verdict_->serial;
    latencies_.scan_to_verdict_s = toSeconds(verdict_->stamp - checker_->map()->stamp);
  }
}

void CollisionChecker::noteLatency(const SensorFeed& feed) {
  const tccm_monitor::ScanReport& assembled = feed.assembled();
  if (toTime(assembled.header.stamp) != feed.published()->map->stamp) return;
  latencies_.transform_wait_s = static_cast<double>(assembled.transform_wait_s);
  const Time wall(std::chrono::nanoseconds(ros::WallTime::now().toNSec()));
  latencies_.ready_to_verdict_s = toSeconds(wall - toTime(assembled.ready_wall));
  latencies_.longest_s = std::min(kLatencyMax, std::max(kLatencyForgotten * latencies_.longest_s,
                                                        latencies_.ready_to_verdict_s));
  checker_->setLatency(latencies_.longest_s);
}

void CollisionChecker::tellChange(const Verdict& verdict) {
  const std::string& defect = checker_->inputs().jointStates().velocityDefect();
  if (!defect.empty() && !std::exchange(told_velocity_, true)) {
    NODELET_WARN("Velocities are taken from positions where they are larger: %s.", defect.c_str());
  }
  const std::string& limit = checker_->inputs().jointStates().limitDefect();
  if (!limit.empty() && !std::exchange(told_limit_, true)) NODELET_WARN("%s.", limit.c_str());
  if (!told_.isNews(verdict)) return;
  const std::string what = verdict.level == Level::kOk
                               ? "OK: the robot may move"
                               : std::string(tccm::name(verdict.level)) + " " +
                                     tccm::name(verdict.reason) + ": " + verdict.detail;
  if (verdict.level >= Level::kStop) {
    NODELET_WARN("%s.", what.c_str());
  } else {
    NODELET_INFO("%s.", what.c_str());
  }
}

bool CollisionChecker::clockStalls() {
  const ros::Time now = ros::Time::now();
  const ros::WallTime wall = ros::WallTime::now();
  if (now != clock_ || clock_moved_.isZero()) clock_moved_ = wall;
  clock_ = now;
  return ros::Time::isSimTime() && !now.isZero() && (wall - clock_moved_).toSec() > kClockStallMax;
}

void CollisionChecker::publishPermission() {
  published_ = verdict_->level;
  const ros::Time now = ros::Time::now();
  tccm_monitor::MotionPermission& permission = permission_;
  permission.header.frame_id = config_.fixed_frame;
  permission.header.stamp = now;
  permission.sequence = ++permissions_;
  permission.valid_until =
      now + ros::Duration(config_.permission_valid_periods / config_.publish_rate_hz);
  permission.level = static_cast<std::uint8_t>(verdict_->level);
  permission.permitted = !verdict_->stop;
  permission.speed_scale = verdict_->stop ? 0.0 : verdict_->speed_scale;
  permission.reasons.resize(verdict_->reasons.size());
  for (std::size_t i = 0; i < verdict_->reasons.size(); ++i) {
    permission.reasons[i] = name(verdict_->reasons[i]);
  }
  permission.detail = verdict_->detail;
  permission_publisher_.publish(permission);
  publishValue<std_msgs::Bool>(stop_publisher_, verdict_->stop);
  // What is not known is not clear.
  publishValue<std_msgs::Bool>(collision_publisher_, !verdict_->known || verdict_->collision);
  publishValue<std_msgs::Bool>(occlusion_publisher_, !verdict_->known || verdict_->occlusion);
  publishValue<std_msgs::Float64>(scale_publisher_, permission.speed_scale);
}

void CollisionChecker::publish() {
  publishPermission();
  tccm_monitor::MonitorStatus status = statusOf(*verdict_, *checker_);
  status.header.frame_id = config_.fixed_frame;
  if (verdict_->stop && stop_cause_.reason() != Reason::kClear) {
    status.stopped_by = tccm::name(stop_cause_.reason());
    status.stopped_by_detail = stop_cause_.detail();
  }
  status.advice = advice();
  status.scan_to_verdict_s = static_cast<float>(latencies_.scan_to_verdict_s);
  status.transform_wait_s = static_cast<float>(latencies_.transform_wait_s);
  status.ready_to_verdict_s = static_cast<float>(latencies_.ready_to_verdict_s);
  status.check_us = static_cast<float>(check_us_);
  status_publisher_.publish(status);
}

std::string CollisionChecker::advice() const {
  const std::string text = advice_.about(name(verdict_->reason), name(verdict_->level));
  return text == "nothing" ? "" : text;
}

void CollisionChecker::publishPictures() {
  if (verdict_ == &fault_) return;
  publishCheckedMap();
  if (marker_publisher_.getNumSubscribers() > 0) {
    marker_publisher_.publish(toMarkers(*verdict_, stop_cause_, *checker_, config_.fixed_frame));
  }
  if (image_publisher_.getNumSubscribers() > 0 && verdict_->placed) {
    sensor_msgs::Image image = toImage(checker_->checkHere().occlusion().picture());
    image.header.stamp = toRos(verdict_->stamp);
    image.header.frame_id = config_.fixed_frame;
    image_publisher_.publish(image);
  }
}

void CollisionChecker::publishCheckedMap() {
  if (checked_map_publisher_.getNumSubscribers() == 0 || !verdict_->placed) return;
  // Of another map the cuboids are numbered otherwise.
  if (!checker_->map() || checker_->map()->serial != verdict_->serial) return;
  tccm_monitor::CuboidMap map;
  toMessage(*checker_->map(), config_.fixed_frame, map);
  const PublishedMap::ConstPtr& first = feeds_.front().published();
  map.attached_stamp = first ? first->attached_stamp : ros::Time();
  for (const auto& [cuboid, col] : flaggedBy(*verdict_)) {
    std::uint8_t& known = map.cuboids[cuboid].col;
    if (known != tccm_monitor::Cuboid::COLLISION) known = col;  // of both, the graver
  }
  if (verdict_->first_contact && !verdict_->first_contact->by_margin) {
    map.cuboids[verdict_->first_contact->contact.cuboid].col = tccm_monitor::Cuboid::COLLISION;
  }
  checked_map_publisher_.publish(map);
}

void CollisionChecker::publishOccupied() {
  if (occupied_publisher_.getNumSubscribers() == 0 || !checker_->map()) return;
  toPoints(*checker_->map(), config_.fixed_frame, occupied_);
  occupied_publisher_.publish(occupied_);
}

void CollisionChecker::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  const std::uint8_t levels[] = {DiagnosticStatus::OK, DiagnosticStatus::WARN,
                                 DiagnosticStatus::WARN, DiagnosticStatus::ERROR};
  status.summary(levels[static_cast<std::size_t>(verdict_->level)],
                 std::string(tccm::name(verdict_->reason)) + " " + verdict_->detail);
  if (const std::string text = advice(); !text.empty()) status.add("to do", text);
  status.add("speed scale", verdict_->speed_scale);
  status.add("checks", checks_);
  status.add("check [us]", check_us_);
  status.add("check, longest [us]", check_us_max_);
  status.add("poses on the way ahead", verdict_->way_poses);
  if (verdict_->placed) diagnoseEvidence(status);
  status.add("scan to verdict [s]", latencies_.scan_to_verdict_s);
  status.add("of that, waiting for transforms [s]", latencies_.transform_wait_s);
  status.add("scan and transforms to permission [s]", latencies_.ready_to_verdict_s);
  status.add("the same, longest lately [s]", latencies_.longest_s);
  if (const CuboidMap* map = checker_->map()) {
    status.add("map age [s]", toSeconds(verdict_->stamp - map->stamp));
    status.add("map covers [s]", toSeconds(map->window));
    status.add("map holds a whole sweep", map->complete ? "yes" : "no");
    status.add("cuboids", map->cuboids.size());
    status.add("of them held", heldIn(*map));
  }
  status.add("joint states dropped: stamped in the future", checker_->inputs().futureJoints());
  const std::string& limit = checker_->inputs().jointStates().limitDefect();
  if (!limit.empty()) status.add("first joint beyond its limit", limit);
  for (const SensorFeed& feed : feeds_) feed.diagnose(status);
  for (std::size_t i = 0; i < feeds_.size(); ++i) {
    const std::string& out = checker_->inputs().outText(i);
    if (!out.empty()) status.add("sensor that failed, not required", out);
  }
  status.add("exemptions", checker_->exemptions().size());
  status.add("keep-out regions", checker_->keepOut().size());
  for (const Exemption& exemption : checker_->exemptions()) {
    const std::string why_not = checker_->whyNotInForce(exemption);
    if (!why_not.empty()) status.add("exemption of " + exemption.owner + ", not in force", why_not);
  }
  if (!transforms_->defect().empty()) status.add("tf", transforms_->defect());
  diagnoseAgreement(status);
  if (recorder_) diagnoseStops(status);
}

void CollisionChecker::diagnoseEvidence(diagnostic_updater::DiagnosticStatusWrapper& status) const {
  status.add("unseen share of the way ahead", verdict_->unseen_fraction);
  const std::vector<LinkEvidence>& links = checker_->evidence().findings().links;
  const auto oldest = std::max_element(
      links.begin(), links.end(),
      [](const auto& a, const auto& b) { return a.age_s.value_or(-1.0) < b.age_s.value_or(-1.0); });
  if (oldest == links.end() || !oldest->age_s) {
    status.add("oldest evidence [s]", "nothing was seen of the ways");
  } else {
    status.add("oldest evidence [s]", *oldest->age_s);
    status.add("oldest evidence, of", checker_->model()->links()[oldest->link]);
  }
}

}  // namespace tccm

PLUGINLIB_EXPORT_CLASS(tccm::CollisionChecker, nodelet::Nodelet)
