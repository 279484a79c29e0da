#include "simulation/commanded_arms.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

bool isArmJoint(const std::string& joint) {
  return joint.rfind("left_", 0) == 0 || joint.rfind("right_", 0) == 0;
}

std::optional<std::size_t> variableOf(const RobotModel& model, const std::string& joint) {
  for (std::size_t i = 0; i < model.variables().size(); ++i) {
    if (model.variables()[i].name == joint && isArmJoint(joint)) return i;
  }
  return std::nullopt;
}

bool allFinite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

}  // namespace

void CommandedArms::Config::validate() const {
  requireInRange("deceleration_rps2", deceleration_rps2, 0.1, 1000.0);
}

CommandedArms::CommandedArms(const Config& config, std::shared_ptr<const RobotModel> model,
                             std::vector<double> positions, Time now)
    : config_(config),
      model_(std::move(model)),
      positions_(std::move(positions)),
      velocities_(positions_.size(), 0.0),
      has_controller_(positions_.size(), false),
      now_(now) {
  config_.validate();
  addControlled(now);
}

void CommandedArms::addControlled(Time now) {
  for (const ControlledArm::Config& arm : config_.controlled) {
    for (const std::size_t variable :
         controlled_.emplace_back(arm, model_, positions_, now).variables()) {
      const std::string& joint = model_->variables()[variable].name;
      if (!isArmJoint(joint)) throw ConfigError("joints: '" + joint + "' is no joint of the arms");
      if (has_controller_[variable]) {
        throw ConfigError("joints: '" + joint + "' has two controllers");
      }
      has_controller_[variable] = true;
    }
  }
}

std::string CommandedArms::defectOf(const ArmCommand& command) const {
  std::set<std::string> names;
  for (const std::string& joint : command.joints) {
    const std::optional<std::size_t> variable = variableOf(*model_, joint);
    if (!variable) return "'" + joint + "' is no joint of the arms";
    if (has_controller_[*variable]) return "'" + joint + "' has a controller of its own";
    if (!names.insert(joint).second) return "'" + joint + "' is named twice";
  }
  Duration before{-1};
  for (const ArmCommand::Point& point : command.points) {
    if (point.positions.size() != names.size() ||
        !(point.velocities.empty() || point.velocities.size() == names.size())) {
      return "a point has not as many values as there are joints";
    }
    if (!allFinite(point.positions) || !allFinite(point.velocities)) return "a value is not finite";
    if (point.time_from_start <= before) return "the points' times do not rise";
    before = point.time_from_start;
  }
  if (!command.points.empty() && command.start + before <= now_) return "it lies in the past";
  return {};
}

std::string CommandedArms::command(const ArmCommand& command) {
  std::string defect = defectOf(command);
  if (!defect.empty()) return defect;
  driven_.clear();
  knots_.clear();
  if (command.points.empty()) return {};
  Knot here{now_, {}, {}};
  for (const std::string& joint : command.joints) {
    driven_.push_back(*variableOf(*model_, joint));
    here.positions.push_back(positions_[driven_.back()]);
    here.velocities.push_back(velocities_[driven_.back()]);
  }
  knots_.push_back(here);
  for (const ArmCommand::Point& point : command.points) {
    const Time at = command.start + point.time_from_start;
    if (at > now_) knots_.push_back({at, point.positions, point.velocities});
  }
  return {};
}

void CommandedArms::step(Time now) {
  const double elapsed_s = toSeconds(now - now_);
  std::vector<bool> followed(positions_.size(), false);
  double brake_s = elapsed_s;  // of the driven joints
  if (!knots_.empty()) {
    const Time end = std::min(now, knots_.back().at);
    follow(end);
    brake_s = toSeconds(now - end);
  }
  stepControlled(now, followed);
  for (const std::size_t variable : driven_) {
    followed[variable] = true;
    brake(variable, brake_s);
  }
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    if (!followed[i]) brake(i, elapsed_s);
  }
  keepWithinLimits();
  now_ = now;
  if (knots_.empty() || now < knots_.back().at) return;
  knots_.clear();
  driven_.clear();
}

void CommandedArms::stepControlled(Time now, std::vector<bool>& followed) {
  for (ControlledArm& arm : controlled_) {
    arm.step(now, positions_, velocities_);
    for (const std::size_t variable : arm.variables()) followed[variable] = true;
  }
}

bool CommandedArms::holds() const {
  return knots_.empty() &&
         std::none_of(controlled_.begin(), controlled_.end(),
                      [](const ControlledArm& arm) { return arm.controller().follows(); });
}

bool CommandedArms::moves() const {
  return std::any_of(velocities_.begin(), velocities_.end(), [](double v) { return v != 0.0; });
}

void CommandedArms::follow(Time until) {
  const auto to = std::find_if(knots_.begin() + 1, knots_.end() - 1,
                               [until](const Knot& knot) { return knot.at > until; });
  const auto from = to - 1;
  const bool cubic = !from->velocities.empty() && !to->velocities.empty();
  const double T = toSeconds(to->at - from->at);
  const double u = toSeconds(until - from->at) / T;
  for (std::size_t j = 0; j < driven_.size(); ++j) {
    const double way = to->positions[j] - from->positions[j];
    double position = from->positions[j] + u * way;
    double velocity = way / T;
    if (cubic) {
      const double v0 = from->velocities[j];
      const double v1 = to->velocities[j];
      position = from->positions[j] + u * u * (3.0 - 2.0 * u) * way +
                 T * u * (1.0 - u) * ((1.0 - u) * v0 - u * v1);
      velocity = 6.0 * u * (1.0 - u) * way / T + (1.0 - u) * (1.0 - 3.0 * u) * v0 +
                 u * (3.0 * u - 2.0) * v1;
    }
    positions_[driven_[j]] = position;
    velocities_[driven_[j]] = velocity;
  }
}

void CommandedArms::keepWithinLimits() {
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    const JointVariable& variable = model_->variables()[i];
    const double allowed = std::clamp(positions_[i], variable.lower.value_or(positions_[i]),
                                      variable.upper.value_or(positions_[i]));
    if (allowed == positions_[i]) continue;
    positions_[i] = allowed;
    velocities_[i] = 0.0;
  }
}

void CommandedArms::brake(std::size_t variable, double elapsed_s) {
  double& velocity = velocities_[variable];
  if (velocity == 0.0) return;
  const double braking_s = std::min(elapsed_s, std::abs(velocity) / config_.deceleration_rps2);
  const double change = std::copysign(config_.deceleration_rps2 * braking_s, velocity);
  positions_[variable] += (velocity - 0.5 * change) * braking_s;
  velocity = braking_s < elapsed_s ? 0.0 : velocity - change;
}

}  // namespace tccm::simulation
