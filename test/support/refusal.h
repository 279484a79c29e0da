#pragma once

#include <gtest/gtest.h>

#include <string>

#include "robot/robot_model.h"
#include "tccm_monitor/config_error.h"

namespace tccm::test {

/// What a robot is refused with, in one line; empty where it is taken.
inline std::string refusalOf(const std::string& urdf, const RobotModel::Config& config = {},
                             const RobotResources& resources = {}) {
  try {
    const RobotModel model(urdf, config, resources);
  } catch (const ConfigError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.what();
  }
  return {};
}

/// Whether a message has a word in it.
inline bool names(const std::string& message, const std::string& what) {
  return message.find(what) != std::string::npos;
}

}  // namespace tccm::test
