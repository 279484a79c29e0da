#pragma once

#include <ros/ros.h>
#include <std_srvs/Trigger.h>
#include <tccm_monitor/AddExemption.h>
#include <tccm_monitor/CheckState.h>
#include <tccm_monitor/CheckTrajectory.h>

#include <functional>

#include "check/checker_config.h"

namespace tccm {

/// Answers what arm controllers and operators ask the checker: `check_state`, `check_trajectory`,
/// `add_exemption`, `reset`. An error is never answered with free.
class CheckerServices {
 public:
  /// @param prepare called before each question is answered.
  CheckerServices(ros::NodeHandle node, Checker& checker, std::function<void()> prepare);

 private:
  /// @param ask (Time now) -> Cause; what is asked only where time has begun.
  template <typename Response, typename Ask>
  bool respond(Response& response, Ask&& ask);
  bool checkState(tccm_monitor::CheckState::Request& request,
                  tccm_monitor::CheckState::Response& response);
  bool checkTrajectory(tccm_monitor::CheckTrajectory::Request& request,
                       tccm_monitor::CheckTrajectory::Response& response);
  bool addExemption(tccm_monitor::AddExemption::Request& request,
                    tccm_monitor::AddExemption::Response& response);
  bool reset(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);

  Checker& checker_;
  std::function<void()> prepare_;
  ros::ServiceServer state_, trajectory_, exemption_, reset_;
};

}  // namespace tccm
