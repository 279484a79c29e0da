#include "ros/controller_parameters.h"

#include <algorithm>
#include <set>

#include "base/line_of.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr double kStopMax = 60.0;      // [s]
constexpr double kToleranceMax = 1e3;  // rad, m, s

/// What stands below a key; null where nothing does. @param path of the parent, for errors.
YAML::Node below(const YAML::Node& parent, const std::string& key, const std::string& path) {
  if (parent.IsNull()) return {};
  if (!parent.IsMap()) throw ConfigError(path + ": it is no map");
  const YAML::Node found = parent[key];
  return found ? found : YAML::Node();
}

template <typename Value>
Value valueOr(const YAML::Node& parent, const std::string& key, const std::string& path,
              Value value) {
  const YAML::Node found = below(parent, key, path);
  if (found.IsNull()) return value;
  try {
    return found.as<Value>();
  } catch (const YAML::Exception&) {
    throw ConfigError(path + "/" + key + ": it is of another type");
  }
}

double toleranceOr(const YAML::Node& parent, const std::string& key, const std::string& path,
                   double value) {
  const double found = valueOr(parent, key, path, value);
  requireInRange(path + "/" + key, found, 0.0, kToleranceMax);
  return found;
}

std::vector<bool> turnFreely(const std::vector<std::string>& joints, const std::string& path,
                             const RobotModel& model) {
  std::vector<bool> turn;
  const std::vector<JointVariable>& variables = model.variables();
  for (const std::string& joint : joints) {
    const auto found =
        std::find_if(variables.begin(), variables.end(),
                     [&joint](const JointVariable& known) { return known.name == joint; });
    if (found == variables.end()) {
      throw ConfigError(
          lineOf("%s: '%.100s' is no joint of the robot", path.c_str(), joint.c_str()));
    }
    turn.push_back(model.turnsFreely(static_cast<std::size_t>(found - variables.begin())));
  }
  return turn;
}

}  // namespace

ControllerParameters ControllerParameters::from(const YAML::Node& parameters,
                                                const std::string& name, const RobotModel& model) {
  ControllerParameters result;
  GoalRules::Config& rules = result.rules;
  rules.joints = valueOr(parameters, "joints", name, std::vector<std::string>());
  const std::set<std::string> different(rules.joints.begin(), rules.joints.end());
  if (rules.joints.empty() || different.size() != rules.joints.size()) {
    throw ConfigError(name + "/joints: a controller's joints have to be named, each once");
  }
  rules.turn_freely = turnFreely(rules.joints, name + "/joints", model);
  rules.allow_partial_joints_goal =
      valueOr(parameters, "allow_partial_joints_goal", name, rules.allow_partial_joints_goal);
  result.stop_duration_s = valueOr(parameters, "stop_trajectory_duration", name, 0.0);
  requireInRange(name + "/stop_trajectory_duration", result.stop_duration_s, 0.0, kStopMax);

  const std::string path = name + "/constraints";
  const YAML::Node constraints = below(parameters, "constraints", name);
  const double stopped = toleranceOr(constraints, "stopped_velocity_tolerance", path, 0.01);
  for (const std::string& joint : rules.joints) {
    const YAML::Node its = below(constraints, joint, path);
    const std::string its_path = lineOf("%s/%.100s", path.c_str(), joint.c_str());
    rules.tolerances.path.push_back({toleranceOr(its, "trajectory", its_path, 0.0), 0.0, 0.0});
    rules.tolerances.end.push_back({toleranceOr(its, "goal", its_path, 0.0), stopped, 0.0});
  }
  rules.tolerances.end_time_s = toleranceOr(constraints, "goal_time", path, 0.0);
  return result;
}

}  // namespace tccm
