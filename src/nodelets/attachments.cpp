#include "nodelets/attachments.h"

#include <tf2_eigen/tf2_eigen.h>

#include <algorithm>

#include "ros/conversions.h"
#include "ros/transform_history.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr double kMapWaitMax = 0.5;  // [s] of wall time

/// By name.
std::vector<tccm_monitor::AttachedObject>::iterator find(tccm_monitor::AttachedObjects& list,
                                                         const std::string& name) {
  return std::find_if(list.objects.begin(), list.objects.end(),
                      [&name](const auto& object) { return object.name == name; });
}

/// Now, but never that of the last list: simulated time may stand still between two calls.
ros::Time stampAfter(const ros::Time& last) {
  const ros::Time now = ros::Time::now();
  const bool jumped_back = now + ros::Duration(1.0) < last;
  return now > last || jumped_back ? now : last + ros::Duration(0, 1);
}

}  // namespace

Attachments::Attachments(ros::NodeHandle node, const CheckerConfig& config, Checker& checker)
    : config_(config), checker_(checker) {
  publisher_ = node.advertise<tccm_monitor::AttachedObjects>("attached_objects", 1, true);
  attach_service_ = node.advertiseService("attach_object", &Attachments::attach, this);
  detach_service_ = node.advertiseService("detach_object", &Attachments::detach, this);
  publish();  // an empty hand: what was held before this node started is not known any more
}

bool Attachments::attach(tccm_monitor::AttachObject::Request& request,
                         tccm_monitor::AttachObject::Response& response) {
  tccm_monitor::AttachedObject message;
  message.name = request.name;
  message.link = request.link;
  message.primitive = request.primitive;
  try {
    const AttachedObject object = fromMessage(message);
    static_cast<void>(checker_.model()->holding({object}));
    const ros::Time now = ros::Time::now();
    if (now.isZero()) throw ConfigError("simulated time has not begun");
    message.attached_at = tf2::toMsg(checker_.placeOf(toTime(now), object).pose);
    message.forget_padding = config_.attach_forget_padding_m;
    message.forget_until = now + ros::Duration(config_.attach_forget_s);
  } catch (const ConfigError& error) {
    response.message = error.what();
    return true;
  }
  const auto known = find(list_, request.name);
  if (known != list_.objects.end() && known->link == request.link &&
      known->primitive == request.primitive) {
    response.success = true;  // what lies around it now is not to be forgotten once more
    return true;
  }
  if (known == list_.objects.end()) {
    list_.objects.push_back(message);
  } else {
    *known = message;  // until a map has taken the new one the old one is checked
  }
  if (pending_.empty()) pending_since_ = ros::WallTime::now();
  pending_.insert(request.name);
  publish();
  response.success = true;
  return true;
}

bool Attachments::detach(tccm_monitor::DetachObject::Request& request,
                         tccm_monitor::DetachObject::Response& response) {
  if (!request.name.empty() && find(list_, request.name) == list_.objects.end()) {
    response.message = "no object '" + request.name + "' is attached";
    return true;
  }
  const auto leaves = [&request](const auto& object) {
    return request.name.empty() || object.name == request.name;
  };
  const std::size_t held = list_.objects.size();
  for (const auto& object : list_.objects) {
    if (!leaves(object)) continue;
    checker_.detach(object.name);
    pending_.erase(object.name);
  }
  list_.objects.erase(std::remove_if(list_.objects.begin(), list_.objects.end(), leaves),
                      list_.objects.end());
  if (list_.objects.size() < held) let_go_ = ros::Time::now();
  publish();
  response.success = true;
  return true;
}

void Attachments::timeJumpedBack() {
  let_go_ = ros::Time();  // the map starts anew as well
  if (list_.objects.empty()) return;
  ROS_WARN("Time jumped back: no object counts as attached any more.");
  for (const auto& object : list_.objects) checker_.detach(object.name);
  list_.objects.clear();
  pending_.clear();
  publish();
}

void Attachments::publish() {
  list_.header.frame_id = withoutSlash(config_.fixed_frame);
  list_.header.stamp = stampAfter(list_.header.stamp);
  publisher_.publish(list_);
}

void Attachments::mapCame(const ros::Time& took, const ros::Time& since) {
  if (!pending_.empty() && took == list_.header.stamp) settle();
  if (since >= let_go_) let_go_ = ros::Time();
}

const char* Attachments::unknown() const {
  if (!pending_.empty()) return "no map has taken what was attached into account yet";
  return let_go_.isZero() ? nullptr : "where what was let go of stands has not been looked at yet";
}

void Attachments::hurry() {
  if (pending_.empty() || (ros::WallTime::now() - pending_since_).toSec() < kMapWaitMax) return;
  ROS_WARN(
      "No cuboid_map took the attached objects into account: they may touch what was seen of "
      "them.");
  settle();
}

void Attachments::settle() {
  for (const auto& object : list_.objects) {
    if (pending_.count(object.name) > 0) checker_.attach(fromMessage(object));
  }
  pending_.clear();
}

}  // namespace tccm
