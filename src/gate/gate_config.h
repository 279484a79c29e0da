#pragma once

#include <string>
#include <vector>

#include "config/parameter_table.h"
#include "gate/gated_motion.h"

namespace tccm {

/// Parameters of the TrajectoryGate nodelet.
struct GateConfig {
  /// An arm's controller, and the action in front of it.
  struct Controller {
    std::string name;
    std::string downstream;
    std::vector<std::string> joints = {};
    std::string mode = "stream";
    double stop_duration_s = 0.0;
    std::string hold = "cancel";
    std::string slider = {};
    std::string slider_type = "std_msgs/Float64";

    [[nodiscard]] bool forwards() const { return mode == "forward"; }
    [[nodiscard]] GatedMotion::Pace pace() const;
    void describe(ParameterTable& table);
    void validate() const;
  };

  static constexpr const char* kGuardName = "gate_guard";  ///< of the node, beside the gate

  double rate_hz = 200.0;
  double joints_age_max_s = 0.1;
  double start_tolerance = 0.01;
  double check_timeout_s = 2.0;
  double answer_timeout_s = 1.0;
  double moving_out_wait_s = 0.5;
  std::string execution_event = {};
  GatedMotion::Config motion;
  std::vector<Controller> controllers;

  /// How long the slowest of the arms takes to halt [s]. The checker's margins reckon with it.
  [[nodiscard]] double stopDurationMax() const;
  void describe(ParameterTable& table);
  void validate() const;
};

}  // namespace tccm
