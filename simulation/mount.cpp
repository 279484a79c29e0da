#include "simulation/mount.h"

#include <algorithm>

#include "simulation/named.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {

Pose lookingAt(const Vector3& from, const Vector3& to, const Vector3& up) {
  Pose pose = Pose::Identity();
  const Vector3 ahead = (to - from).normalized();
  const Vector3 right = ahead.cross(up).normalized();
  pose.linear() << right, ahead.cross(right), ahead;
  pose.translation() = from;
  return pose;
}

std::vector<std::string> sensorNames() { return {"laser", "camera", "lidar"}; }

SensorKind sensorKind(const std::string& name) {
  return named<SensorKind>("sensors", name, {"laser", "camera", "lidar"});
}

std::string name(SensorKind kind) { return sensorNames()[static_cast<std::size_t>(kind)]; }

std::vector<SensorKind> sensorKinds(const std::vector<std::string>& names) {
  std::vector<SensorKind> kinds;
  for (const std::string& name : names) {
    const SensorKind kind = sensorKind(name);
    if (std::find(kinds.begin(), kinds.end(), kind) != kinds.end()) {
      throw ConfigError("sensors: " + name + " is named twice");
    }
    kinds.push_back(kind);
  }
  if (kinds.empty()) throw ConfigError("sensors: name one at least of laser, camera, lidar");
  return kinds;
}

std::vector<std::string> cameraPlaces() { return {"chest", "wrist", "head", "side"}; }

Mount cameraMount(const std::string& place) {
  const Vector3 up = Vector3::UnitZ();
  if (place == "chest") {
    return {"chest_link", lookingAt({0.14, 0.0, 0.34}, {0.65, 0.0, -0.03}, up)};
  }
  if (place == "wrist") {
    return {"right_palm_link", lookingAt({0.08, 0.0, 0.02}, {0.0, 0.0, -0.4}, Vector3::UnitX())};
  }
  if (place == "head") {
    return {"head_roll_link", lookingAt({0.1, 0.14, 0.08}, {0.6, 0.0, -0.5}, up)};
  }
  if (place == "side") {
    return {"base_link", lookingAt({0.9, -1.0, 2.2}, {0.4, 0.0, 0.9}, up)};
  }
  throw ConfigError("camera: " + place + " is none of chest, wrist, head, side");
}

Mount lidarMount() {
  Pose pose(Eigen::Translation3d(-0.05, 0.0, 0.95));
  pose.rotate(Eigen::AngleAxisd(0.7, Vector3::UnitY()));
  return {"chest_link", pose};
}

}  // namespace tccm::simulation
