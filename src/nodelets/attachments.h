#pragma once

#include <ros/ros.h>
#include <tccm_monitor/AttachObject.h>
#include <tccm_monitor/AttachedObjects.h>
#include <tccm_monitor/DetachObject.h>

#include <set>
#include <string>

#include "check/checker_config.h"
#include "monitor_config.h"

namespace tccm {

/// What the robot holds, for all nodelets: answers `attach_object` and `detach_object`, and
/// publishes `attached_objects`, latched. The checker counts an object to the body once the map has
/// let go of what was seen of it; were it earlier, the object would touch its own old cuboids.
class Attachments {
 public:
  Attachments(ros::NodeHandle node, const CheckerConfig& config, Checker& checker);

  /// A map came in. @param took stamp of the list that it takes into account.
  /// @param since the oldest scan in it.
  void mapCame(const ros::Time& took, const ros::Time& since);
  /// Now and then: what no map takes into account for too long is checked all the same.
  void hurry();
  /// What was held then need not be held now: the hand is taken for empty.
  void timeJumpedBack();
  /// What is not known because of what was attached or let go of lately, in one line: the checker
  /// does not count it to the body yet, or not a whole window has looked at where it may stand now.
  /// Null where nothing is.
  [[nodiscard]] const char* unknown() const;

 private:
  bool attach(tccm_monitor::AttachObject::Request& request,
              tccm_monitor::AttachObject::Response& response);
  bool detach(tccm_monitor::DetachObject::Request& request,
              tccm_monitor::DetachObject::Response& response);
  void publish();
  void settle();

  const CheckerConfig& config_;
  Checker& checker_;
  tccm_monitor::AttachedObjects list_;
  std::set<std::string> pending_;  ///< names that the checker does not count as in the list yet
  ros::WallTime pending_since_;
  ros::Time let_go_;  ///< when something was last let go of; zero once a window has passed since
  ros::Publisher publisher_;
  ros::ServiceServer attach_service_, detach_service_;
};

}  // namespace tccm
