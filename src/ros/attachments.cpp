#include "tccm_monitor/ros/attachments.h"

#include <tf2_eigen/tf2_eigen.h>

#include <algorithm>

#include "tccm_monitor/config_error.h"
#include "tccm_monitor/ros/conversions.h"
#include "tccm_monitor/ros/transform_history.h"

namespace tccm {
namespace {

constexpr double kMapWaitMax = 0.5;  // [s] of wall time

/// By name.
std::vector<tccm_monitor::AttachedObject>::iterator find(tccm_monitor::AttachedObjects& list,
                                                         const std::string& name) {
  return std::find_if(list.objects.begin(), list.objects.end(),
                      [&name](const auto& object) { return object.name == name; });
}

}  // namespace

Attachments::Attachments(ros::NodeHandle node, const CheckerSettings& settings, Checker& checker)
    : settings_(settings), checker_(checker) {
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
    static_cast<void>(checker_.model().holding({object}));
    const ros::Time now = ros::Time::now();
    const auto T_fixed_link =
        now.isZero() ? std::nullopt : checker_.linkPose(toTime(now), object.link);
    if (!T_fixed_link) {
      throw ConfigError("link '" + object.link +
                        "' cannot be placed: joints or transforms are "
                        "missing or too old");
    }
    message.attached_at = tf2::toMsg(Pose(*T_fixed_link * object.primitive.pose));
    message.forget_padding = settings_.attach_forget_padding_m;
    message.forget_until = now + ros::Duration(settings_.attach_forget_s);
  } catch (const ConfigError& error) {
    response.message = error.what();
    return true;
  }
  const auto known = find(list_, request.name);
  if (known == list_.objects.end()) {
    list_.objects.push_back(message);
  } else {
    checker_.detach(request.name);
    *known = message;
  }
  pending_ = true;
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
  for (const auto& object : list_.objects) {
    if (leaves(object)) checker_.detach(object.name);
  }
  list_.objects.erase(std::remove_if(list_.objects.begin(), list_.objects.end(), leaves),
                      list_.objects.end());
  publish();
  response.success = true;
  return true;
}

void Attachments::publish() {
  list_.header.frame_id = withoutSlash(settings_.fixed_frame);
  list_.header.stamp = ros::Time::now();
  publisher_.publish(list_);
  published_ = ros::WallTime::now();
}

void Attachments::mapTook(const ros::Time& stamp) {
  if (pending_ && stamp == list_.header.stamp) settle();
}

void Attachments::hurry() {
  if (!pending_ || (ros::WallTime::now() - published_).toSec() < kMapWaitMax) return;
  ROS_WARN(
      "No cuboid_map took the attached objects into account: they may touch what was seen of "
      "them.");
  settle();
}

void Attachments::settle() {
  for (const auto& object : list_.objects) checker_.attach(fromMessage(object));
  pending_ = false;
}

}  // namespace tccm
