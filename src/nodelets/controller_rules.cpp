#include "nodelets/controller_rules.h"

#include <cmath>
#include <set>
#include <string>

#include "base/line_of.h"
#include "ros/controller_parameters.h"
#include "ros/server_config.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr char kStopDuration[] = "stop_trajectory_duration";

}  // namespace

GoalRules::Config rulesOf(const ros::NodeHandle& node, const GateConfig::Controller& controller,
                          const RobotModel& model) {
  YAML::Node parameters = parametersOf(ros::NodeHandle(node, controller.downstream));
  const bool tells_joints = parameters.IsMap() && parameters["joints"];
  const bool tells_stop = tells_joints || (parameters.IsMap() && parameters[kStopDuration]);
  if (!tells_joints && !controller.joints.empty()) parameters["joints"] = controller.joints;
  const auto found = ControllerParameters::from(parameters, controller.downstream, model);
  const std::set<std::string> its(found.rules.joints.begin(), found.rules.joints.end());
  const std::set<std::string> told(controller.joints.begin(), controller.joints.end());
  if (!told.empty() && its != told) {
    throw ConfigError(
        lineOf("controllers: %.100s: joints are others than %.100s/joints: leave them "
               "out, or name the same",
               controller.name.c_str(), controller.downstream.c_str()));
  }
  if (tells_stop && std::abs(found.stop_duration_s - controller.stop_duration_s) > 1e-6) {
    throw ConfigError(lineOf(
        "controllers: %.100s: stop_duration_s is %.3g, and %s of %.100s is %.3g: set the one "
        "to the other",
        controller.name.c_str(), controller.stop_duration_s, kStopDuration,
        controller.downstream.c_str(), found.stop_duration_s));
  }
  return found.rules;
}

}  // namespace tccm
