#include "gate/gate_config.h"

#include <algorithm>
#include <set>

#include "tccm_monitor/config_error.h"

namespace tccm {

namespace {

/// @throws ConfigError
void requireOneOf(const std::string& name, const std::string& key, const std::string& value,
                  const std::vector<std::string>& allowed) {
  if (std::find(allowed.begin(), allowed.end(), value) != allowed.end()) return;
  std::string all;
  for (const std::string& one : allowed) all += (all.empty() ? "'" : ", '") + one + "'";
  throw ConfigError("controllers: " + name + ": " + key + " is '" + value + "', it may be one of " +
                    all);
}

}  // namespace

GatedMotion::Pace GateConfig::Controller::pace() const {
  if (!forwards()) return GatedMotion::Pace::kSetpoints;
  return slider.empty() ? GatedMotion::Pace::kPlans : GatedMotion::Pace::kMeasured;
}

void GateConfig::Controller::describe(ParameterTable& table) {
  table.add("name", &name,
            "of the action that clients send goals to: NAME/follow_joint_trajectory");
  table.add("downstream", &downstream, "namespace of the arm's own controller");
  table.add("joints", &joints,
            "in its order, for one that does not read `joints` from its namespace");
  table.add(
      "mode", &mode,
      "`stream`: setpoints go to the controller's topic `command`; `forward`: goals go to its "
      "own action");
  table.add("stop_duration_s", &stop_duration_s, "s", {0.0, 5.0},
            "how long that takes to halt: its `stop_trajectory_duration`");
  table.add("hold", &hold,
            "where it forwards, what has the arm halt: `cancel`, where that alone does; `goal`: a "
            "goal to stay as well; `command`: an empty message on its topic `command` as well");
  table.add("slider", &slider,
            "where it forwards: topic or service that sets the arm's speed; empty: goals are timed "
            "anew");
  table.add("slider_type", &slider_type,
            "`std_msgs/Float64`, `std_msgs/Float32` or `ur_msgs/SetSpeedSliderFraction`");
}

void GateConfig::Controller::validate() const {
  if (name.empty()) throw ConfigError("controllers: one has no name");
  if (downstream.empty() || downstream == name) {
    throw ConfigError("controllers: " + name + ": downstream has to name another namespace");
  }
  requireOneOf(name, "mode", mode, {"stream", "forward"});
  requireOneOf(name, "hold", hold, {"cancel", "goal", "command"});
  requireOneOf(name, "slider_type", slider_type,
               {"std_msgs/Float64", "std_msgs/Float32", "ur_msgs/SetSpeedSliderFraction"});
  if (!slider.empty() && !forwards()) {
    throw ConfigError("controllers: " + name + ": slider is for the mode 'forward'");
  }
  // Such a controller's time goes slower by the slider, also while it halts.
  if (!slider.empty() && stop_duration_s > 0.0) {
    throw ConfigError(
        "controllers: " + name +
        ": stop_duration_s has to be 0 with a slider: at a tenth of the speed the arm "
        "would take ten times as long to halt; set stop_trajectory_duration of " +
        downstream + " to 0 as well");
  }
}

void GateConfig::describe(ParameterTable& table) {
  table.add("rate_hz", &rate_hz, "Hz", {100.0, 1000.0}, "of the setpoints");
  table.add("joints_age_max_s", &joints_age_max_s, "s", {0.01, 1.0},
            "where a joint's position is older, no goal is taken and a motion ends");
  table.add("start_tolerance", &start_tolerance, "rad or m", {1e-4, 1.0},
            "that a joint may move while its goal is checked");
  table.add("check_timeout_s", &check_timeout_s, "s", {0.1, 60.0},
            "where `check_trajectory` takes longer to answer, the goal is refused");
  table.add("answer_timeout_s", &answer_timeout_s, "s", {0.1, 60.0},
            "where an arm's controller, or its speed slider, takes longer to answer, it is held");
  table.add("moving_out_wait_s", &moving_out_wait_s, "s", {0.05, 5.0},
            "a goal that leads out of a contact is begun once it is permitted, within this");
  table.add("execution_event", &execution_event,
            "topic that gets `stop` when a motion is not permitted any more, such as MoveIt's "
            "`/trajectory_execution_event`; empty: none");
  motion.describe(table);
  table.addList("controllers", controllers,
                "arms' controllers that the gate stands before, as `[{name: right_arm, downstream: "
                "right_arm_controller, mode: stream, stop_duration_s: 0.5}]`; docs/controllers.md "
                "has all keys");
}

double GateConfig::stopDurationMax() const {
  double longest_s = 0.0;
  for (const Controller& controller : controllers) {
    longest_s = std::max(longest_s, controller.stop_duration_s);
  }
  return longest_s;
}

void GateConfig::validate() const {
  std::set<std::string> names, downstreams;
  for (const Controller& controller : controllers) {
    controller.validate();
    if (!names.insert(controller.name).second ||
        !downstreams.insert(controller.downstream).second) {
      throw ConfigError("controllers: " + controller.name + ", or its downstream, is there twice");
    }
  }
}

}  // namespace tccm
