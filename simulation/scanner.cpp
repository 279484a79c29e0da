#include "simulation/scanner.h"

#include <array>
#include <cmath>
#include <limits>

#include "simulation/ray_caster.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

constexpr double kDegree = M_PI / 180.0;

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
      mixing_.advance(config_.mixed_share, config_.mixed_persistence,
                      [this] { return uniform_(random_); });
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
