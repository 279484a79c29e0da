#include "scan/scan_assembler.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/ray.h"

namespace tccm {
namespace {

double unknownFraction(const AssembledScan& scan) {
  const BeamCounts counts = scan.counts();
  const std::size_t unknown = counts[static_cast<std::size_t>(BeamKind::kUnknown)] +
                              counts[static_cast<std::size_t>(BeamKind::kTooClose)];
  return static_cast<double>(unknown) / static_cast<double>(scan.beams.size());
}

}  // namespace

/// Which of a body's shapes a beam may have to do with, for all of them at once: most beams pass by
/// most shapes.
class BodyFilter::Reach {
 public:
  void enclose(const Body& body, double grazing_m) {
    const auto count = static_cast<Eigen::Index>(body.shapes.size());
    for (Eigen::ArrayXd& centre : centres_) centre.resize(count);
    far_squared_.resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        centres_[axis](i) = body.poses[k].translation()[static_cast<Eigen::Index>(axis)];
      }
      const double far =
          boundingRadius(body.shapes[k]) + std::max(body.paddings_m[k], 2.0 * grazing_m);
      far_squared_(i) = far * far;
    }
  }
  /// Looks along the ray's part up to length.
  void look(const Ray& ray, double length) {
    const Vector3 &o = ray.origin, &d = ray.direction;
    const auto& [x, y, z] = centres_;
    along_ =
        ((x - o.x()) * d.x() + ((y - o.y()) * d.y() + (z - o.z()) * d.z())).max(0.0).min(length);
    beyond_ = (o.x() + along_ * d.x() - x).square() +
              ((o.y() + along_ * d.y() - y).square() + (o.z() + along_ * d.z() - z).square()) -
              far_squared_;
  }
  [[nodiscard]] bool isNear(std::size_t shape) const {
    return !(beyond_(static_cast<Eigen::Index>(shape)) > 0.0);
  }

 private:
  std::array<Eigen::ArrayXd, 3> centres_;
  Eigen::ArrayXd far_squared_;
  Eigen::ArrayXd along_, beyond_;  ///< of the last look
};

void MixedPixelFilter::describe(ParameterTable& table) {
  table.add("mixed_pixel_separation_m", &separation_m, "m", {0.0, 10.0},
            "a point further than this from both its neighbours in the scan is a mixed pixel; 0: "
            "no filter");
}

void MixedPixelFilter::apply(AssembledScan& scan) const {
  if (separation_m == 0.0) return;
  bool near_previous = false;
  for (std::size_t i = 0; i < scan.beams.size(); ++i) {
    Beam& beam = scan.beams[i];
    // A neighbour that was just found to be a mixed pixel still measured a point: the test is
    // symmetric, and does not depend on the order of the beams.
    const bool near_next = i + 1 < scan.beams.size() && beam.measured() &&
                           scan.beams[i + 1].measured() &&
                           (scan.beams[i + 1].p_fixed - beam.p_fixed).norm() <= separation_m;
    if (beam.kind == BeamKind::kReturn && !near_previous && !near_next) {
      beam.kind = BeamKind::kMixedPixel;
    }
    near_previous = near_next;
  }
}

void BodyFilter::describe(ParameterTable& table) {
  table.add("self_filter_range_tolerance_m", &range_tolerance_m, "m", {0.0, 1.0},
            "points on a beam that met the body are its own so far before and behind it: five "
            "times the range noise");
  table.add("self_filter_grazing_m", &grazing_m, "m", {0.0, 1.0},
            "a beam passing the body nearer than this grazes it; every millimetre hides real "
            "obstacles beside the hand");
  table.add("self_filter_shadow_depth_m", &shadow_depth_m, "m", {0.0, 100.0},
            "so far behind a grazed edge points count as false");
}

void BodyFilter::apply(const std::vector<BodySample>& samples, AssembledScan& scan) const {
  scan.self_counts.clear();
  if (samples.empty()) return;
  scan.self_counts.resize(samples.front().body.shapes.size());
  thread_local Reach reach;  // reused
  reach.enclose(samples.front().body, grazing_m);
  std::size_t nearest = 0;
  for (Beam& beam : scan.beams) {
    const std::size_t before = nearest;
    const auto gap = [&](std::size_t k) { return std::chrono::abs(samples[k].stamp - beam.stamp); };
    while (nearest + 1 < samples.size() && gap(nearest + 1) <= gap(nearest)) ++nearest;
    if (nearest != before) reach.enclose(samples[nearest].body, grazing_m);
    if (beam.kind != BeamKind::kReturn) continue;
    beam.kind = classify(beam, samples[nearest].body, reach, scan.self_counts);
  }
}

BeamKind BodyFilter::classify(const Beam& beam, const Body& body, Reach& reach,
                              std::vector<std::size_t>& self_counts) const {
  const auto own = [&self_counts](std::size_t shape) {
    ++self_counts[shape];
    return BeamKind::kSelf;
  };
  const Vector3 sight = beam.p_fixed - beam.viewpoint;
  const double range = sight.norm();
  const Ray ray{beam.viewpoint, sight / range};
  BeamKind kind = BeamKind::kReturn;
  reach.look(ray, range + range_tolerance_m);
  for (std::size_t i = 0; i < body.shapes.size(); ++i) {
    if (!reach.isNear(i)) continue;
    const Shape& shape = body.shapes[i];
    const Pose& pose = body.poses[i];
    const double padding = body.paddings_m[i];
    const Pose T_shape_fixed = pose.inverse();
    if (distance(shape, T_shape_fixed * beam.p_fixed) <= padding) return own(i);
    if (distance(shape, T_shape_fixed * beam.viewpoint) == 0.0) continue;
    const Ray ray_in_shape = transformed(ray, T_shape_fixed);
    const auto met = intersect(expanded(shape, {1.0, padding}), ray_in_shape);
    if (met && range >= met->enter - range_tolerance_m && range <= met->leave + range_tolerance_m) {
      return own(i);
    }
    const auto span = intersect(expanded(shape, {1.0, grazing_m}), ray_in_shape);
    if (span && range >= span->enter && range <= span->leave + shadow_depth_m) {
      kind = BeamKind::kShadow;
    }
  }
  return kind;
}

void ScanAssembler::describe(ParameterTable& table) {
  table.add("scan_beams_max", &scan_beams_max, "beams", {1.0, 1e6}, "a scan with more is dropped");
  table.add("scan_unknown_fraction_max", &scan_unknown_fraction_max, "", {0.0, 1.0},
            "a scan with a larger share of beams that are NaN or too close is dropped: the sensor "
            "is blind");
  mixed_pixel.describe(table);
  body.describe(table);
}

std::string ScanAssembler::assemble(const LaserScan& scan, const PosePath& T_fixed_sensor,
                                    const std::vector<BodySample>& samples,
                                    AssembledScan& result) const {
  result.beams.clear();
  if (!defectOf(scan, scan_beams_max).empty()) return "malformed";
  if (!project(scan, T_fixed_sensor, result)) return "no_transform";
  if (unknownFraction(result) > scan_unknown_fraction_max) {
    result.beams.clear();
    return "blind";
  }
  mixed_pixel.apply(result);
  body.apply(samples, result);
  return {};
}

}  // namespace tccm
