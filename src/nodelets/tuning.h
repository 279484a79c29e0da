#pragma once

#include <dynamic_reconfigure/ConfigDescription.h>
#include <dynamic_reconfigure/Reconfigure.h>
#include <dynamic_reconfigure/config_tools.h>
#include <ros/ros.h>

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <variant>

#include "monitor_config.h"
#include "ros/handles.h"
#include "tccm_monitor/config_error.h"

namespace tccm {

/// Lets tunable parameters be changed while the checker runs, as dynamic_reconfigure's clients do:
/// what there is to tune is in the parameters' table. A set of values that is not allowed together,
/// or not while a robot may move, is refused as a whole.
class Tuning {
 public:
  Tuning(const ros::NodeHandle& private_node, CheckerConfig& config, Checker& checker)
      : private_node_(private_node), config_(config), checker_(checker) {
    descriptions_ = advertise<ConfigDescription>(private_node_, "parameter_descriptions", 1, true);
    updates_ = advertise<Config>(private_node_, "parameter_updates", 1, true);
    descriptions_.publish(describe());
    publish();
    service_ = serve(private_node_, "set_parameters", &Tuning::change, this);
  }

 private:
  using Config = dynamic_reconfigure::Config;
  using ConfigDescription = dynamic_reconfigure::ConfigDescription;
  using ConfigTools = dynamic_reconfigure::ConfigTools;

  /// Calls visit(row, value) for each tunable parameter: a switch, which ranges from false to true,
  /// or a number. @param visit may change the value.
  template <typename Visit>
  static void visitTunable(CheckerConfig& config, Visit&& visit) {
    const ParameterTable table = tableOf(config);
    for (ParameterTable::Row row : table.rows()) {
      if (row.tunable != Tunable::kYes) continue;
      if (std::holds_alternative<bool*>(row.member)) row.range = {0.0, 1.0};
      if (auto* const* member = std::get_if<bool*>(&row.member)) visit(row, **member);
      if (auto* const* member = std::get_if<int*>(&row.member)) visit(row, **member);
      if (auto* const* member = std::get_if<double*>(&row.member)) visit(row, **member);
    }
  }

  static Config emptyMessage() {
    Config message;
    message.groups.emplace_back();
    message.groups.back().name = "Default";
    message.groups.back().state = true;
    return message;
  }

  static Config toMessage(CheckerConfig config) {
    Config message = emptyMessage();
    visitTunable(config, [&message](const auto& row, auto value) {
      ConfigTools::appendParameter(message, row.key, value);
    });
    return message;
  }

  static ConfigDescription describe() {
    CheckerConfig defaults;
    ConfigDescription description;
    description.min = description.max = emptyMessage();
    description.dflt = toMessage(defaults);
    description.groups.emplace_back();
    description.groups.back().name = "Default";
    visitTunable(defaults, [&description](const auto& row, auto value) {
      using T = decltype(value);
      auto& entry = description.groups.back().parameters.emplace_back();
      entry.name = row.key;
      entry.type = std::is_same_v<T, bool> ? "bool" : std::is_same_v<T, int> ? "int" : "double";
      entry.description = row.meaning + (row.unit.empty() ? "" : " [" + row.unit + "]");
      ConfigTools::appendParameter(description.min, row.key, static_cast<T>(row.range.lowest));
      ConfigTools::appendParameter(description.max, row.key, static_cast<T>(row.range.highest));
    });
    return description;
  }

  /// The configuration with what the message sets of it; numbers are brought within their ranges.
  /// @throws ConfigError for NaN and infinity
  static CheckerConfig tuned(CheckerConfig config, const Config& message) {
    visitTunable(config, [&message](const auto& row, auto& value) {
      using T = std::remove_reference_t<decltype(value)>;
      if (!ConfigTools::getParameter(message, row.key, value)) return;
      if (!std::isfinite(static_cast<double>(value))) {
        requireInRange(row.key, static_cast<double>(value), row.range.lowest, row.range.highest);
      }
      value =
          std::clamp(value, static_cast<T>(row.range.lowest), static_cast<T>(row.range.highest));
    });
    return config;
  }

  /// A slip of a slider must not take away what keeps a moving robot safe: no less than a floor,
  /// unless it was configured lower. @throws ConfigError naming the key.
  static void refuseUnsafe(const CheckerConfig& now, const CheckerConfig& wanted) {
    const auto paddingOf = [](const CheckerConfig& config) {
      return config.checker.pose.collision_use.expansion.padding_m;
    };
    const ContactJudge::Config &way_now = now.checker.way, &way = wanted.checker.way;
    requireInRange("collision_padding_m", paddingOf(wanted),
                   std::min(now.tuning_padding_min_m, paddingOf(now)), 1.0);
    requireInRange("stop_time_s", way.stop_time_s,
                   std::min(now.tuning_stop_time_min_s, way_now.stop_time_s), 10.0);
    requireInRange("horizon_s", way.horizon_s, std::min(way.stop_time_s, way_now.horizon_s), 10.0);
    if (now.checker.pose.check_occlusion && !wanted.checker.pose.check_occlusion) {
      throw ConfigError("check_occlusion: cannot be switched off while the checker runs");
    }
  }

  bool change(dynamic_reconfigure::Reconfigure::Request& request,
              dynamic_reconfigure::Reconfigure::Response& response) {
    try {
      const CheckerConfig wanted = tuned(config_, request.config);
      refuseUnsafe(config_, wanted);
      static_cast<void>(validated(wanted));
      checker_.reconfigure(wanted.checker);
      config_ = wanted;
    } catch (const std::exception& error) {
      ROS_ERROR("%s: refused: %s", private_node_.getNamespace().c_str(), error.what());
    }
    publish();
    response.config = toMessage(config_);  // what is shown is what is in force
    return true;
  }

  /// What is in force; also on the parameter server.
  void publish() {
    visitTunable(config_,
                 [this](const auto& row, auto value) { private_node_.setParam(row.key, value); });
    updates_.publish(toMessage(config_));
  }

  ros::NodeHandle private_node_;
  CheckerConfig& config_;
  Checker& checker_;
  ros::Publisher descriptions_, updates_;
  ros::ServiceServer service_;
};

}  // namespace tccm
