#include "simulation/cloud_sensors.h"

#include <algorithm>
#include <utility>

#include "simulation/robot/dual_arm.h"

namespace tccm::simulation {
namespace {

/// A hand moves by a few millimetres between the lidar's snapshots; the sensor's own pose is
/// interpolated.
constexpr Duration kSnapshotPeriod = std::chrono::milliseconds(2);

}  // namespace

void CloudSensors::Config::validate() const {
  camera.validate();
  lidar.validate();
}

CloudSensors::Place::Place(const RobotModel& model, const Mount& mount)
    : link(linkIndex(model, mount.link)), T_link_sensor(mount.T_link_sensor) {}

CloudSensors::CloudSensors(const Config& config, const std::vector<SensorKind>& kinds,
                           const RobotModel& model, Time start, std::uint64_t seed)
    : config_((config.validate(), config)),
      camera_place_(model, config.camera_mount),
      lidar_place_(model, config.lidar_mount) {
  QuickRandom random(seed);
  const auto has = [&kinds](SensorKind kind) {
    return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
  };
  if (has(SensorKind::kCamera)) camera_.emplace(config.camera, random());
  if (has(SensorKind::kLidar)) lidar_.emplace(config.lidar, random());
  next_frame_ = start + fromSeconds(random.uniform() * config.camera.period_s);
  next_snapshot_ = start + std::chrono::milliseconds(1);
  turn_start_ = next_snapshot_;
}

bool CloudSensors::isDue(Time now) const {
  return (camera_ && now >= next_frame_) || (lidar_ && now >= next_snapshot_);
}

CloudSensors::Output CloudSensors::step(Snapshot scene, const std::vector<Pose>& link_poses) {
  Output output;
  if (camera_ && scene.stamp >= next_frame_) {
    scene.T_fixed_sensor = camera_place_.pose(link_poses);
    output.camera = camera_->measure(scene);
    next_frame_ += fromSeconds(config_.camera.period_s);
  }
  if (lidar_ && scene.stamp >= next_snapshot_) {
    scene.T_fixed_sensor = lidar_place_.pose(link_poses);
    next_snapshot_ += kSnapshotPeriod;
    output.lidar = turn(std::move(scene));
  }
  return output;
}

std::optional<SimulatedCloud> CloudSensors::turn(Snapshot scene) {
  snapshots_.push_back(std::move(scene));
  if (snapshots_.back().stamp < turn_start_ + config_.lidar.turnDuration()) return std::nullopt;
  SimulatedCloud cloud = lidar_->measure(turn_start_, snapshots_);
  turn_start_ += fromSeconds(config_.lidar.period_s);
  const auto needed = std::find_if(snapshots_.begin(), snapshots_.end(), [this](const Snapshot& s) {
    return s.stamp + kSnapshotPeriod > turn_start_;
  });
  snapshots_.erase(snapshots_.begin(), needed);
  return cloud;
}

}  // namespace tccm::simulation
