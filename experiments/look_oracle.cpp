#include "experiments/look_oracle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/distance.h"
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
  Frame frame{sample.stamp, {}, sample.link_poses};
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

void LookOracle::add(const CloudSensors::Config& camera, Time stamp, Time mapped) {
  camera_ = camera.camera;
  camera_link_ = linkIndex(*model_, camera.camera_mount.link);
  T_link_camera_ = camera.camera_mount.T_link_sensor;
  pictures_.push_back({stamp, mapped});
}

std::optional<LookOracle::Look> LookOracle::firstLook(Time after, const Vector3& p_fixed) const {
  const std::optional<Look> scan = firstScan(after, p_fixed);
  const std::optional<Look> picture = firstPicture(after, p_fixed);
  if (!scan || !picture) return scan ? scan : picture;
  return picture->mapped < scan->mapped ? picture : scan;
}

std::optional<LookOracle::Look> LookOracle::firstPicture(Time after, const Vector3& p_fixed) const {
  auto picture = std::partition_point(pictures_.begin(), pictures_.end(),
                                      [after](const Picture& p) { return p.stamp <= after; });
  for (; picture != pictures_.end(); ++picture) {
    if (shows(*picture, p_fixed)) return Look{picture->stamp, picture->mapped};
  }
  return std::nullopt;
}

/// When a frame is mapped the robot may not have been heard of at its end yet: the camera's pose is
/// asked for when all is known.
std::optional<Pose> LookOracle::cameraAt(Time stamp) const {
  const auto after = std::partition_point(frames_.begin(), frames_.end(),
                                          [stamp](const Frame& f) { return f.stamp < stamp; });
  PosePath T_fixed_camera;
  for (auto frame = after == frames_.begin() ? after : after - 1;
       frame != frames_.end() && frame <= after; ++frame) {
    T_fixed_camera.add(frame->stamp, frame->link_poses[camera_link_] * T_link_camera_);
  }
  return T_fixed_camera.at(stamp);
}

bool LookOracle::shows(const Picture& picture, const Vector3& p_fixed) const {
  const std::optional<Pose> T_fixed_camera = cameraAt(picture.stamp);
  if (!T_fixed_camera) return false;
  const Vector3 p_camera = T_fixed_camera->inverse() * p_fixed;
  if (p_camera.z() < camera_.depth_min_m || p_camera.z() > camera_.depth_max_m) return false;
  const Pinhole& pinhole = camera_.pinhole;
  const double right = pinhole.focal_px * std::abs(p_camera.x()) / p_camera.z();
  const double down = pinhole.focal_px * std::abs(p_camera.y()) / p_camera.z();
  if (right > pinhole.centreColumn() || down > pinhole.centreRow()) return false;
  const Vector3 way = p_fixed - T_fixed_camera->translation();
  return !robotStops(picture.stamp, {T_fixed_camera->translation(), way.normalized()}, way.norm());
}

std::optional<LookOracle::Look> LookOracle::firstScan(Time after, const Vector3& p_fixed) const {
  const auto lastBeam = [](const Scan& scan) {
    return scan.stamp + static_cast<Duration::rep>(scan.beams - 1) * scan.time_increment;
  };
  auto scan = std::partition_point(scans_.begin(), scans_.end(),
                                   [&](const Scan& s) { return lastBeam(s) <= after; });
  for (; scan != scans_.end(); ++scan) {
    const std::optional<Time> beam = beamOf(*scan, after, p_fixed);
    if (beam) return Look{*beam, scan->mapped};
  }
  return std::nullopt;
}

/// When the first beam of a scan is measured that looks at the place.
std::optional<Time> LookOracle::beamOf(const Scan& scan, Time after, const Vector3& p_fixed) const {
  const auto timeOf = [&](int beam) { return scan.stamp + beam * scan.time_increment; };
  const int last = static_cast<int>(scan.beams) - 1;
  int middle = last / 2;
  for (int i = 0; i < 2; ++i) {
    const std::optional<double> azimuth = azimuthAt(timeOf(middle), p_fixed);
    if (!azimuth) return std::nullopt;
    const double beam = std::round((*azimuth - scan.angle_min) / scan.angle_increment);
    middle = static_cast<int>(std::clamp(beam, 0.0, static_cast<double>(last)));
  }
  const int within = static_cast<int>(std::ceil(config_.angle_rad / scan.angle_increment));
  for (int beam = std::max(0, middle - within); beam <= std::min(last, middle + within); ++beam) {
    const double angle = scan.angle_min + beam * scan.angle_increment;
    if (timeOf(beam) > after && looks(timeOf(beam), angle, p_fixed)) return timeOf(beam);
  }
  return std::nullopt;
}

std::optional<double> LookOracle::azimuthAt(Time stamp, const Vector3& p_fixed) const {
  const std::optional<Pose> T_fixed_sensor = T_fixed_sensor_.at(stamp);
  if (!T_fixed_sensor) return std::nullopt;
  const Vector3 p_sensor = T_fixed_sensor->inverse() * p_fixed;
  return std::atan2(p_sensor.y(), p_sensor.x());
}

bool LookOracle::looks(Time stamp, double angle, const Vector3& p_fixed) const {
  const std::optional<Pose> T_fixed_sensor = T_fixed_sensor_.at(stamp);
  if (!T_fixed_sensor) return false;
  const Vector3 way = p_fixed - T_fixed_sensor->translation();
  const Ray ray{T_fixed_sensor->translation(),
                T_fixed_sensor->linear() * Vector3(std::cos(angle), std::sin(angle), 0.0)};
  return way.normalized().dot(ray.direction) >= std::cos(config_.angle_rad) &&
         !robotStops(stamp, ray, way.norm());
}

const Body& LookOracle::bodyAt(Time stamp) const {
  const auto after = std::partition_point(frames_.begin(), frames_.end(),
                                          [stamp](const Frame& f) { return f.stamp < stamp; });
  return after == frames_.end() ? frames_.back().body : after->body;
}

double LookOracle::distanceToRobot(Time stamp, const Vector3& p_fixed) const {
  const Body& body = bodyAt(stamp);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < body.shapes.size(); ++i) {
    least = std::min(least, distance(body.shapes[i], body.poses[i].inverse() * p_fixed));
  }
  return least;
}

Vector3 LookOracle::furthest(Time stamp, std::size_t shape, const Vector3& direction) const {
  const Body& body = bodyAt(stamp);
  return tccm::furthest(body.shapes[shape], body.poses[shape], direction);
}

double LookOracle::distanceTo(Time stamp, std::size_t shape, const Vector3& p_fixed) const {
  const Body& body = bodyAt(stamp);
  return distance(body.shapes[shape], body.poses[shape].inverse() * p_fixed);
}

/// Its own housing does not stop the laser.
bool LookOracle::robotStops(Time stamp, const Ray& ray, double before_m) const {
  const Body& body = bodyAt(stamp);
  for (std::size_t i = 0; i < body.shapes.size(); ++i) {
    const auto span = intersect(body.shapes[i], transformed(ray, body.poses[i].inverse()));
    if (span && span->enter > 0.0 && span->enter < before_m) return true;
  }
  return false;
}

}  // namespace tccm::simulation
