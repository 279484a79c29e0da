#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "geometry/ray.h"
#include "simulation/snapshot.h"

namespace tccm::simulation {

/// What a ray meets first.
struct Hit {
  double range = std::numeric_limits<double>::infinity();
  std::size_t target = 0;
  std::size_t label = 0;

  [[nodiscard]] bool found() const { return std::isfinite(range); }
};

/// A snapshot's targets, made ready for many rays. One that contains the sensor (its own housing)
/// is not seen.
class RayCaster {
 public:
  explicit RayCaster(const Snapshot& snapshot);

  /// From now on rays are cast from there along the direction, or aside of it by no more than the
  /// angle, below 90 degrees.
  void aim(const Ray& axis, double angle);
  /// @pre aim() included the ray.
  [[nodiscard]] Hit cast(const Ray& ray, double range_max) const;

 private:
  struct Target {
    Shape shape;
    Pose T_shape_fixed;
    Vector3 centre;
    double radius;
    std::size_t label;
  };
  static constexpr double kTiny = 1e-9;  // [m^2], far above rounding
  // Within a scan the sensor turns and moves a little: a ray begins within kAside of where it was,
  // and leaves the plane of the scan by no more than kSlope of its length.
  static constexpr double kAside = 0.01;  // [m]
  static constexpr double kSlope = 0.05;

  [[nodiscard]] bool isNearPlane(const Ray& axis, double spread) const;
  /// @return true where a ray that is near the plane may meet it.
  [[nodiscard]] bool meetsScanPlane(const Target& target) const;

  Vector3 sensor_;
  Vector3 normal_;  ///< of the plane of the scan
  std::vector<Target> targets_;
  std::vector<std::size_t> all_;         ///< indices, rising
  std::vector<std::size_t> near_plane_;  ///< those that a ray near the plane may meet, rising
  std::vector<std::size_t> aimed_at_;    ///< indices, rising
};

/// The sensor's pose and the targets at any instant between the first and the last snapshot. The
/// sensor's pose is interpolated between them; the targets are those of the nearest one.
class MovingScene {
 public:
  /// @param snapshots at rising instants; have to outlive this.
  explicit MovingScene(const std::vector<Snapshot>& snapshots);

  [[nodiscard]] Pose sensorAt(Time stamp) const;
  [[nodiscard]] RayCaster& casterAt(Time stamp);

 private:
  [[nodiscard]] std::size_t nearestTo(Time stamp) const;

  const std::vector<Snapshot>& snapshots_;
  std::vector<std::optional<RayCaster>> casters_;  ///< those that were asked for
  PosePath T_fixed_sensor_;
};

}  // namespace tccm::simulation
