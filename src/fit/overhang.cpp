#include "fit/overhang.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "fit/points.h"
#include "geometry/simplex.h"

namespace tccm {
namespace {

/// A convex hull that points are measured from.
class MeasuredHull {
 public:
  explicit MeasuredHull(const std::vector<Vector3>& points)
      : hull_(convexHull(points)),
        vertices_(hull_.surface.vertices.front().data(), 3,
                  static_cast<Eigen::Index>(hull_.surface.vertices.size())),
        middle_(vertices_.rowwise().mean()),
        nearest_(vertices_.col(0)) {}
  MeasuredHull(const MeasuredHull&) = delete;
  MeasuredHull& operator=(const MeasuredHull&) = delete;

  /// How far the farthest point of a ball is from the hull [m].
  double beyond(const Vector3& centre, double radius) {
    const double outside = distance(centre);
    if (outside > 0.0 || radius == 0.0) return radius + outside;
    return std::max(0.0, radius - depth(centre));
  }

 private:
  /// At most 5e-6 m too large, never too small; 0 inside (Gilbert, Johnson and Keerthi 1988).
  double distance(const Vector3& p) {
    constexpr double kTolerance = 5e-6;  // [m]
    constexpr double kTouching = 1e-9;   // [m]
    constexpr int kMostIterations = 100;
    Vector3 gap = p - nearest_;
    double least = gap.norm();
    double last = std::numeric_limits<double>::infinity();
    Simplex simplex;
    for (int i = 0; i < kMostIterations; ++i) {
      const double norm = gap.norm();
      if (!(norm > kTouching)) return 0.0;
      if (norm < least) {
        least = norm;
        nearest_ = p - gap;
      }
      if (!(norm < last)) break;  // nothing but rounding goes on
      if (i > 0) last = norm;
      const Vector3 farthest = p - furthest(gap);
      if (norm - gap.dot(farthest) / norm < kTolerance) break;
      simplex.add(farthest);
      gap = simplex.reduce();
      if (simplex.isFull()) return 0.0;
    }
    return least;
  }

  /// How far a point inside is from the hull's surface [m]; 0 where the hull is flat. The facets'
  /// planes alone do not tell: the direction of a sliver's is anything. How far the whole hull
  /// reaches along it bounds the depth all the same.
  double depth(const Vector3& p) {
    const std::vector<Vector3>& corners = hull_.surface.vertices;
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [a, b, c] : hull_.surface.triangles) {
      Vector3 normal = (corners[b] - corners[a]).cross(corners[c] - corners[a]);
      const double length = normal.norm();
      if (!(length > 0.0)) continue;
      normal /= normal.dot(corners[a] - middle_) < 0.0 ? -length : length;
      if (normal.dot(corners[a] - p) >= least) continue;
      least = std::min(least, normal.dot(furthest(normal) - p));
    }
    return std::isfinite(least) ? least : 0.0;
  }

  /// The hull's point furthest in a direction.
  Vector3 furthest(const Vector3& direction) {
    heights_.noalias() = direction.transpose() * vertices_;
    Eigen::Index highest = 0;
    heights_.maxCoeff(&highest);
    return vertices_.col(highest);
  }

  const ConvexHull hull_;
  const Eigen::Map<const Matrix3X> vertices_;
  const Vector3 middle_;
  Vector3 nearest_;  ///< to the point measured last: the next is often near
  Eigen::RowVectorXd heights_;
};

/// An arc of one of a cylinder's rims, and the point where the tangents at its ends meet. The
/// distance from a hull is convex, and the cylinder lies within the hull of such points.
struct Arc {
  double angle;   ///< of its middle, about the axis [rad]
  double half;    ///< half of what it spans [rad]
  double z;       ///< of the rim, along the axis [m]
  double beyond;  ///< how far that point is from the hull: no point of the arc is farther [m]
  double excess;  ///< how far it is from the arc's middle [m]

  bool operator<(const Arc& other) const { return beyond < other.beyond; }
};

/// The largest distance of the placed primitive's points from the hull, which they are measured
/// from where it is convex: at the extreme points.
struct Overhang {
  const Pose& pose;
  MeasuredHull& hull;

  double operator()(const Box& box) const {
    double most = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3 sign(corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0);
      most = std::max(most, beyond(box.half_extents.cwiseProduct(sign), 0.0));
    }
    return most;
  }

  double operator()(const Capsule& c) const {
    return std::max(beyond({0.0, 0.0, -c.half_length}, c.radius),
                    beyond({0.0, 0.0, c.half_length}, c.radius));
  }

  double operator()(const Sphere& s) const { return beyond(Vector3::Zero(), s.radius); }

  /// Halves the arc that may be farthest, until what may be is what is.
  double operator()(const Cylinder& c) const {
    constexpr double kTolerance = 9e-5;  // [m]
    constexpr int kArcs = 8;
    std::priority_queue<Arc> arcs;
    double known = 0.0;  // some point is as far
    const auto add = [&](double angle, double half, double z) {
      const Arc arc = measured(c.radius, angle, half, z);
      known = std::max(known, arc.beyond - arc.excess);
      arcs.push(arc);
    };
    for (int i = 0; i < kArcs; ++i) {
      const double angle = 2.0 * M_PI * i / kArcs;
      add(angle, M_PI / kArcs, -c.half_length);
      add(angle, M_PI / kArcs, c.half_length);
    }
    while (arcs.top().beyond > known + kTolerance) {
      const Arc widest = arcs.top();
      arcs.pop();
      const double half = 0.5 * widest.half;
      add(widest.angle - half, half, widest.z);
      add(widest.angle + half, half, widest.z);
    }
    return arcs.top().beyond;
  }

 private:
  [[nodiscard]] double beyond(const Vector3& p_shape, double radius) const {
    return hull.beyond(pose * p_shape, radius);
  }

  [[nodiscard]] Arc measured(double radius, double angle, double half, double z) const {
    const double out = radius / std::cos(half);
    const Vector3 meeting(out * std::cos(angle), out * std::sin(angle), z);
    return {angle, half, z, beyond(meeting, 0.0), out - radius};
  }
};

}  // namespace

double overhang(const PlacedShape& primitive, const std::vector<Vector3>& points) {
  MeasuredHull hull(points);
  return std::visit(Overhang{primitive.pose, hull}, primitive.shape);
}

}  // namespace tccm
