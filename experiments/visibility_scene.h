#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "check/pose_check.h"
#include "experiments/true_visibility.h"
#include "simulation/arm_path.h"
#include "simulation/world.h"
#include "tccm_monitor/robot_model.h"

namespace tccm::simulation {

/// A pose of the robot's arms in a scene, with an obstacle that may hide some of them.
struct VisibilityScene {
  std::string scene;           ///< one of sceneNames()
  std::string obstacle;        ///< "none", "pole", "arm" or "box"
  World objects;               ///< the obstacle
  std::vector<double> joints;  ///< of the model's variables
};

/// Which of its links are of a size to be judged, and in the laser's range.
struct LinksThatCount {
  double in_range_min = 0.98;  ///< share of a link's silhouette that the laser looks at
  double silhouette_min_pixels = 2.0;

  /// @throws ConfigError
  void validate() const;
  [[nodiscard]] bool has(double in_range, double silhouette_pixels) const {
    return in_range >= in_range_min && silhouette_pixels >= silhouette_min_pixels;
  }
};

/// The same for the same seed. The obstacle lies across the way from the sensor to somewhere on the
/// arms, or beside it, in the area ahead of the robot, and touches neither arms nor head.
/// @throws ConfigError where none is found.
[[nodiscard]] VisibilityScene visibilityScene(const std::shared_ptr<const RobotModel>& model,
                                              double clearance_m, std::uint64_t seed);

/// A path that stays in a posture, but for a hair.
[[nodiscard]] ArmPath standing(const std::shared_ptr<const RobotModel>& model,
                               const std::vector<double>& joints);

/// How much of the links watched for occlusion the laser could see of a robot in a posture.
/// @param things that hide links. @param rest_hides whether what else of the robot is there does.
/// @param resolution_rad between rays.
[[nodiscard]] std::vector<TrueLinkVisibility> trueVisibility(
    const std::shared_ptr<const RobotModel>& model, const CheckedRobot::Config& pose,
    const std::vector<double>& joints, Body things, bool rest_hides, double resolution_rad);

}  // namespace tccm::simulation
