#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "simulation/depth_camera.h"
#include "simulation/lidar.h"
#include "simulation/mount.h"
#include "tccm_monitor/robot_model.h"

namespace tccm::simulation {

/// The simulated robot's sensors that give clouds.
class CloudSensors {
 public:
  struct Config {
    DepthCamera::Config camera;
    Mount camera_mount = cameraMount("chest");
    Lidar::Config lidar;
    Mount lidar_mount = lidarMount();

    /// @throws ConfigError
    void validate() const;
  };
  struct Output {
    std::optional<SimulatedCloud> camera;
    std::optional<SimulatedCloud> lidar;  ///< once its last column is measured
  };

  /// @param kinds which of them there are, the laser apart. @throws ConfigError, and
  /// std::out_of_range where a mount's link is not the model's.
  CloudSensors(const Config& config, const std::vector<SensorKind>& kinds, const RobotModel& model,
               Time start, std::uint64_t seed);

  /// Whether step() at that time takes a snapshot.
  [[nodiscard]] bool isDue(Time now) const;
  /// At the times that are due, a millisecond or less apart from when they became so.
  /// @param scene its sensor's pose does not matter. @param link_poses T_fixed_link.
  [[nodiscard]] Output step(Snapshot scene, const std::vector<Pose>& link_poses);

 private:
  struct Place {
    std::size_t link;
    Pose T_link_sensor;

    Place(const RobotModel& model, const Mount& mount);
    [[nodiscard]] Pose pose(const std::vector<Pose>& link_poses) const {
      return link_poses[link] * T_link_sensor;
    }
  };
  [[nodiscard]] std::optional<SimulatedCloud> turn(Snapshot scene);

  Config config_;
  Place camera_place_, lidar_place_;
  std::optional<DepthCamera> camera_;
  std::optional<Lidar> lidar_;
  Time next_frame_;
  Time turn_start_;
  Time next_snapshot_;
  std::vector<Snapshot> snapshots_;  ///< of the lidar's turn
};

}  // namespace tccm::simulation
