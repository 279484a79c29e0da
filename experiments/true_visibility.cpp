#include "experiments/true_visibility.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "geometry/ray.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

/// Shapes, and where each can be seen from the viewpoint.
class Targets {
 public:
  Targets(const Body& body, const Vector3& viewpoint) {
    for (std::size_t i = 0; i < body.shapes.size(); ++i) {
      const Vector3 way = body.poses[i].translation() - viewpoint;
      if (distance(body.shapes[i], body.poses[i].inverse() * viewpoint) == 0.0) continue;
      const double radius = boundingRadius(body.shapes[i]);
      const double angle = way.norm() > radius ? std::asin(radius / way.norm()) : M_PI;
      targets_.push_back({body.shapes[i], body.poses[i].inverse(), way.normalized(), angle, i});
    }
  }

  struct Hit {
    double range;
    std::size_t shape;
  };
  [[nodiscard]] std::optional<Hit> nearest(const Ray& ray) const {
    std::optional<Hit> nearest;
    for (std::size_t i = 0; i < targets_.size(); ++i) {
      const Target& target = targets_[i];
      if (target.towards.dot(ray.direction) < std::cos(target.angle)) continue;
      const auto span = intersect(target.shape, transformed(ray, target.T_shape_fixed));
      if (span && span->enter > 0.0 && (!nearest || span->enter < nearest->range)) {
        nearest = Hit{span->enter, target.shape_index};
      }
    }
    return nearest;
  }

  /// Elevations that any shape can show at [rad].
  [[nodiscard]] std::pair<double, double> elevations() const {
    std::pair<double, double> range(M_PI_2, -M_PI_2);
    for (const Target& target : targets_) {
      const double middle = std::asin(std::clamp(target.towards.z(), -1.0, 1.0));
      range.first = std::min(range.first, middle - target.angle);
      range.second = std::max(range.second, middle + target.angle);
    }
    return {std::max(range.first, -M_PI_2), std::min(range.second, M_PI_2)};
  }

 private:
  struct Target {
    Shape shape;
    Pose T_shape_fixed;
    Vector3 towards;
    double angle;  ///< half of what its bounding sphere takes up [rad]
    std::size_t shape_index;
  };
  std::vector<Target> targets_;
};

/// What the rays on one link found, in solid angles.
struct Sum {
  std::uint32_t link;
  double drawn = 0.0;
  double hidden = 0.0;
  double in_range = 0.0;
};

std::vector<Sum> emptySums(const std::vector<std::uint32_t>& links) {
  std::vector<Sum> sums;
  for (const std::uint32_t link : links) {
    const bool known =
        std::any_of(sums.begin(), sums.end(), [link](const Sum& sum) { return sum.link == link; });
    if (!known) sums.push_back({link});
  }
  return sums;
}

Vector3 directionOf(double azimuth, double elevation) {
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
          std::sin(elevation)};
}

}  // namespace

void TrueVisibility::Config::validate() const {
  requireInRange("resolution_rad", resolution_rad, 1e-4, 0.1);
  requireInRange("margin_m", margin_m, 0.0, 1.0);
}

TrueVisibility::TrueVisibility(const Config& config) : config_((config.validate(), config)) {}

/// A beam at angle a of a laser tilted by t goes to (cos t cos a, sin a, -sin t cos a).
bool TrueVisibility::isInRange(const Vector3& direction) const {
  const double tilt = std::atan2(-direction.z(), direction.x());
  return std::abs(tilt - config_.tilt.mean_rad) <= config_.tilt.amplitude_rad;
}

std::vector<TrueLinkVisibility> TrueVisibility::find(
    const Vector3& viewpoint, const Body& links, const std::vector<std::uint32_t>& link_of_shape,
    const Body& things) const {
  const Targets robot(links, viewpoint);
  const Targets obstacles(things, viewpoint);
  std::vector<Sum> sums = emptySums(link_of_shape);
  const auto [lowest, highest] = robot.elevations();
  const int rows = static_cast<int>((highest - lowest) / config_.resolution_rad) + 1;
  for (int row = 0; row < rows; ++row) {
    const double e = lowest + row * config_.resolution_rad;
    const double step = config_.resolution_rad / std::max(0.01, std::cos(e));
    const int columns = static_cast<int>(2.0 * M_PI / step) + 1;
    for (int column = 0; column < columns; ++column) {
      const Ray ray{viewpoint, directionOf(column * step - M_PI, e)};
      const auto hit = robot.nearest(ray);
      if (!hit) continue;
      const std::uint32_t link = link_of_shape[hit->shape];
      Sum& sum =
          *std::find_if(sums.begin(), sums.end(), [link](const Sum& s) { return s.link == link; });
      const auto obstacle = obstacles.nearest(ray);
      const double solid_angle = config_.resolution_rad * step * std::cos(e);
      sum.drawn += solid_angle;
      if (obstacle && obstacle->range < hit->range - config_.margin_m) sum.hidden += solid_angle;
      if (isInRange(ray.direction)) sum.in_range += solid_angle;
    }
  }
  std::vector<TrueLinkVisibility> result;
  for (const Sum& sum : sums) {
    const double whole = sum.drawn > 0.0 ? sum.drawn : 1.0;
    result.push_back({sum.link, sum.drawn, 1.0 - sum.hidden / whole, sum.in_range / whole});
  }
  return result;
}

}  // namespace tccm::simulation
