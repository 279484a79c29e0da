#include "scan/body_filter.h"

#include <algorithm>
#include <cmath>

#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

/// Squared distance from p to the ray's part up to length.
double squaredDistance(const Ray& ray, double length, const Vector3& p) {
  const double along = std::clamp((p - ray.origin).dot(ray.direction), 0.0, length);
  return (ray.at(along) - p).squaredNorm();
}

}  // namespace

void BodyFilter::Config::describe(ParameterTable& table) {
  table.add("self_filter_range_tolerance_m", &range_tolerance_m, "m", {0.0, 1.0},
            "points on a beam that met the body are its own so far before and behind it: five "
            "times the range noise");
  table.add("self_filter_grazing_m", &grazing_m, "m", {0.0, 1.0},
            "a beam passing the body nearer than this grazes it; every millimetre hides real "
            "obstacles beside the hand");
  table.add("self_filter_shadow_depth_m", &shadow_depth_m, "m", {0.0, 100.0},
            "so far behind a grazed edge points count as false");
}

BodyFilter::BodyFilter(const Config& config) : config_(validated(config)) {}

void BodyFilter::apply(const std::vector<BodySample>& samples, AssembledScan& scan) const {
  if (samples.empty()) return;
  std::size_t nearest = 0;
  for (Beam& beam : scan.beams) {
    const auto gap = [&](std::size_t k) { return std::chrono::abs(samples[k].stamp - beam.stamp); };
    while (nearest + 1 < samples.size() && gap(nearest + 1) <= gap(nearest)) ++nearest;
    if (beam.kind == BeamKind::kReturn) beam.kind = classify(beam, samples[nearest].body);
  }
}

BeamKind BodyFilter::classify(const Beam& beam, const Body& body) const {
  const Vector3 sight = beam.p_fixed - beam.viewpoint;
  const double range = sight.norm();
  const Ray ray{beam.viewpoint, sight / range};
  const double tolerance = config_.range_tolerance_m;
  BeamKind kind = BeamKind::kReturn;
  for (std::size_t i = 0; i < body.shapes.size(); ++i) {
    const Shape& shape = body.shapes[i];
    const Pose& pose = body.poses[i];
    const double padding = body.paddings_m[i];
    const double far = boundingRadius(shape) + std::max(padding, 2.0 * config_.grazing_m);
    if (squaredDistance(ray, range + tolerance, pose.translation()) > far * far) continue;
    const Pose T_shape_fixed = pose.inverse();
    if (distance(shape, T_shape_fixed * beam.p_fixed) <= padding) return BeamKind::kSelf;
    if (distance(shape, T_shape_fixed * beam.viewpoint) == 0.0) continue;
    const Ray ray_in_shape = transformed(ray, T_shape_fixed);
    const auto own = intersect(expanded(shape, {1.0, padding}), ray_in_shape);
    if (own && range >= own->enter - tolerance && range <= own->leave + tolerance) {
      return BeamKind::kSelf;
    }
    const auto span = intersect(expanded(shape, {1.0, config_.grazing_m}), ray_in_shape);
    if (span && range >= span->enter && range <= span->leave + config_.shadow_depth_m) {
      kind = BeamKind::kShadow;
    }
  }
  return kind;
}

}  // namespace tccm
