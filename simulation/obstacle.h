#pragma once

#include <string>

#include "simulation/clearance.h"
#include "simulation/world.h"

namespace tccm::simulation {

enum class ObstacleKind { kNone, kPole, kArm, kBox };
enum class ObstaclePurpose { kCollision, kOcclusion };

/// "none", "pole", "arm" or "box". @throws ConfigError
[[nodiscard]] ObstacleKind obstacleKind(const std::string& name);
/// "collision" or "occlusion". @throws ConfigError
[[nodiscard]] ObstaclePurpose obstaclePurpose(const std::string& name);

constexpr char kObstacleName[] = "obstacle";

/// The hand an obstacle is put before, in the fixed frame.
struct HandState {
  SampledBody shapes;
  Vector3 centre;   ///< of the palm [m]
  Vector3 heading;  ///< unit vector along its motion
};

/// An obstacle (not kNone) anywhere. In its frame pole and box stand upright around the origin; a
/// human hand lies flat there, its forearm along x.
[[nodiscard]] World obstacleAt(ObstacleKind kind, const Pose& T_fixed_obstacle);

/// How an obstacle stands where it is put.
struct ObstacleStance {
  double aside_m = 0.0;   ///< to the left of the middle of the way, or of the line of sight
  double turn_rad = 0.0;  ///< about the upright, or the line of sight; counterclockwise

  /// @throws ConfigError
  void validate() const;
};

/// An obstacle (not kNone) on the hand's way, at gap_m [m] from its nearest point. Pole and box
/// stand upright across the way; a human forearm with its hand ahead comes slantwise towards the
/// hand.
[[nodiscard]] World obstacleAhead(ObstacleKind kind, const HandState& hand, double gap_m,
                                  const ObstacleStance& stance = {});

/// An obstacle (not kNone) lying across the line from the sensor to the palm, 0.6 of the way, far
/// from both.
[[nodiscard]] World obstacleBetween(ObstacleKind kind, const Vector3& sensor, const Vector3& palm,
                                    const ObstacleStance& stance = {});

}  // namespace tccm::simulation
