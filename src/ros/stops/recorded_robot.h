#pragma once

#include <rosbag/bag.h>

#include <memory>
#include <string>

#include "monitor_config.h"
#include "ros/stops/stop_writer.h"

namespace tccm {

/// Robot and configuration that a stop's bag begins with.
struct RecordedRobot {
  CheckerConfig checker;  ///< as the nodelet took it
  std::shared_ptr<const RobotModel> model;

  /// Primitives stand for the meshes, which need not be there any more.
  /// @param parameters of the checker and of monitored_robot, as YAML.
  [[nodiscard]] static StopWriter::Preamble preambleOf(const std::string& checker_yaml,
                                                       const std::string& robot_yaml,
                                                       const std::string& urdf,
                                                       const RobotModel& model);
  /// @throws std::runtime_error where it is not all there.
  [[nodiscard]] static RecordedRobot from(const rosbag::Bag& bag);
  /// Whether a topic is one of these.
  [[nodiscard]] static bool isOf(const std::string& topic);
};

}  // namespace tccm
