#pragma once

#include <ros/ros.h>
#include <tccm_monitor/AttachObject.h>
#include <tccm_monitor/AttachedObjects.h>
#include <tccm_monitor/DetachObject.h>

#include <set>
#include <string>

#include "tccm_monitor/check/checker.h"
#include "tccm_monitor/ros/settings.h"

namespace tccm {

/// What the robot holds, for all nodelets: answers `attach_object` and `detach_object`, and
/// publishes `attached_objects`, latched. The checker counts an object to the body once the map has
/// let go of what was seen of it; were it earlier, the object would touch its own old cuboids.
class Attachments {
 public:
  Attachments(ros::NodeHandle node, const CheckerSettings& settings, Checker& checker);

  /// A map came in that takes the list with that stamp into account.
  void mapTook(const ros::Time& stamp);
  /// Now and then: what no map takes into account for too long is checked all the same.
  void hurry();
  /// What was held then need not be held now: the hand is taken for empty.
  void timeJumpedBack();
  /// Whether something is held that the checker does not count to the body yet.
  [[nodiscard]] bool pending() const { return !pending_.empty(); }

 private:
  bool attach(tccm_monitor::AttachObject::Request& request,
              tccm_monitor::AttachObject::Response& response);
  bool detach(tccm_monitor::DetachObject::Request& request,
              tccm_monitor::DetachObject::Response& response);
  void publish();
  void settle();

  const CheckerSettings& settings_;
  Checker& checker_;
  tccm_monitor::AttachedObjects list_;
  std::set<std::string> pending_;  ///< names that the checker does not count as in the list yet
  ros::WallTime pending_since_;
  ros::Publisher publisher_;
  ros::ServiceServer attach_service_, detach_service_;
};

}  // namespace tccm
