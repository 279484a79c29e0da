#include "experiments/sensor_choice.h"

#include <gtest/gtest.h>

#include "support/error_of.h"

namespace tccm::simulation {
namespace {

SensorChoice of(const std::vector<SensorKind>& kinds) {
  SensorChoice choice;
  choice.kinds = kinds;
  return choice;
}

TEST(SensorChoiceTest, ALaserAloneChangesNothing) {
  MonitorConfig settings;
  of({SensorKind::kLaser}).applyTo(settings);
  EXPECT_TRUE(settings.named_sensors.empty());
  EXPECT_TRUE(settings.checker.checker.inputs.sensors.empty());
}

TEST(SensorChoiceTest, SensorsAreNamedInTheirOrderAndCloudsHaveAWindow) {
  MonitorConfig settings;
  settings.mapper.mapper.map.grid.height_min_m = 0.1;
  of({SensorKind::kLidar, SensorKind::kLaser, SensorKind::kCamera}).applyTo(settings);
  const Monitor::Config monitor = settings.monitor();
  ASSERT_EQ(monitor.sensors.size(), 3U);
  EXPECT_EQ(settings.checker.checker.inputs.sensors[0].name, "lidar");
  EXPECT_EQ(settings.checker.checker.inputs.sensors[2].name, "camera");
  for (const auto& sensor : monitor.sensors) {
    EXPECT_EQ(sensor.mapper.map.grid.height_min_m, 0.1);
  }
  EXPECT_FALSE(monitor.sensors[1].cloud);
  EXPECT_EQ(monitor.sensors[1].mapper.window_s, 0.0);
  EXPECT_EQ(monitor.sensors[0].cloud->noise.per_m2, 0.0);
  EXPECT_EQ(monitor.sensors[0].cloud->noise.constant_m, 0.03);
  EXPECT_EQ(monitor.sensors[2].mapper.window_s, 0.3);
  EXPECT_GE(monitor.sensors[2].mapper.map.returns_max, 9U * 640U * 480U);
}

TEST(SensorChoiceTest, AConfigurationThatNamesTheSameSensorsIsKept) {
  MonitorConfig settings;
  of({SensorKind::kCamera}).applyTo(settings);
  settings.named_sensors.front().mapper.mapper.window_s = 0.7;
  of({SensorKind::kCamera}).applyTo(settings);
  EXPECT_EQ(settings.monitor().sensors.front().mapper.window_s, 0.7);
  for (const auto& kinds :
       {std::vector<SensorKind>{SensorKind::kLaser}, std::vector<SensorKind>{SensorKind::kLidar}}) {
    EXPECT_EQ(test::errorOf([&] { of(kinds).applyTo(settings); }).find("sensors: "), 0U);
  }
}

TEST(SensorChoiceTest, TellsWhereASensorIs) {
  const SensorChoice both = of({SensorKind::kLaser, SensorKind::kCamera});
  EXPECT_EQ(both.indexOf(SensorKind::kCamera), 1U);
  EXPECT_EQ(both.indexOf(SensorKind::kLidar), std::nullopt);
  EXPECT_FALSE(both.isLaserAlone());
  Simulator::Config simulator;
  both.applyTo(simulator);
  EXPECT_EQ(simulator.sensors, both.kinds);
}

}  // namespace
}  // namespace tccm::simulation
