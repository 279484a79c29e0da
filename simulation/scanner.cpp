#include "simulation/scanner.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

constexpr double kDegree = M_PI / 180.0;

struct Hit {
  double range = std::numeric_limits<double>::infinity();
  std::size_t target = 0;
  std::size_t label = 0;

  [[nodiscard]] bool found() const { return std::isfinite(range); }
};

/// A snapshot's targets, made ready for many rays.
class RayCaster {
 public:
  explicit RayCaster(const Snapshot& snapshot)
      : sensor_(snapshot.T_fixed_sensor.translation()),
        normal_(snapshot.T_fixed_sensor.linear().col(2)) {
    for (std::size_t i = 0; i < snapshot.targets.shapes.size(); ++i) {
      const Pose& T_fixed_shape = snapshot.targets.poses[i];
      const Pose T_shape_fixed = T_fixed_shape.inverse();
      if (distance(snapshot.targets.shapes[i], T_shape_fixed * sensor_) == 0.0) continue;
      targets_.push_back({snapshot.targets.shapes[i], T_shape_fixed, T_fixed_shape.translation(),
                          boundingRadius(snapshot.targets.shapes[i]), snapshot.labels[i]});
      all_.push_back(all_.size());
      if (meetsScanPlane(targets_.back())) near_plane_.push_back(all_.back());
    }
  }

  /// From now on rays are cast from there along the direction, or aside of it by no more than the
  /// angle.
  void aim(const Ray& axis, double angle) {
    const double spread = std::tan(angle);
    aimed_at_.clear();
    for (const std::size_t i : isNearPlane(axis, spread) ? near_plane_ : all_) {
      const Target& target = targets_[i];
      const Vector3 to_centre = target.centre - axis.origin;
      const double along = to_centre.dot(axis.direction);
      const double reach = target.radius + spread * (std::abs(along) + target.radius);
      const double across_squared = to_centre.squaredNorm() - along * along;
      if (along >= -target.radius - reach && across_squared <= reach * reach + kTiny) {
        aimed_at_.push_back(i);
      }
    }
  }

  /// @pre aim() included the ray.
  [[nodiscard]] Hit cast(const Ray& ray, double range_max) const {
    Hit nearest;
    for (const std::size_t i : aimed_at_) {
      const Target& target = targets_[i];
      const Vector3 to_centre = target.centre - ray.origin;
      const double along = to_centre.dot(ray.direction);
      const double across_squared = to_centre.squaredNorm() - along * along;
      if (along < -target.radius || across_squared > target.radius * target.radius) continue;
      const std::optional<LineSpan> span =
          intersect(target.shape, transformed(ray, target.T_shape_fixed));
      if (span && span->enter < nearest.range && span->enter <= range_max) {
        nearest = {span->enter, i, target.label};
      }
    }
    return nearest;
  }

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

  [[nodiscard]] bool isNearPlane(const Ray& axis, double spread) const {
    return (axis.origin - sensor_).norm() <= kAside &&
           std::abs(normal_.dot(axis.direction)) + spread <= kSlope;
  }
  /// @return true where a ray that is near the plane may meet it.
  [[nodiscard]] bool meetsScanPlane(const Target& target) const {
    const Vector3 to_centre = target.centre - sensor_;
    const double length_max = to_centre.norm() + target.radius + kAside;
    return std::abs(normal_.dot(to_centre)) <= target.radius + kAside + kSlope * length_max;
  }

  Vector3 sensor_;
  Vector3 normal_;  ///< of the plane of the scan
  std::vector<Target> targets_;
  std::vector<std::size_t> all_;         ///< indices, rising
  std::vector<std::size_t> near_plane_;  ///< those that a ray near the plane may meet, rising
  std::vector<std::size_t> aimed_at_;    ///< indices, rising
};

/// The sensor's pose and the targets at any instant between the first and the last snapshot.
class MovingScene {
 public:
  explicit MovingScene(const std::vector<Snapshot>& snapshots)
      : snapshots_(snapshots), casters_(snapshots.size()) {
    for (const Snapshot& snapshot : snapshots) {
      T_fixed_sensor_.add(snapshot.stamp, snapshot.T_fixed_sensor);
    }
  }

  [[nodiscard]] Pose sensorAt(Time stamp) const {
    const std::optional<Pose> pose = T_fixed_sensor_.at(stamp);
    assert(pose);
    return *pose;
  }

  [[nodiscard]] RayCaster& casterAt(Time stamp) {
    const std::size_t index = nearestTo(stamp);
    if (!casters_[index]) casters_[index].emplace(snapshots_[index]);
    return *casters_[index];
  }

 private:
  [[nodiscard]] std::size_t nearestTo(Time stamp) const {
    const auto later = std::find_if(snapshots_.begin(), snapshots_.end(),
                                    [&](const Snapshot& s) { return s.stamp >= stamp; });
    auto index = static_cast<std::size_t>(later - snapshots_.begin());
    if (index == snapshots_.size()) return index - 1;
    if (index > 0 && stamp - snapshots_[index - 1].stamp < later->stamp - stamp) --index;
    return index;
  }

  const std::vector<Snapshot>& snapshots_;
  std::vector<std::optional<RayCaster>> casters_;  ///< those that were asked for
  PosePath T_fixed_sensor_;
};

Vector3 direction(double azimuth, double elevation) {
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
          std::sin(elevation)};
}

/// What the axis of a beam and the rim of its spot meet.
struct Spot {
  Hit axis;
  Hit nearest;
  Hit farthest;

  void addRim(const Hit& hit) {
    if (!hit.found()) return;
    if (hit.range < nearest.range) nearest = hit;
    if (!farthest.found() || hit.range > farthest.range) farthest = hit;
  }
  /// Two surfaces of which neither is infinitely far: those make a range in between. Every target
  /// is convex, so two ranges on one target are one surface, seen at a slant.
  [[nodiscard]] bool straddles(double gap) const {
    return axis.found() && nearest.target != farthest.target &&
           farthest.range - nearest.range > gap;
  }
};

Spot lookThroughSpot(RayCaster& caster, const Pose& T_fixed_sensor, const SpotRays& rays,
                     const Scanner::Config& config) {
  const auto ray = [&](const Vector3& direction) -> Ray {
    return {T_fixed_sensor.translation(), T_fixed_sensor.linear() * direction};
  };
  const Ray axis = ray(rays.axis);
  caster.aim(axis, 1.01 * 0.5 * config.spot_deg * kDegree);
  Spot spot;
  spot.axis = caster.cast(axis, config.range_max_m);
  spot.nearest = spot.farthest = spot.axis;
  for (const Vector3& direction : rays.rim) {
    spot.addRim(caster.cast(ray(direction), config.range_max_m));
  }
  return spot;
}

double increment(const Scanner::Config& config) { return config.angle_increment_deg * kDegree; }

/// The beams are centred on x.
double angleMin(const Scanner::Config& config) {
  return -0.5 * static_cast<double>(config.beams - 1) * increment(config);
}

}  // namespace

void Scanner::Config::validate() const {
  requireInRange("beams", static_cast<double>(beams), 2.0, 1e5);
  requireInRange("angle_increment_deg", angle_increment_deg, 1e-3, 360.0);
  requireInRange("beams * angle_increment_deg",
                 static_cast<double>(beams - 1) * angle_increment_deg, 0.0, 360.0);
  requireInRange("period_s", period_s, 1e-4, 10.0);
  requireInRange("range_min_m", range_min_m, 0.0, range_max_m);
  requireInRange("range_max_m", range_max_m, 0.0, 1e3);
  requireInRange("noise_m", noise_m, 0.0, 1.0);
  requireInRange("spot_deg", spot_deg, 0.0, 10.0);
  requireInRange("mixed_share", mixed_share, 0.0, 1.0);
  requireInRange("mixed_persistence", mixed_persistence, 0.0, 1.0);
  requireInRange("mixed_gap_m", mixed_gap_m, 0.0, range_max_m);
}

Duration Scanner::Config::timeIncrement() const {
  return fromSeconds(period_s * angle_increment_deg / 360.0);
}

Duration Scanner::Config::scanDuration() const {
  return static_cast<Duration::rep>(beams - 1) * timeIncrement();
}

Scanner::Scanner(const Config& config, std::uint64_t seed) : config_(config), random_(seed) {
  config_.validate();
  const double half = 0.5 * config_.spot_deg * kDegree;
  for (std::size_t i = 0; i < config_.beams; ++i) {
    const double azimuth = angleMin(config_) + static_cast<double>(i) * increment(config_);
    spots_.push_back({direction(azimuth, 0.0),
                      {direction(azimuth - half, 0.0), direction(azimuth, -half),
                       direction(azimuth + half, 0.0), direction(azimuth, half)}});
  }
}

double Scanner::noisy(double range) { return range + config_.noise_m * normal_(random_); }

/// A chain of straddling beams keeps to what it does, so that false points come in runs.
void Scanner::advanceMixing() {
  const bool changes = uniform_(random_) >= config_.mixed_persistence;
  const bool mixes = uniform_(random_) < config_.mixed_share;
  const double share = 0.05 + 0.9 * uniform_(random_);
  if (!changes) return;
  mixing_ = {mixes, share};
}

SimulatedScan Scanner::measure(Time stamp, const std::vector<Snapshot>& snapshots) {
  SimulatedScan result;
  LaserScan& scan = result.scan;
  scan.stamp = stamp;
  scan.angle_min = angleMin(config_);
  scan.angle_increment = increment(config_);
  scan.time_increment = config_.timeIncrement();
  scan.range_min = config_.range_min_m;
  scan.range_max = config_.range_max_m;

  MovingScene scene(snapshots);
  for (std::size_t i = 0; i < config_.beams; ++i) {
    const Time beam_time = scan.beamTime(i);
    const Spot spot =
        lookThroughSpot(scene.casterAt(beam_time), scene.sensorAt(beam_time), spots_[i], config_);
    double range = spot.axis.range;
    BeamTruth truth;
    if (spot.axis.found()) truth.label = spot.axis.label;
    if (spot.straddles(config_.mixed_gap_m)) {
      advanceMixing();
      truth.mixed = mixing_.on;
      if (truth.mixed) {
        truth.mixed_near = spot.nearest.label;
        truth.mixed_far = spot.farthest.label;
        range = spot.nearest.range + mixing_.share * (spot.farthest.range - spot.nearest.range);
      }
    }
    const double measured = noisy(range);
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const double reported = measured < config_.range_min_m   ? -kInfinity
                            : measured > config_.range_max_m ? kInfinity
                                                             : measured;
    scan.ranges.push_back(static_cast<float>(reported));
    result.truth.push_back(truth);
  }
  return result;
}

}  // namespace tccm::simulation
