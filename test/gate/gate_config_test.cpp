#include "gate/gate_config.h"

#include <gtest/gtest.h>

#include "support/error_of.h"

namespace tccm {
namespace {

GateConfig::Controller arm(const std::string& name, double stop_duration_s = 0.0) {
  GateConfig::Controller controller;
  controller.name = name;
  controller.downstream = name + "_controller";
  controller.stop_duration_s = stop_duration_s;
  return controller;
}

std::string errorOf(const std::vector<GateConfig::Controller>& controllers) {
  GateConfig config;
  config.controllers = controllers;
  return test::errorOf([&config] { config.validate(); });
}

TEST(GateConfigTest, TheSlowestArmTellsHowLongHaltingTakes) {
  GateConfig config;
  EXPECT_EQ(config.stopDurationMax(), 0.0);
  config.controllers = {arm("left", 0.2), arm("right", 0.5), arm("head", 0.1)};
  EXPECT_EQ(config.stopDurationMax(), 0.5);
}

TEST(GateConfigTest, WhatPacesTheArmFollowsFromModeAndSlider) {
  GateConfig::Controller controller = arm("left");
  EXPECT_EQ(controller.pace(), GatedMotion::Pace::kSetpoints);
  controller.mode = "forward";
  EXPECT_EQ(controller.pace(), GatedMotion::Pace::kPlans);
  controller.slider = "speed";
  EXPECT_EQ(controller.pace(), GatedMotion::Pace::kMeasured);
}

TEST(GateConfigTest, ASliderNeedsAControllerThatIsForwardedToAndHaltsAtOnce) {
  GateConfig::Controller controller = arm("left");
  controller.mode = "forward";
  controller.slider = "speed";
  EXPECT_EQ(errorOf({controller}), "");
  controller.stop_duration_s = 0.1;
  EXPECT_NE(errorOf({controller}).find("stop_duration_s has to be 0 with a slider"),
            std::string::npos);
  controller.stop_duration_s = 0.0;
  controller.mode = "stream";
  EXPECT_NE(errorOf({controller}).find("slider is for the mode 'forward'"), std::string::npos);
}

TEST(GateConfigTest, NoTwoControllersShareANameOrWhatIsBehindThem) {
  EXPECT_EQ(errorOf({arm("left"), arm("right")}), "");
  EXPECT_NE(errorOf({arm("left"), arm("left")}), "");
  GateConfig::Controller other = arm("right");
  other.downstream = arm("left").downstream;
  EXPECT_NE(errorOf({arm("left"), other}), "");
}

TEST(GateConfigTest, AControllerBehindItselfIsRefused) {
  GateConfig::Controller controller = arm("left");
  controller.downstream = "left";
  EXPECT_NE(errorOf({controller}), "");
  controller.downstream = "";
  EXPECT_NE(errorOf({controller}), "");
  EXPECT_NE(errorOf({arm("")}), "");
}

TEST(GateConfigTest, WordsThatMeanNothingAreRefused) {
  GateConfig::Controller controller = arm("left");
  controller.mode = "streams";
  EXPECT_EQ(errorOf({controller}),
            "controllers: left: mode is 'streams', it may be one of 'stream', 'forward'");
  controller = arm("left");
  controller.hold = "brake";
  EXPECT_NE(errorOf({controller}), "");
  controller = arm("left");
  controller.slider_type = "std_msgs/Int8";
  EXPECT_NE(errorOf({controller}), "");
}

}  // namespace
}  // namespace tccm
