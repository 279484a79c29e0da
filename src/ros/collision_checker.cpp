#include "tccm_monitor/ros/collision_checker.h"

#include <sensor_msgs/Image.h>
#include <std_msgs/Bool.h>
#include <visualization_msgs/MarkerArray.h>

#include <algorithm>
#include <pluginlib/class_list_macros.hpp>

#include "tccm_monitor/config_error.h"
#include "tccm_monitor/ros/conversions.h"
#include "tccm_monitor/ros/markers.h"
#include "tccm_monitor/ros/refusal.h"
#include "tccm_monitor/ros/robot_description.h"
#include "tccm_monitor/stopwatch.h"

namespace tccm {
namespace {

constexpr double kClockStallMax = 0.5;  // [s] of wall time; recordings' clocks come in bursts

constexpr const char* kNoTimeYet = "simulated time has not begun";

std_msgs::Bool flag(bool value) {
  std_msgs::Bool message;
  message.data = value;
  return message;
}

void write(const Checker::Config& config, tccm_monitor::CollisionCheckerConfig& shown) {
  shown.collision_padding_m = config.pose.collision_use.expansion.padding_m;
  shown.primitive_scale = config.pose.collision_use.expansion.scale;
  shown.horizon_s = config.horizon_s;
  shown.support_points = config.pose.collision.support_points;
  shown.check_occlusion = config.pose.check_occlusion;
  shown.occlusion_hidden_fraction = config.pose.occlusion.hidden_fraction;
  shown.release_s = config.release_s;
}

std::uint8_t resultOf(Reason reason) {
  using Response = tccm_monitor::CheckState::Response;
  switch (reason) {
    case Reason::kClear:
      return Response::FREE;
    case Reason::kCollision:
    case Reason::kCollisionAhead:
      return Response::COLLISION;
    case Reason::kOcclusion:
    case Reason::kOcclusionAhead:
      return Response::OCCLUDED;
    case Reason::kInit:
    case Reason::kReleasing:
    case Reason::kBadQuestion:
      return Response::UNKNOWN;
    default:
      return Response::FAULT;
  }
}

}  // namespace

void CollisionChecker::onInit() {
  startOrRefuse(getName(), [this] { setUp(); });
}

void CollisionChecker::setUp() {
  ros::NodeHandle& node = getNodeHandle();
  settings_ = readFromServer(getPrivateNodeHandle(), readCheckerSettings);
  checker_ = std::make_unique<Checker>(sharedRobotModel(node), settings_.checker);
  attachments_ = std::make_unique<Attachments>(node, settings_, *checker_);
  for (auto& map : maps_) map = std::make_shared<CuboidMap>();
  stop_publisher_ = node.advertise<std_msgs::Bool>("stop", 10);
  collision_publisher_ = node.advertise<std_msgs::Bool>("collision", 10);
  occlusion_publisher_ = node.advertise<std_msgs::Bool>("occlusion", 10);
  status_publisher_ = node.advertise<tccm_monitor::MonitorStatus>("monitor_status", 10);
  marker_publisher_ = node.advertise<visualization_msgs::MarkerArray>("robot_markers", 2);
  image_publisher_ = node.advertise<sensor_msgs::Image>("occlusion_image", 2);
  transforms_ = std::make_unique<TransformListener>(
      node, fromSeconds(settings_.checker.transform_timeout_s), [this] { receiveTransforms(); });
  const auto hints = ros::TransportHints().tcpNoDelay();
  map_subscriber_ = node.subscribe("cuboid_map", 10, &CollisionChecker::receiveMap, this, hints);
  joints_subscriber_ =
      node.subscribe("joint_states", 200, &CollisionChecker::receiveJoints, this, hints);
  state_service_ = node.advertiseService("check_state", &CollisionChecker::checkState, this);
  setUpReconfiguration();
  publish_timer_ = node.createWallTimer(ros::WallDuration(1.0 / settings_.publish_rate_hz),
                                        [this](const ros::WallTimerEvent&) {
                                          checker_->setClockStalls(clockStalls());
                                          attachments_->hurry();
                                          check();
                                          publish();
                                        });
  picture_timer_ = node.createWallTimer(ros::WallDuration(1.0 / settings_.marker_rate_hz),
                                        [this](const ros::WallTimerEvent&) { publishPictures(); });
  diagnostics_ =
      std::make_unique<diagnostic_updater::Updater>(node, getPrivateNodeHandle(), getName());
  diagnostics_->setHardwareID("none");
  diagnostics_->add("verdict", this, &CollisionChecker::diagnose);
  diagnostics_timer_ = node.createWallTimer(
      ros::WallDuration(0.5), [this](const ros::WallTimerEvent&) { diagnostics_->update(); });
}

void CollisionChecker::receiveMap(const tccm_monitor::CuboidMap::ConstPtr& message) {
  newest_map_ = 1 - newest_map_;
  map_defect_ = fromMessage(*message, *maps_[newest_map_]);
  if (map_defect_.empty() &&
      withoutSlash(message->header.frame_id) != withoutSlash(settings_.fixed_frame)) {
    map_defect_ = "its frame is '" + message->header.frame_id + "', fixed_frame is '" +
                  settings_.fixed_frame + "'";
  }
  if (!map_defect_.empty()) {
    newest_map_ = 1 - newest_map_;
    NODELET_ERROR_THROTTLE(5.0, "A cuboid_map was dropped: %s.", map_defect_.c_str());
    return;
  }
  checker_->setMap(toTime(ros::Time::now()), maps_[newest_map_]);
  attachments_->mapCame(message->attached_stamp,
                        toRos(toTime(message->header.stamp) - Duration(message->window.toNSec())));
  check();
}

void CollisionChecker::receiveJoints(const sensor_msgs::JointState::ConstPtr& message) {
  checker_->addJoints(toTime(message->header.stamp), message->name, message->position,
                      message->velocity);
  check();
}

void CollisionChecker::receiveTransforms() {
  if (!checker_ || !transforms_) return;
  const RobotModel& model = checker_->model();
  for (std::size_t i = 0; i < model.roots().size(); ++i) {
    const auto root = transforms_->history().newest(withoutSlash(settings_.fixed_frame),
                                                    model.links()[model.roots()[i]]);
    if (root) checker_->setRootPose(i, root->stamp, root->pose, root->is_static);
  }
}

void CollisionChecker::check() {
  const ros::Time now = ros::Time::now();
  if (now + ros::Duration(settings_.checker.future_max_s) < checked_) {
    attachments_->timeJumpedBack();
  }
  checked_ = now;
  if (now.isZero()) {  // simulated time has not begun, or begins anew
    checker_->reset();
    verdict_ = nullptr;
    return;
  }
  // Where fixed frame and a root are one, no transform has to be heard.
  const RobotModel& model = checker_->model();
  for (std::size_t i = 0; i < model.roots().size(); ++i) {
    if (model.links()[model.roots()[i]] != withoutSlash(settings_.fixed_frame)) continue;
    checker_->setRootPose(i, Time(), Pose::Identity(), true);
  }
  Stopwatch stopwatch;
  verdict_ = &checker_->check(toTime(now));
  check_us_ = stopwatch.lapMicroseconds();
  check_us_max_ = std::max(check_us_max_, check_us_);
  ++checks_;
  if (checker_->map() && verdict_->serial != seen_serial_) {
    seen_serial_ = verdict_->serial;
    scan_to_verdict_s_ = toSeconds(verdict_->stamp - checker_->map()->stamp);
  }
  tellChange(*verdict_);
  if (verdict_->level > published_) publish();
}

void CollisionChecker::tellChange(const Verdict& verdict) {
  if (told_anything_ && verdict.reason == told_) return;
  told_anything_ = true;
  told_ = verdict.reason;
  if (verdict.level == Level::kOk) {
    NODELET_INFO("OK: the robot may move.");
  } else {
    NODELET_WARN("STOP %s: %s.", tccm::name(verdict.reason), verdict.detail.c_str());
  }
}

bool CollisionChecker::clockStalls() {
  const ros::Time now = ros::Time::now();
  const ros::WallTime wall = ros::WallTime::now();
  if (now != clock_ || clock_moved_.isZero()) clock_moved_ = wall;
  clock_ = now;
  return ros::Time::isSimTime() && !now.isZero() && (wall - clock_moved_).toSec() > kClockStallMax;
}

void CollisionChecker::publish() {
  const char* unknown = attachments_->unknown();
  const bool known = verdict_ && verdict_->known && !unknown;
  const bool stop = !verdict_ || verdict_->stop || unknown;
  published_ = verdict_ ? verdict_->level : Level::kFault;
  if (unknown) published_ = std::max(published_, Level::kStop);
  stop_publisher_.publish(flag(stop));
  // What is not known is not clear.
  collision_publisher_.publish(flag(!known || verdict_->collision));
  occlusion_publisher_.publish(flag(!known || verdict_->occlusion));
  tccm_monitor::MonitorStatus status;
  if (verdict_) {
    toMessage(*verdict_, *checker_, status);
  } else {
    status.level = tccm_monitor::MonitorStatus::STOP;
    status.stop = true;
    status.reason = tccm::name(Reason::kInit);
    status.detail = kNoTimeYet;
  }
  if (unknown && status.level == tccm_monitor::MonitorStatus::OK) {
    status.level = tccm_monitor::MonitorStatus::STOP;
    status.reason = tccm::name(Reason::kInit);
    status.detail = unknown;
  }
  status.stop = stop;
  status.known = known;
  status.header.frame_id = withoutSlash(settings_.fixed_frame);
  status.scan_to_verdict_s = static_cast<float>(scan_to_verdict_s_);
  status.check_us = static_cast<float>(check_us_);
  status_publisher_.publish(status);
}

void CollisionChecker::publishPictures() {
  if (!verdict_) return;
  if (marker_publisher_.getNumSubscribers() > 0) {
    visualization_msgs::MarkerArray markers;
    toMarkers(*verdict_, *checker_, withoutSlash(settings_.fixed_frame), markers);
    marker_publisher_.publish(markers);
  }
  if (image_publisher_.getNumSubscribers() > 0 && verdict_->placed) {
    sensor_msgs::Image image;
    toImage(checker_->poseCheckNow().occlusion().picture(), image);
    image.header.stamp = toRos(verdict_->stamp);
    image.header.frame_id = withoutSlash(settings_.fixed_frame);
    image_publisher_.publish(image);
  }
}

bool CollisionChecker::checkState(tccm_monitor::CheckState::Request& request,
                                  tccm_monitor::CheckState::Response& response) {
  if (ros::Time::now().isZero()) {
    response.result = tccm_monitor::CheckState::Response::UNKNOWN;
    response.reason = tccm::name(Reason::kInit);
    response.detail = kNoTimeYet;
    return true;
  }
  if (const char* unknown = attachments_->unknown()) {
    response.result = tccm_monitor::CheckState::Response::UNKNOWN;
    response.reason = tccm::name(Reason::kInit);
    response.detail = unknown;
    return true;
  }
  const Time now = toTime(ros::Time::now());
  const Checker::StateAnswer answer =
      checker_->checkState(now, request.state.name, request.state.position);
  response.result = resultOf(answer.reason);
  response.reason = answer.reason == Reason::kClear ? "FREE" : tccm::name(answer.reason);
  response.detail = answer.detail;
  response.link = answer.link;
  if (const CuboidMap* map = checker_->map()) {
    response.map_stamp = toRos(map->stamp);
    response.map_age = toRos(now - map->stamp);
  }
  return true;
}

void CollisionChecker::setUpReconfiguration() {
  reconfiguration_ = std::make_unique<dynamic_reconfigure::Server<Reconfiguration>>(
      reconfiguration_mutex_, getPrivateNodeHandle());
  Reconfiguration current;
  reconfiguration_->getConfigDefault(current);
  write(settings_.checker, current);
  reconfiguration_->updateConfig(current);
  reconfiguration_->setCallback(
      [this](Reconfiguration& wanted, std::uint32_t level) { reconfigure(wanted, level); });
}

void CollisionChecker::reconfigure(Reconfiguration& wanted, std::uint32_t /*level*/) {
  Checker::Config config = checker_->config();
  config.pose.collision_use.expansion.padding_m = wanted.collision_padding_m;
  config.pose.collision_use.expansion.scale = wanted.primitive_scale;
  config.horizon_s = wanted.horizon_s;
  config.pose.collision.support_points = wanted.support_points;
  config.pose.check_occlusion = wanted.check_occlusion;
  config.pose.occlusion.hidden_fraction = wanted.occlusion_hidden_fraction;
  config.release_s = wanted.release_s;
  try {
    checker_->reconfigure(config);
  } catch (const ConfigError& error) {
    NODELET_ERROR("Refused: %s", error.what());
    write(checker_->config(), wanted);  // what is shown is what is in force
  }
}

void CollisionChecker::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  if (!verdict_) {
    status.summary(DiagnosticStatus::ERROR, kNoTimeYet);
    return;
  }
  const Level level = verdict_->level;
  status.summary(level == Level::kOk     ? DiagnosticStatus::OK
                 : level == Level::kStop ? DiagnosticStatus::WARN
                                         : DiagnosticStatus::ERROR,
                 std::string(tccm::name(verdict_->reason)) + " " + verdict_->detail);
  status.add("checks", checks_);
  status.add("check [us]", check_us_);
  status.add("check, longest [us]", check_us_max_);
  status.add("scan to verdict [s]", scan_to_verdict_s_);
  if (const CuboidMap* map = checker_->map()) {
    status.add("map age [s]", toSeconds(verdict_->stamp - map->stamp));
    status.add("cuboids", map->cuboids.size());
  }
  if (!map_defect_.empty()) status.add("last cuboid_map dropped", map_defect_);
}

}  // namespace tccm

PLUGINLIB_EXPORT_CLASS(tccm::CollisionChecker, nodelet::Nodelet)
