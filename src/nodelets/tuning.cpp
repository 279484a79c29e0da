#include "nodelets/tuning.h"

#include <dynamic_reconfigure/ConfigDescription.h>
#include <dynamic_reconfigure/config_tools.h>

#include <algorithm>

#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using dynamic_reconfigure::ConfigTools;

std::vector<ParameterTable::Row> tunableRows(CheckerConfig& config) {
  const ParameterTable table = tableOf(config);
  std::vector<ParameterTable::Row> rows;
  for (const ParameterTable::Row& row : table.rows()) {
    if (row.tunable == Tunable::kYes) rows.push_back(row);
  }
  return rows;
}

template <typename T>
const char* typeName() {
  if (std::is_same_v<T, bool>) return "bool";
  return std::is_same_v<T, int> ? "int" : "double";
}

/// Calls visit with a reference to the row's value, which is a bool, an int or a double.
template <typename Visit>
void visitValue(const ParameterTable::Row& row, Visit&& visit) {
  std::visit(
      [&](auto* member) {
        using T = std::remove_reference_t<decltype(*member)>;
        if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, int> ||
                      std::is_same_v<T, double>) {
          visit(*member);
        }
      },
      row.member);
}

dynamic_reconfigure::Config emptyMessage() {
  dynamic_reconfigure::Config message;
  message.groups.emplace_back();
  message.groups.back().name = "Default";
  message.groups.back().state = true;
  return message;
}

dynamic_reconfigure::ConfigDescription describe() {
  CheckerConfig defaults;
  dynamic_reconfigure::ConfigDescription description;
  description.min = description.max = emptyMessage();
  description.dflt = toMessage(defaults);
  description.groups.emplace_back();
  description.groups.back().name = "Default";
  for (const ParameterTable::Row& row : tunableRows(defaults)) {
    dynamic_reconfigure::ParamDescription entry;
    entry.name = row.key;
    entry.description = row.meaning + (row.unit.empty() ? "" : " [" + row.unit + "]");
    visitValue(row, [&](auto value) {
      using T = decltype(value);
      entry.type = typeName<T>();
      const bool is_switch = std::is_same_v<T, bool>;
      ConfigTools::appendParameter(description.min, row.key,
                                   is_switch ? T{} : static_cast<T>(row.range.lowest));
      ConfigTools::appendParameter(
          description.max, row.key,
          is_switch ? static_cast<T>(1) : static_cast<T>(row.range.highest));
    });
    description.groups.back().parameters.push_back(entry);
  }
  return description;
}

}  // namespace

dynamic_reconfigure::Config toMessage(CheckerConfig config) {
  dynamic_reconfigure::Config message = emptyMessage();
  for (const ParameterTable::Row& row : tunableRows(config)) {
    visitValue(row, [&](auto value) { ConfigTools::appendParameter(message, row.key, value); });
  }
  return message;
}

CheckerConfig tuned(CheckerConfig config, const dynamic_reconfigure::Config& message) {
  for (const ParameterTable::Row& row : tunableRows(config)) {
    visitValue(row, [&](auto& value) {
      using T = std::remove_reference_t<decltype(value)>;
      if (!ConfigTools::getParameter(message, row.key, value)) return;
      if constexpr (!std::is_same_v<T, bool>) {
        value =
            std::clamp(value, static_cast<T>(row.range.lowest), static_cast<T>(row.range.highest));
      }
    });
  }
  return config;
}

void refuseUnsafe(const CheckerConfig& now, const CheckerConfig& wanted) {
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

Tuning::Tuning(ros::NodeHandle private_node, const std::string& name, CheckerConfig& config,
               Checker& checker)
    : private_node_(private_node), name_(name), config_(config), checker_(checker) {
  descriptions_ = private_node_.advertise<dynamic_reconfigure::ConfigDescription>(
      "parameter_descriptions", 1, true);
  updates_ = private_node_.advertise<dynamic_reconfigure::Config>("parameter_updates", 1, true);
  descriptions_.publish(describe());
  publish();
  service_ = private_node_.advertiseService("set_parameters", &Tuning::change, this);
}

bool Tuning::change(dynamic_reconfigure::Reconfigure::Request& request,
                    dynamic_reconfigure::Reconfigure::Response& response) {
  try {
    const CheckerConfig wanted = tuned(config_, request.config);
    refuseUnsafe(config_, wanted);
    static_cast<void>(validated(wanted));
    checker_.reconfigure(wanted.checker);
    config_ = wanted;
  } catch (const std::exception& error) {
    ROS_ERROR("%s: refused: %s", name_.c_str(), error.what());
  }
  publish();
  response.config = toMessage(config_);  // what is shown is what is in force
  return true;
}

void Tuning::publish() {
  for (const ParameterTable::Row& row : tunableRows(config_)) {
    visitValue(row, [&](auto value) { private_node_.setParam(row.key, value); });
  }
  updates_.publish(toMessage(config_));
}

}  // namespace tccm
