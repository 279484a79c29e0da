#include "simulation/controlled_arm.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/line_of.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

std::vector<std::size_t> variablesOf(const RobotModel& model,
                                     const std::vector<std::string>& joints) {
  std::vector<std::size_t> found;
  const std::vector<JointVariable>& variables = model.variables();
  for (const std::string& joint : joints) {
    const auto variable =
        std::find_if(variables.begin(), variables.end(),
                     [&joint](const JointVariable& known) { return known.name == joint; });
    if (variable == variables.end()) {
      throw ConfigError(lineOf("joints: the robot has no joint '%.100s'", joint.c_str()));
    }
    found.push_back(static_cast<std::size_t>(variable - variables.begin()));
  }
  return found;
}

std::vector<double> chosen(const std::vector<double>& values,
                           const std::vector<std::size_t>& indices) {
  std::vector<double> result;
  result.reserve(indices.size());
  for (const std::size_t index : indices) result.push_back(values[index]);
  return result;
}

}  // namespace

void ControlledArm::Config::validate() const {
  controller.validate();
  requireInRange("joint_lag_s", lag_s, 0.0, 1.0);
}

ControlledArm::ControlledArm(const Config& config, std::shared_ptr<const RobotModel> model,
                             const std::vector<double>& positions, Time now)
    : config_((config.validate(), config)),
      model_(std::move(model)),
      variables_(variablesOf(*model_, config.controller.rules.joints)),
      controller_(config.controller, chosen(positions, variables_), now),
      now_(now),
      clock_(now) {}

void ControlledArm::step(Time now, std::vector<double>& positions,
                         std::vector<double>& velocities) {
  const double elapsed_s = toSeconds(now - now_);
  now_ = now;
  clock_ += fromSeconds(scale_ * elapsed_s);
  controller_.step(clock_, chosen(positions, variables_), chosen(velocities, variables_));
  if (!(elapsed_s > 0.0)) return;
  const double share = config_.lag_s > 0.0 ? 1.0 - std::exp(-elapsed_s / config_.lag_s) : 1.0;
  for (std::size_t j = 0; j < variables_.size(); ++j) {
    const JointSpline::State& desired = controller_.desired()[j];
    double& position = positions[variables_[j]];
    const double way_max = elapsed_s * model_->variables()[variables_[j]].speed_max.value_or(
                                           std::numeric_limits<double>::infinity());
    const double wanted = share * (desired.position - position);
    const double way = std::clamp(wanted, -way_max, way_max);
    const bool is_there = share == 1.0 && way == wanted;
    velocities[variables_[j]] = is_there ? scale_ * desired.velocity : way / elapsed_s;
    position = is_there ? desired.position : position + way;
  }
}

}  // namespace tccm::simulation
