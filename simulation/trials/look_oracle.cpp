#include "simulation/trials/look_oracle.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "simulation/robot/dual_arm.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {

void LookOracle::Config::validate() const { requireInRange("angle_rad", angle_rad, 1e-4, 0.5); }

LookOracle::LookOracle(const Config& config, std::shared_ptr<const RobotModel> model)
    : config_((config.validate(), config)),
      model_(std::move(model)),
      sensor_(linkIndex(*model_, "laser_link")) {}

void LookOracle::add(const RobotSample& sample) {
  T_fixed_sensor_.add(sample.stamp, sample.link_poses[sensor_]);
  Frame frame{sample.stamp, {}};
  for (const LinkShape& shape : model_->shapes()) {
    frame.body.shapes.push_back(shape.shape);
    frame.body.poses.push_back(sample.link_poses[shape.link] * shape.T_link_shape);
  }
  frames_.push_back(std::move(frame));
}

void LookOracle::add(const LaserScan& scan, Time mapped) {
  scans_.push_back({scan.stamp, scan.angle_min, scan.angle_increment, scan.time_increment,
                    scan.ranges.size(), mapped});
}

std::optional<LookOracle::Look> LookOracle::firstLook(Time after, const Vector3& p_fixed) const {
  const auto lastBeam = [](const Scan& scan) {
    return scan.stamp + static_cast<Duration::rep>(scan.beams - 1) * scan.time_increment;
  };
  auto scan = std::partition_point(scans_.begin(), scans_.end(),
                                   [&](const Scan& s) { return lastBeam(s) <= after; });
  for (; scan != scans_.end(); ++scan) {
    const std::optional<Time> beam = beamAt(*scan, p_fixed);
    if (beam && *beam > after && !robotStops(*beam, p_fixed)) return Look{*beam, scan->mapped};
  }
  return std::nullopt;
}

/// Of the beam that comes nearest to the place, where it comes near enough.
std::optional<Time> LookOracle::beamAt(const Scan& scan, const Vector3& p_fixed) const {
  const auto nearest = [&](double azimuth) {
    const double index = std::round((azimuth - scan.angle_min) / scan.angle_increment);
    return static_cast<std::size_t>(std::clamp(index, 0.0, static_cast<double>(scan.beams - 1)));
  };
  const auto timeOf = [&](std::size_t beam) {
    return scan.stamp + static_cast<Duration::rep>(beam) * scan.time_increment;
  };
  const std::optional<double> about = azimuthAt(timeOf(scan.beams / 2), p_fixed);
  if (!about) return std::nullopt;
  const std::optional<double> azimuth = azimuthAt(timeOf(nearest(*about)), p_fixed);
  if (!azimuth || !passes(scan, nearest(*azimuth), p_fixed)) return std::nullopt;
  return timeOf(nearest(*azimuth));
}

std::optional<double> LookOracle::azimuthAt(Time stamp, const Vector3& p_fixed) const {
  const std::optional<Pose> T_fixed_sensor = T_fixed_sensor_.at(stamp);
  if (!T_fixed_sensor) return std::nullopt;
  const Vector3 p_sensor = T_fixed_sensor->inverse() * p_fixed;
  return std::atan2(p_sensor.y(), p_sensor.x());
}

bool LookOracle::passes(const Scan& scan, std::size_t beam, const Vector3& p_fixed) const {
  const std::optional<Pose> T_fixed_sensor =
      T_fixed_sensor_.at(scan.stamp + static_cast<Duration::rep>(beam) * scan.time_increment);
  if (!T_fixed_sensor) return false;
  const Vector3 p_sensor = T_fixed_sensor->inverse() * p_fixed;
  const double angle = scan.angle_min + static_cast<double>(beam) * scan.angle_increment;
  const Vector3 direction(std::cos(angle), std::sin(angle), 0.0);
  return p_sensor.normalized().dot(direction) >= std::cos(config_.angle_rad);
}

/// As it was at the sample nearest to that instant. Its own housing does not stop the laser.
bool LookOracle::robotStops(Time stamp, const Vector3& p_fixed) const {
  const auto after = std::partition_point(frames_.begin(), frames_.end(),
                                          [stamp](const Frame& f) { return f.stamp < stamp; });
  const Frame& frame = after == frames_.end() ? frames_.back() : *after;
  const Vector3 origin = T_fixed_sensor_.at(stamp)->translation();
  const Vector3 way = p_fixed - origin;
  const Ray ray{origin, way.normalized()};
  for (std::size_t i = 0; i < frame.body.shapes.size(); ++i) {
    const auto span =
        intersect(frame.body.shapes[i], transformed(ray, frame.body.poses[i].inverse()));
    if (span && span->enter > 0.0 && span->enter < way.norm()) return true;
  }
  return false;
}

}  // namespace tccm::simulation
