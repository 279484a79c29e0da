#pragma once

#include <dynamic_reconfigure/server.h>
#include <ros/ros.h>
#include <tccm_monitor/CollisionCheckerConfig.h>

#include <boost/thread/recursive_mutex.hpp>
#include <memory>
#include <string>

#include "ros/settings.h"

namespace tccm {

/// Lets tuning values be changed while the checker runs (dynamic_reconfigure). A set of values that
/// is not allowed together, or not while a robot may move, is refused as a whole.
class Tuning {
 public:
  using Values = tccm_monitor::CollisionCheckerConfig;

  /// @param name for the log.
  Tuning(ros::NodeHandle private_node, const std::string& name, CheckerSettings& settings,
         Checker& checker);

 private:
  void change(Values& wanted);

  std::string name_;
  CheckerSettings& settings_;
  Checker& checker_;
  boost::recursive_mutex mutex_;  ///< the server wants one to be shared with it
  std::unique_ptr<dynamic_reconfigure::Server<Values>> server_;
};

}  // namespace tccm
