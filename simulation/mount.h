#pragma once

#include <string>
#include <vector>

#include "tccm_monitor/pose.h"

namespace tccm::simulation {

/// Where a sensor is on the robot.
struct Mount {
  std::string link;
  Pose T_link_sensor;
};

enum class SensorKind { kLaser, kCamera, kLidar };

/// "laser", "camera" and "lidar".
[[nodiscard]] std::vector<std::string> sensorNames();
/// @throws ConfigError for another name.
[[nodiscard]] SensorKind sensorKind(const std::string& name);
[[nodiscard]] std::string name(SensorKind kind);
/// By their names. @throws ConfigError also where one comes twice, or none.
[[nodiscard]] std::vector<SensorKind> sensorKinds(const std::vector<std::string>& names);

/// An optical frame (z ahead, x right, y down) in which a place is ahead and another direction
/// above. @pre the place does not lie in that direction.
[[nodiscard]] Pose lookingAt(const Vector3& from, const Vector3& to, const Vector3& up);

/// The places that cameraMount() knows: "chest" and "head" look at the table, "wrist" along the
/// right hand, "side" stands on the robot's right and looks across before it.
[[nodiscard]] std::vector<std::string> cameraPlaces();
/// Of the camera's optical frame. @throws ConfigError for another place.
[[nodiscard]] Mount cameraMount(const std::string& place);
/// Above the head, tilted to look at the table ahead.
[[nodiscard]] Mount lidarMount();

}  // namespace tccm::simulation
