#pragma once

#include <gtest/gtest.h>

#include <string>

#include "support/error_of.h"
#include "tccm_monitor/robot_model.h"

namespace tccm::test {

/// What a robot is refused with, in one line; empty where it is taken.
inline std::string refusalOf(const std::string& urdf, const RobotModel::Config& config = {},
                             const RobotResources& resources = {}) {
  const std::string error = errorOf([&] { const RobotModel model(urdf, config, resources); });
  EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  return error;
}

/// Whether a message has a word in it.
inline bool names(const std::string& message, const std::string& what) {
  return message.find(what) != std::string::npos;
}

}  // namespace tccm::test
