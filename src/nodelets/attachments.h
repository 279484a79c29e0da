#pragma once

#include <ros/ros.h>
#include <tccm_monitor/AttachObject.h>
#include <tccm_monitor/AttachedObjects.h>
#include <tccm_monitor/DetachObject.h>
#include <tf2_eigen/tf2_eigen.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "monitor_config.h"
#include "ros/conversions.h"
#include "ros/handles.h"
#include "ros/transform_history.h"
#include "tccm_monitor/config_error.h"

namespace tccm {

/// What the robot holds, for all nodelets: answers `attach_object` and `detach_object`, and
/// publishes `attached_objects`, latched. The checker counts an object to the body once the map has
/// let go of what was seen of it; were it earlier, the object would touch its own old cuboids.
class Attachments {
 public:
  Attachments(const ros::NodeHandle& node, const CheckerConfig& config, Checker& checker)
      : config_(config), checker_(checker) {
    publisher_ = advertise<tccm_monitor::AttachedObjects>(node, "attached_objects", 1, true);
    attach_service_ = serve(node, "attach_object", &Attachments::attach, this);
    detach_service_ = serve(node, "detach_object", &Attachments::detach, this);
    publish();  // an empty hand: what was held before this node started is not known any more
  }

  /// A map came in. @param took stamp of the list that all sensors' maps take into account.
  /// @param since the oldest scan in any of them.
  void mapCame(const ros::Time& took, const ros::Time& since) {
    if (!pending_.empty() && took == list_.header.stamp) settle();
    if (since >= let_go_) let_go_ = ros::Time();
  }
  /// Now and then: what no map takes into account for too long is checked all the same.
  void hurry() {
    if (pending_.empty() || (ros::WallTime::now() - pending_since_).toSec() < kMapWaitMax) return;
    pending_since_ = ros::WallTime::now();
    ROS_WARN(
        "No cuboid_map took the attached objects into account: they may touch what was seen of "
        "them.");
    settle();
  }
  /// What was held then need not be held now: the hand is taken for empty.
  void timeJumpedBack() {
    let_go_ = ros::Time();  // the map starts anew as well
    if (list_.objects.empty()) return;
    ROS_WARN("Time jumped back: no object counts as attached any more.");
    letGo(list_.objects.begin());
  }
  /// What is not known because of what was attached or let go of lately, in one line: the checker
  /// does not count it to the body yet, or not a whole window has looked at where it may stand now.
  /// Null where nothing is.
  [[nodiscard]] const char* unknown() const {
    if (!pending_.empty()) return "no map has taken what was attached into account yet";
    return let_go_.isZero() ? nullptr
                            : "where what was let go of stands has not been looked at yet";
  }

 private:
  using Objects = std::vector<tccm_monitor::AttachedObject>;
  static constexpr double kMapWaitMax = 0.5;  // [s] of wall time

  bool attach(tccm_monitor::AttachObject::Request& request,
              tccm_monitor::AttachObject::Response& response) {
    tccm_monitor::AttachedObject message;
    message.name = request.name;
    message.link = request.link;
    message.primitive = request.primitive;
    try {
      const AttachedObject object = fromMessage(message);
      static_cast<void>(checker_.model()->holding(with(object)));
      const ros::Time now = ros::Time::now();
      if (now.isZero()) throw ConfigError("simulated time has not begun");
      message.attached_at = tf2::toMsg(checker_.placeOf(toTime(now), object).pose);
      message.forget_padding = config_.attach_forget_padding_m;
      message.forget_until = now + ros::Duration(config_.attach_forget_s);
    } catch (const std::exception& error) {
      response.message = error.what();
      return true;
    }
    const auto known =
        std::find_if(list_.objects.begin(), list_.objects.end(),
                     [&request](const auto& object) { return object.name == request.name; });
    const bool is_new = known == list_.objects.end();
    response.success = true;
    // What lies around the same object now is not to be forgotten once more.
    if (!is_new && known->link == request.link && known->primitive == request.primitive)
      return true;
    if (is_new) list_.objects.push_back(message);
    if (!is_new) *known = message;  // until a map has taken the new one the old one is checked
    pending_since_ = ros::WallTime::now();
    pending_.insert(request.name);
    publish();
    return true;
  }

  /// What would be attached.
  [[nodiscard]] std::vector<tccm::AttachedObject> with(const tccm::AttachedObject& object) const {
    std::vector<tccm::AttachedObject> objects;
    for (const auto& other : list_.objects) {
      if (other.name != object.name) objects.push_back(fromMessage(other));
    }
    objects.push_back(object);
    return objects;
  }

  bool detach(tccm_monitor::DetachObject::Request& request,
              tccm_monitor::DetachObject::Response& response) {
    Objects& objects = list_.objects;
    const auto leaving =
        std::stable_partition(objects.begin(), objects.end(), [&request](const auto& object) {
          return !request.name.empty() && object.name != request.name;
        });
    if (!request.name.empty() && leaving == objects.end()) {
      response.message = "no object '" + request.name + "' is attached";
      return true;
    }
    if (leaving != objects.end()) let_go_ = ros::Time::now();
    letGo(leaving);
    response.success = true;
    return true;
  }

  /// Lets go of the list's objects from this on.
  void letGo(Objects::iterator first) {
    for (auto object = first; object != list_.objects.end(); ++object) {
      checker_.detach(object->name);
      pending_.erase(object->name);
    }
    list_.objects.erase(first, list_.objects.end());
    publish();
  }

  void publish() {
    list_.header.frame_id = withoutSlash(config_.fixed_frame);
    // Never that of the last list: simulated time may stand still between two calls.
    const ros::Time now = ros::Time::now(), last = list_.header.stamp;
    const bool jumped_back = now + ros::Duration(1.0) < last;
    list_.header.stamp = now > last || jumped_back ? now : last + ros::Duration(0, 1);
    publisher_.publish(list_);
  }

  /// What the checker cannot take stays unknown, which stops the robot.
  void settle() {
    for (const auto& object : list_.objects) {
      if (pending_.count(object.name) == 0) continue;
      try {
        checker_.attach(fromMessage(object));
        pending_.erase(object.name);
      } catch (const std::exception& error) {
        ROS_ERROR_THROTTLE(5.0, "%s: the robot stays stopped until it is detached", error.what());
      }
    }
  }

  const CheckerConfig& config_;
  Checker& checker_;
  tccm_monitor::AttachedObjects list_;
  std::set<std::string> pending_;  ///< names that the checker does not count as in the list yet
  ros::WallTime pending_since_;    ///< when the last of them was attached
  ros::Time let_go_;  ///< when something was last let go of; zero once a window has passed since
  ros::Publisher publisher_;
  ros::ServiceServer attach_service_, detach_service_;
};

}  // namespace tccm
