#include "simulation/depth_camera.h"

#include <algorithm>
#include <cmath>

#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// At a depth of 1, of each column or row.
std::vector<float> slopes(std::size_t count, double centre, double focal_px) {
  std::vector<float> slopes;
  for (std::size_t i = 0; i < count; ++i) {
    slopes.push_back(static_cast<float>((static_cast<double>(i) - centre) / focal_px));
  }
  return slopes;
}

float square(float x) { return x * x; }

}  // namespace

void DepthCamera::Config::validate() const {
  requireInRange("width", static_cast<double>(pinhole.width), 2.0, 4096.0);
  requireInRange("height", static_cast<double>(pinhole.height), 2.0, 4096.0);
  requireInRange("focal_px", pinhole.focal_px, 10.0, 1e5);
  requireInRange("period_s", period_s, 1e-3, 10.0);
  requireInRange("depth_min_m", depth_min_m, 0.01, depth_max_m);
  requireInRange("depth_max_m", depth_max_m, 0.01, 1e3);
  requireInRange("noise_m", noise_m, 0.0, 1.0);
  requireInRange("noise_per_m2", noise_per_m2, 0.0, 1.0);
  requireInRange("noise_from_m", noise_from_m, 0.0, 10.0);
  requireInRange("noise_slant", noise_slant, 0.0, 1.0);
  requireInRange("grazing_deg", grazing_deg, 1.0, 90.0);
  requireInRange("mixed_share", mixed_share, 0.0, 1.0);
  requireInRange("mixed_persistence", mixed_persistence, 0.0, 1.0);
  requireInRange("hole_share", hole_share, 0.0, 1.0);
  requireInRange("edge_gap_m", edge_gap_m, 0.0, depth_max_m);
  requireInRange("outline_share", outline_share, 0.0, 1.0);
}

DepthCamera::DepthCamera(const Config& config, std::uint64_t seed)
    : config_((config.validate(), config)),
      image_(config.pinhole),
      random_(seed),
      across_(slopes(config.pinhole.width, config.pinhole.centreColumn(), config.pinhole.focal_px)),
      down_(slopes(config.pinhole.height, config.pinhole.centreRow(), config.pinhole.focal_px)),
      least_facing_squared_(
          square(static_cast<float>(std::cos(config.grazing_deg * M_PI / 180.0)))),
      depth_min_(static_cast<float>(config.depth_min_m)),
      depth_max_(static_cast<float>(config.depth_max_m)) {}

SimulatedCloud DepthCamera::measure(const Snapshot& snapshot) {
  draw(snapshot);
  const Pinhole& camera = config_.pinhole;
  SimulatedCloud result;
  result.cloud.stamp = snapshot.stamp;
  result.cloud.width = camera.width;
  result.cloud.height = camera.height;
  result.cloud.points.resize(camera.width * camera.height);
  result.truth.resize(camera.width * camera.height);
  for (std::size_t row = 0; row < camera.height; ++row) {
    for (std::size_t column = 0; column < camera.width; ++column) {
      measure(row, column, snapshot.labels, result);
    }
  }
  return result;
}

void DepthCamera::draw(const Snapshot& snapshot) {
  image_.clear();
  const Pose T_camera_fixed = snapshot.T_fixed_sensor.inverse();
  const Body& targets = snapshot.targets;
  for (std::size_t i = 0; i < targets.shapes.size(); ++i) {
    image_.draw(static_cast<std::uint32_t>(i), targets.shapes[i],
                T_camera_fixed * targets.poses[i]);
  }
}

void DepthCamera::measure(std::size_t row, std::size_t column,
                          const std::vector<std::size_t>& labels, SimulatedCloud& result) {
  const std::size_t pixel = row * config_.pinhole.width + column;
  Eigen::Vector3f& point = result.cloud.points[pixel];
  point.setConstant(kNaN);
  const std::size_t shown = shownIn(row, column);
  const std::uint32_t target = image_.targets()[shown];
  if (target == DepthImage::kNothing) return;
  PointTruth& truth = result.truth[pixel];
  truth.label = static_cast<std::uint32_t>(labels[target]);
  const float facing = image_.facings()[shown];
  const float length_squared = 1.0F + square(across_[column]) + square(down_[row]);
  if (facing * facing < least_facing_squared_ * length_squared) return;

  float depth = 1.0F / image_.inverseDepths()[shown];
  const float deviation = deviationAt(depth, facing, length_squared);
  if (shown == pixel) {
    if (const auto across = acrossEdge(row, column)) {
      if (random_.uniform() < config_.hole_share) return;
      depth = mix(*across, depth, labels, truth);
    }
  }
  const float measured = depth + deviation * normal_(random_);
  if (measured < depth_min_ || measured > depth_max_) return;
  point = {measured * across_[column], measured * down_[row], measured};
}

/// The pixel whose surface a pixel shows: its own, or one beside it beyond an outline.
std::size_t DepthCamera::shownIn(std::size_t row, std::size_t column) {
  const std::size_t width = config_.pinhole.width, pixel = row * width + column;
  const std::uint32_t target = image_.targets()[pixel];
  const auto shows = [&](bool exists, std::size_t neighbour) {
    return exists && image_.targets()[neighbour] != target &&
           random_.uniform() < config_.outline_share;
  };
  if (shows(column > 0, pixel - 1)) return pixel - 1;
  if (shows(column + 1 < width, pixel + 1)) return pixel + 1;
  if (shows(row > 0, pixel - width)) return pixel - width;
  if (shows(row + 1 < config_.pinhole.height, pixel + width)) return pixel + width;
  return pixel;
}

/// The neighbour with the other surface that a pixel straddles.
std::optional<std::size_t> DepthCamera::acrossEdge(std::size_t row, std::size_t column) const {
  const std::size_t width = config_.pinhole.width, pixel = row * width + column;
  const auto differs = [&](bool exists, std::size_t neighbour) {
    return exists && image_.targets()[neighbour] != image_.targets()[pixel];
  };
  const bool is_right = differs(column + 1 < width, pixel + 1);
  if (!is_right && !differs(row + 1 < config_.pinhole.height, pixel + width)) return std::nullopt;
  const std::size_t other = is_right ? pixel + 1 : pixel + width;
  if (image_.targets()[other] == DepthImage::kNothing) return std::nullopt;
  const float apart = 1.0F / image_.inverseDepths()[other] - 1.0F / image_.inverseDepths()[pixel];
  if (std::abs(apart) <= static_cast<float>(config_.edge_gap_m)) return std::nullopt;
  return other;
}

/// The depth that is measured beside another surface.
float DepthCamera::mix(std::size_t neighbour, float depth, const std::vector<std::size_t>& labels,
                       PointTruth& truth) {
  mixing_.advance(config_.mixed_share, config_.mixed_persistence,
                  [this] { return random_.uniform(); });
  if (!mixing_.on) return depth;
  truth.mixed_with = static_cast<std::uint32_t>(labels[image_.targets()[neighbour]]);
  const float other = 1.0F / image_.inverseDepths()[neighbour];
  const float nearer = std::min(depth, other);
  // Along an edge that crosses the rows slantwise each pixel is covered by another share.
  const auto far_share = static_cast<float>(0.05 + 0.9 * random_.uniform());
  return nearer + far_share * (std::max(depth, other) - nearer);
}

/// One standard deviation [m].
float DepthCamera::deviationAt(float depth, float facing, float length_squared) const {
  const float level = static_cast<float>(config_.noise_m) +
                      static_cast<float>(config_.noise_per_m2) *
                          square(depth - static_cast<float>(config_.noise_from_m));
  constexpr float kSteep =
      0.25F;  // below a slant of 60 degrees it adds less than half a millimetre
  if (square(facing) > kSteep * length_squared) return level;
  constexpr auto kRight = static_cast<float>(M_PI_2);
  const float slant = std::acos(std::min(1.0F, facing / std::sqrt(length_squared)));
  return level + static_cast<float>(config_.noise_slant) * square(slant / (kRight - slant)) /
                     std::sqrt(depth);
}

}  // namespace tccm::simulation
