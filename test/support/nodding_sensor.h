#pragma once

#include <cmath>
#include <functional>

#include "monitor_config.h"

namespace tccm::test {

inline constexpr double kTiltPeriod = 1.0;    // [s]
inline constexpr double kTableHeight = 0.40;  // [m]
inline const Vector3 kSensor(0.0, 0.0, 1.0);

/// A sensor 1 m up, which looks ahead and down by 0.65 rad, and by so much more and less as it
/// nods.
inline Pose noddingSensor(double seconds, double amplitude_rad) {
  const double down = 0.65 + amplitude_rad * std::sin(2.0 * M_PI * seconds / kTiltPeriod);
  Pose pose = Pose::Identity();
  pose.rotate(Eigen::AngleAxisd(down, Vector3::UnitY()));
  pose.pretranslate(kSensor);
  return pose;
}

/// What it measures to either side, all beams at once. @param range along a direction [m].
inline LaserScan scanBy(const Pose& sensor, Time stamp,
                        const std::function<double(const Vector3& direction)>& range) {
  LaserScan scan;
  scan.stamp = stamp;
  scan.angle_min = -0.5;
  scan.angle_increment = 0.01;
  scan.range_min = 0.05;
  scan.range_max = 4.0;
  for (int i = 0; i <= 100; ++i) {
    const double angle = scan.angle_min + i * scan.angle_increment;
    const Vector3 direction = sensor.linear() * Vector3(std::cos(angle), std::sin(angle), 0.0);
    scan.ranges.push_back(static_cast<float>(range(direction)));
  }
  return scan;
}

}  // namespace tccm::test
