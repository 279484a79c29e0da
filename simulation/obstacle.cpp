#include "simulation/obstacle.h"

#include <cassert>
#include <cmath>

#include "simulation/named.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

const Eigen::Vector3f kRed(0.85F, 0.20F, 0.18F);
const Eigen::Vector3f kSkin(0.88F, 0.67F, 0.55F);
constexpr double kSpacing = 0.01;  // [m]

/// Around the origin; x is the direction that the hand comes from.
World shapesOf(ObstacleKind kind) {
  switch (kind) {
    case ObstacleKind::kPole:
      return {{kObstacleName, Cylinder{0.03, 0.20}, at(0.0, 0.0, 0.0), kRed}};
    case ObstacleKind::kBox:
      return {{kObstacleName, Box{Vector3(0.05, 0.10, 0.08)}, at(0.0, 0.0, 0.0), kRed}};
    case ObstacleKind::kArm: {
      Pose forearm = at(0.27, 0.0, 0.0);
      forearm.rotate(Eigen::AngleAxisd(M_PI_2, Vector3::UnitY()));
      return {{kObstacleName, Box{Vector3(0.09, 0.045, 0.018)}, at(0.0, 0.0, 0.0), kSkin},
              {kObstacleName, Capsule{0.04, 0.16}, forearm, kSkin}};
    }
    case ObstacleKind::kNone:
      break;
  }
  assert(false);
  return {};
}

World placed(World world, const Pose& T_fixed_obstacle) {
  for (SceneObject& part : world) part.T_fixed_shape = T_fixed_obstacle * part.T_fixed_shape;
  return world;
}

/// The least distance along the heading, from where the obstacle is, at which it is clear of the
/// hand by gap. Both are convex enough for the clearance to grow along the way.
double wayToGap(const HandState& hand, const World& obstacle, double gap) {
  const auto clearanceAt = [&](double way) {
    SampledBody moved(bodyOf(obstacle), kSpacing);
    moved.shift(way * hand.heading);
    return clearance(hand.shapes, moved);
  };
  double near = 0.0;
  double far = 2.0;
  while (far - near > 1e-5) {
    const double middle = 0.5 * (near + far);
    (clearanceAt(middle) < gap ? near : far) = middle;
  }
  return far;
}

}  // namespace

ObstacleKind obstacleKind(const std::string& name) {
  return named<ObstacleKind>("obstacle", name, {"none", "pole", "arm", "box"});
}

ObstaclePurpose obstaclePurpose(const std::string& name) {
  return named<ObstaclePurpose>("obstacle_for", name, {"collision", "occlusion"});
}

void ObstacleStance::validate() const {
  requireInRange("obstacle aside_m", aside_m, -0.2, 0.2);
  requireInRange("obstacle turn_rad", turn_rad, -M_PI, M_PI);
}

World obstacleAt(ObstacleKind kind, const Pose& T_fixed_obstacle) {
  return placed(shapesOf(kind), T_fixed_obstacle);
}

World obstacleAhead(ObstacleKind kind, const HandState& hand, double gap_m,
                    const ObstacleStance& stance) {
  constexpr double kSlant = 0.6;  // [rad] between a human arm and the hand's way
  Pose T_fixed_obstacle = Pose::Identity();
  const Vector3 left = Vector3::UnitZ().cross(hand.heading).normalized();
  T_fixed_obstacle.translation() = hand.centre + stance.aside_m * left;
  T_fixed_obstacle.rotate(Eigen::AngleAxisd(std::atan2(hand.heading.y(), hand.heading.x()) -
                                                (kind == ObstacleKind::kArm ? kSlant : 0.0) +
                                                stance.turn_rad,
                                            Vector3::UnitZ()));
  const World obstacle = placed(shapesOf(kind), T_fixed_obstacle);
  return placed(obstacle,
                Pose(Eigen::Translation3d(wayToGap(hand, obstacle, gap_m) * hand.heading)));
}

World obstacleBetween(ObstacleKind kind, const Vector3& sensor, const Vector3& palm,
                      const ObstacleStance& stance) {
  constexpr double kShare = 0.6;  // of the way from the sensor to the palm
  const Vector3 look = (palm - sensor).normalized();
  const Vector3 across = Vector3::UnitZ().cross(look).normalized();
  const Vector3 up = look.cross(across);
  Eigen::Matrix3d axes;  // the long side lies across the look, the widest side faces the sensor
  switch (kind) {
    case ObstacleKind::kArm:
      axes << -across, -up, look;
      break;
    case ObstacleKind::kPole:
      axes << look, -up, across;
      break;
    default:
      axes << look, across, up;
  }
  Pose T_fixed_obstacle = Pose::Identity();
  T_fixed_obstacle.linear() = Eigen::AngleAxisd(stance.turn_rad, look) * axes;
  T_fixed_obstacle.translation() = sensor + kShare * (palm - sensor) + stance.aside_m * across;
  return placed(shapesOf(kind), T_fixed_obstacle);
}

}  // namespace tccm::simulation
