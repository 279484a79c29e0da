#pragma once

#include <dynamic_reconfigure/Config.h>
#include <dynamic_reconfigure/Reconfigure.h>
#include <ros/ros.h>

#include <string>

#include "monitor_config.h"

namespace tccm {

/// Lets tunable parameters be changed while the checker runs, as dynamic_reconfigure's clients do:
/// what there is to tune is in the parameters' table. A set of values that is not allowed together,
/// or not while a robot may move, is refused as a whole.
class Tuning {
 public:
  /// @param name for the log.
  Tuning(ros::NodeHandle private_node, const std::string& name, CheckerConfig& config,
         Checker& checker);

 private:
  bool change(dynamic_reconfigure::Reconfigure::Request& request,
              dynamic_reconfigure::Reconfigure::Response& response);
  /// What is in force; also on the parameter server.
  void publish();

  ros::NodeHandle private_node_;
  std::string name_;
  CheckerConfig& config_;
  Checker& checker_;
  ros::Publisher descriptions_, updates_;
  ros::ServiceServer service_;
};

/// The tunable values of a configuration, as dynamic_reconfigure's messages have them.
[[nodiscard]] dynamic_reconfigure::Config toMessage(CheckerConfig config);
/// The configuration with what the message sets of it; numbers are brought within their ranges.
[[nodiscard]] CheckerConfig tuned(CheckerConfig config, const dynamic_reconfigure::Config& message);
/// A slip of a slider must not take away what keeps a moving robot safe: no less than a floor,
/// unless it was configured lower. @throws ConfigError naming the key.
void refuseUnsafe(const CheckerConfig& now, const CheckerConfig& wanted);

}  // namespace tccm
