#include "nodelets/tuning.h"

#include <algorithm>

#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

Tuning::Values valuesOf(const CheckerSettings& settings, Tuning::Values values) {
  const Checker::Config& config = settings.checker;
  values.collision_padding_m = config.pose.collision_use.expansion.padding_m;
  values.primitive_scale = config.pose.collision_use.expansion.scale;
  values.horizon_s = config.way.horizon_s;
  values.stop_time_s = config.way.stop_time_s;
  values.reaction_time_s = config.way.reaction_time_s;
  values.deceleration_mps2 = config.way.deceleration_mps2;
  values.support_points = config.pose.collision.support_points;
  values.check_occlusion = config.pose.check_occlusion;
  values.occlusion_stops = config.occlusion_stops;
  values.occlusion_hidden_fraction = config.pose.occlusion.hidden_fraction;
  values.release_s = config.permission.release_s;
  values.release_checks = config.permission.release_checks;
  values.speed_scale_rise_per_s = config.permission.speed_scale_rise_per_s;
  values.check_time_max_periods = settings.check_time_max_periods;
  return values;
}

Checker::Config configOf(const Tuning::Values& values, Checker::Config config) {
  config.pose.collision_use.expansion.padding_m = values.collision_padding_m;
  config.pose.collision_use.expansion.scale = values.primitive_scale;
  config.way.horizon_s = values.horizon_s;
  config.way.stop_time_s = values.stop_time_s;
  config.way.reaction_time_s = values.reaction_time_s;
  config.way.deceleration_mps2 = values.deceleration_mps2;
  config.pose.collision.support_points = values.support_points;
  config.pose.check_occlusion = values.check_occlusion;
  config.occlusion_stops = values.occlusion_stops;
  config.pose.occlusion.hidden_fraction = values.occlusion_hidden_fraction;
  config.permission.release_s = values.release_s;
  config.permission.release_checks = values.release_checks;
  config.permission.speed_scale_rise_per_s = values.speed_scale_rise_per_s;
  return config;
}

/// A slip of a slider must not take away what keeps a moving robot safe: no less than a floor,
/// unless it was configured lower.
void refuseUnsafe(const CheckerSettings& settings, const Checker::Config& wanted) {
  const Checker::Config& now = settings.checker;
  const double padding_now = now.pose.collision_use.expansion.padding_m;
  requireInRange("collision_padding_m", wanted.pose.collision_use.expansion.padding_m,
                 std::min(settings.tuning_padding_min_m, padding_now), 1.0);
  requireInRange("stop_time_s", wanted.way.stop_time_s,
                 std::min(settings.tuning_stop_time_min_s, now.way.stop_time_s), 10.0);
  requireInRange("horizon_s", wanted.way.horizon_s,
                 std::min(wanted.way.stop_time_s, now.way.horizon_s), 10.0);
  if (now.pose.check_occlusion && !wanted.pose.check_occlusion) {
    throw ConfigError("check_occlusion: cannot be switched off while the checker runs");
  }
}

}  // namespace

Tuning::Tuning(ros::NodeHandle private_node, const std::string& name, CheckerSettings& settings,
               Checker& checker)
    : name_(name), settings_(settings), checker_(checker) {
  server_ = std::make_unique<dynamic_reconfigure::Server<Values>>(mutex_, private_node);
  Values current;
  server_->getConfigDefault(current);
  server_->updateConfig(valuesOf(settings_, current));
  server_->setCallback([this](Values& wanted, std::uint32_t /*level*/) { change(wanted); });
}

void Tuning::change(Values& wanted) {
  const Values now = valuesOf(settings_, wanted);
  const Checker::Config config = configOf(wanted, settings_.checker);
  try {
    refuseUnsafe(settings_, config);
    checker_.reconfigure(config);
    settings_.checker = config;
    settings_.check_time_max_periods = wanted.check_time_max_periods;
  } catch (const ConfigError& error) {
    ROS_ERROR("%s: refused: %s", name_.c_str(), error.what());
    wanted = now;  // what is shown is what is in force
  }
}

}  // namespace tccm
