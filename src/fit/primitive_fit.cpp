#include "fit/primitive_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "config/parameter_table.h"
#include "fit/convex_hull.h"
#include "fit/directions.h"
#include "fit/enclosing.h"
#include "fit/mesh_partition.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using Points = std::vector<Vector3>;

void requireSound(const Mesh& mesh, const std::string& owner) {
  constexpr double kFarthest = 1e3;  // [m]; beyond it is a slip of units
  if (mesh.triangles.empty()) throw ConfigError(owner + ": the mesh is empty");
  for (const Vector3& p : mesh.vertices) {
    if (!p.allFinite()) throw ConfigError(owner + ": the mesh has a vertex that is not finite");
    if (p.cwiseAbs().maxCoeff() > kFarthest) {
      throw ConfigError(owner + ": the mesh has a vertex beyond 1000 m");
    }
  }
  for (const Mesh::Triangle& triangle : mesh.triangles) {
    if (*std::max_element(triangle.begin(), triangle.end()) < mesh.vertices.size()) continue;
    throw ConfigError(owner + ": the mesh has a triangle of a vertex that it has not");
  }
}

/// How far the shape reaches from its centre along a direction in its own frame [m].
double reach(const Shape& shape, const Vector3& n) {
  if (const auto* box = std::get_if<Box>(&shape)) return n.cwiseAbs().dot(box->half_extents);
  if (const auto* c = std::get_if<Cylinder>(&shape)) {
    return c->radius * std::hypot(n.x(), n.y()) + c->half_length * std::abs(n.z());
  }
  if (const auto* c = std::get_if<Capsule>(&shape)) {
    return c->radius + c->half_length * std::abs(n.z());
  }
  return std::get<Sphere>(shape).radius;
}

/// The furthest that a point of the primitive is from the points' hull, which lies inside: the
/// largest difference of how far both reach along a direction. Tried for an even spread of
/// directions, then around the best.
double overhang(const PlacedShape& primitive, const Points& points) {
  static const std::vector<Vector3> kSpread = hemisphereDirections(400);
  const Points hull = convexHull(points).surface.vertices;
  const Eigen::Map<const Matrix3X> vertices(hull.front().data(), 3,
                                            static_cast<Eigen::Index>(hull.size()));
  Vector3 best = Vector3::UnitZ();
  double most = 0.0;
  const auto tryDirection = [&](const Vector3& n) {
    const double own = n.dot(primitive.pose.translation()) +
                       reach(primitive.shape, primitive.pose.linear().transpose() * n);
    const double beyond = own - (n.transpose() * vertices).maxCoeff();
    if (beyond <= most) return;
    most = beyond;
    best = n;
  };
  for (const Vector3& n : kSpread) {
    tryDirection(n);
    tryDirection(-n);
  }
  for (double step = 0.05; step > 1e-3; step *= 0.7) {
    const Eigen::Matrix3d axes = axesAbout(best);
    for (int i = 0; i < 6; ++i) {
      const double angle = i * M_PI / 3.0;
      const Vector3 aside(std::cos(angle) * step, std::sin(angle) * step, 1.0);
      tryDirection((axes * aside).normalized());
    }
  }
  return most;
}

PrimitiveFit fitted(const MeshPartition& partition, double margin_m) {
  PrimitiveFit fit;
  for (const MeshPart& part : partition.parts) {
    PlacedShape primitive = smallestEnclosing(part.vertices());
    primitive.shape = expanded(primitive.shape, {1.0, margin_m});
    fit.overhang_m = std::max(fit.overhang_m, overhang(primitive, part.vertices()));
    fit.primitives.push_back(primitive);
  }
  return fit;
}

double totalVolume(const PrimitiveFit& fit) {
  double sum = 0.0;
  for (const PlacedShape& primitive : fit.primitives) sum += volume(primitive.shape);
  return sum;
}

}  // namespace

void PrimitiveFitConfig::describe(ParameterTable& table) {
  table.add("fit_primitives_max", &primitives_max, "", {1, 16}, "primitives for one mesh");
  table.add("fit_split_gain", &split_gain, "", {0.0, 0.9},
            "a further primitive has to better the fit by this share");
}

void PrimitiveFitConfig::validate() const { requireInRange("fit_margin_m", margin_m, 0.0, 0.1); }

PrimitiveFit fitPrimitives(const Mesh& mesh, const PrimitiveFitConfig& config,
                           const std::string& owner) {
  static_cast<void>(validated(config));
  requireSound(mesh, owner);
  PrimitiveFit best;
  double least = std::numeric_limits<double>::infinity();
  double extent = 0.0;
  for (const MeshPartition& partition :
       partitions(mesh, static_cast<std::size_t>(config.primitives_max))) {
    const PrimitiveFit fit = fitted(partition, config.margin_m);
    if (extent == 0.0) extent = boundingRadius(fit.primitives.front().shape);
    const auto further = static_cast<double>(fit.primitives.size() - 1);
    const double handicap = std::pow(1.0 - config.split_gain, -further);
    // A little for what even the best primitive reaches beyond, lest it decides alone.
    const double overhang_share = fit.overhang_m / extent + 0.01;
    const double score = totalVolume(fit) * std::cbrt(overhang_share) * handicap;
    if (score >= least) continue;
    least = score;
    best = fit;
  }
  for (const PlacedShape& primitive : best.primitives) tccm::validate(primitive.shape, owner);
  best.hull_volume_m3 = convexHull(mesh.vertices).volume_m3;
  return best;
}

}  // namespace tccm
