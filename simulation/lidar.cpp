#include "simulation/lidar.h"

#include <cmath>

#include "simulation/ray_caster.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

constexpr double kDegree = M_PI / 180.0;

}  // namespace

void Lidar::Config::validate() const {
  requireInRange("rows", static_cast<double>(rows), 2.0, 1024.0);
  requireInRange("columns", static_cast<double>(columns), 4.0, 1e5);
  requireInRange("period_s", period_s, 1e-3, 10.0);
  requireInRange("elevation_max_deg", elevation_max_deg, 0.1, 60.0);
  requireInRange("range_min_m", range_min_m, 0.0, range_max_m);
  requireInRange("range_max_m", range_max_m, 0.0, 1e3);
  requireInRange("noise_m", noise_m, 0.0, 1.0);
}

Duration Lidar::Config::turnDuration() const {
  return fromSeconds(period_s * static_cast<double>(columns - 1) / static_cast<double>(columns));
}

Lidar::Lidar(const Config& config, std::uint64_t seed)
    : config_((config.validate(), config)), random_(seed) {
  for (std::size_t i = 0; i < config.rows; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(config.rows - 1);
    const double elevation = (1.0 - 2.0 * share) * config.elevation_max_deg * kDegree;
    rows_.emplace_back(std::cos(elevation), 0.0, std::sin(elevation));
  }
}

SimulatedCloud Lidar::measure(Time stamp, const std::vector<Snapshot>& snapshots) {
  SimulatedCloud result;
  Cloud& cloud = result.cloud;
  cloud.stamp = stamp;
  cloud.width = config_.columns;
  cloud.height = config_.rows;
  cloud.points.resize(cloud.width * cloud.height,
                      Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  cloud.offsets_s.resize(cloud.points.size());
  result.truth.resize(cloud.points.size());
  MovingScene scene(snapshots);
  bool is_first = true;
  for (std::size_t column = 0; column < cloud.width; ++column) {
    const auto offset_s = static_cast<float>(config_.period_s * static_cast<double>(column) /
                                             static_cast<double>(cloud.width));
    if (!measureColumn(column, offset_s, scene, result)) continue;
    if (is_first) cloud.first_offset_s = static_cast<double>(offset_s);
    is_first = false;
    cloud.last_offset_s = static_cast<double>(offset_s);
  }
  return result;
}

bool Lidar::measureColumn(std::size_t column, float offset_s, MovingScene& scene,
                          SimulatedCloud& result) {
  const Time time = result.cloud.stamp + fromSeconds(static_cast<double>(offset_s));
  const Pose T_fixed_sensor = scene.sensorAt(time);
  RayCaster& caster = scene.casterAt(time);
  const double turned =
      2.0 * M_PI * static_cast<double>(column) / static_cast<double>(config_.columns);
  const Eigen::Matrix3d azimuth =
      Eigen::AngleAxisd(M_PI - turned, Vector3::UnitZ()).toRotationMatrix();
  const Eigen::Matrix3d R_fixed_column = T_fixed_sensor.linear() * azimuth;
  caster.aim({T_fixed_sensor.translation(), R_fixed_column.col(0)},
             1.001 * config_.elevation_max_deg * kDegree);
  bool any = false;
  for (std::size_t row = 0; row < config_.rows; ++row) {
    const std::size_t i = row * config_.columns + column;
    result.cloud.offsets_s[i] = offset_s;
    const Hit hit = caster.cast({T_fixed_sensor.translation(), R_fixed_column * rows_[row]},
                                1.1 * config_.range_max_m);
    if (!hit.found()) continue;
    result.truth[i].label = static_cast<std::uint32_t>(hit.label);
    const double range = hit.range + config_.noise_m * static_cast<double>(normal_(random_));
    if (range < config_.range_min_m || range > config_.range_max_m) continue;
    result.cloud.points[i] = (range * (azimuth * rows_[row])).cast<float>();
    any = true;
  }
  return any;
}

}  // namespace tccm::simulation
