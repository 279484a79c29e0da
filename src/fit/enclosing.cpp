#include "fit/enclosing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "fit/points.h"

namespace tccm {
namespace {

constexpr double kThinnestHalf = 0.5 * kThinnest;

/// Points in axes of which the third is the direction they are seen along.
struct View {
  Eigen::Matrix3d axes;
  std::vector<Vector2> across;
  std::vector<double> along;
  std::vector<Vector2> outline;  ///< the hull of across
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
};

/// Without the outline.
View projected(const std::vector<Vector3>& points, const Vector3& direction) {
  View view;
  view.axes = axesAbout(direction);
  view.across.reserve(points.size());
  view.along.reserve(points.size());
  const Eigen::Matrix3d to_view = view.axes.transpose();
  for (const Vector3& p : points) {
    const Vector3 q = to_view * p;
    view.across.emplace_back(q.head<2>());
    view.along.push_back(q.z());
    view.low = std::min(view.low, q.z());
    view.high = std::max(view.high, q.z());
  }
  return view;
}

View viewAlong(const std::vector<Vector3>& points, const Vector3& direction) {
  View view = projected(points, direction);
  view.outline = planarHull(view.across);
  return view;
}

struct Candidate {
  PlacedShape shape;
  double volume_m3 = std::numeric_limits<double>::infinity();
  double excess = 0.0;  ///< how much wider a capsule is than its axis asks for [radius]
  [[nodiscard]] Vector3 axis() const { return shape.pose.linear().col(2); }
};

Candidate placed(const Shape& shape, const Eigen::Matrix3d& axes, const Vector3& centre_in_axes) {
  Candidate result{{shape}, volume(shape)};
  result.shape.pose.linear() = axes;
  result.shape.pose.translation() = axes * centre_in_axes;
  return result;
}

void keepSmaller(Candidate& best, const Candidate& tried) {
  if (tried.volume_m3 < best.volume_m3) best = tried;
}

double halfLength(const View& view) {
  return std::max(0.5 * (view.high - view.low), kThinnestHalf);
}

double middle(const View& view) { return 0.5 * (view.high + view.low); }

Candidate boxIn(const View& view) {
  const Rectangle base = smallestRectangle(view.outline, kThinnest);
  const Vector3 x(base.along_x.x(), base.along_x.y(), 0.0);
  Eigen::Matrix3d turn;
  turn << x, Vector3::UnitZ().cross(x), Vector3::UnitZ();
  const Eigen::Matrix3d axes = view.axes * turn;
  const Vector3 centre(base.centre.x(), base.centre.y(), middle(view));
  const Box box{{base.half_extents.x(), base.half_extents.y(), halfLength(view)}};
  return placed(box, axes, turn.transpose() * centre);
}

Candidate cylinderIn(const View& view) {
  const Ball<2> base = smallestBall<2>(view.outline);
  const Vector3 centre(base.centre.x(), base.centre.y(), middle(view));
  return placed(Cylinder{std::max(base.radius, kThinnestHalf), halfLength(view)}, view.axes,
                centre);
}

/// The shortest straight part of a capsule of this axis and radius: the points at distance d from
/// the axis need lie within sqrt(r^2 - d^2) of its ends. @param radius no point is farther away
Candidate capsuleAbout(const View& view, const Vector2& axis, double radius) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (std::size_t i = 0; i < view.across.size(); ++i) {
    const double squared = radius * radius - (view.across[i] - axis).squaredNorm();
    const double cap = std::sqrt(std::max(0.0, squared));
    low = std::min(low, view.along[i] + cap);
    high = std::max(high, view.along[i] - cap);
  }
  const Capsule capsule{radius, std::max(0.0, 0.5 * (high - low))};
  return placed(capsule, view.axes, {axis.x(), axis.y(), 0.5 * (low + high)});
}

Candidate capsuleIn(const View& view) {
  const Ball<2> base = smallestBall<2>(view.outline);
  Candidate best;
  for (const double wider : {1.0, 1.04, 1.15}) {
    const double radius = std::max(base.radius * wider, kThinnestHalf);
    keepSmaller(best, capsuleAbout(view, base.centre, radius));
  }
  return best;
}

using FitInView = Candidate (*)(const View&);
enum Kind : std::size_t { kBox, kCylinder, kCapsule };
constexpr std::array<FitInView, 3> kFits = {boxIn, cylinderIn, capsuleIn};  // by kind

/// What is searched: a few points of the hull, and directions that an axis may have.
struct Search {
  std::vector<Vector3> hull;
  std::vector<Vector3> points;  ///< the hull's, or some of them where they are many
  std::vector<Vector3> directions;
};

constexpr double kLeastAngle = 0.002;  // [rad] between directions that are worth trying both

/// Adds the directions of the vectors of most length in sum; those that nearly agree are one.
void addHeaviest(std::vector<Vector3> vectors, std::size_t count,
                 std::vector<Vector3>& directions) {
  constexpr std::size_t kLookedAt = 300;
  constexpr double kSame = 0.9999;
  std::stable_sort(vectors.begin(), vectors.end(), [](const Vector3& a, const Vector3& b) {
    return a.squaredNorm() > b.squaredNorm();
  });
  vectors.resize(std::min(kLookedAt, vectors.size()));
  std::vector<std::pair<double, Vector3>> groups;
  for (const Vector3& v : vectors) {
    const double weight = v.norm();
    if (!(weight > 0.0)) continue;
    const auto agrees = [&](const std::pair<double, Vector3>& group) {
      return std::abs(group.second.dot(v)) > kSame * weight;
    };
    const auto group = std::find_if(groups.begin(), groups.end(), agrees);
    if (group == groups.end()) {
      groups.emplace_back(weight, v / weight);
    } else {
      group->first += weight;
    }
  }
  std::stable_sort(groups.begin(), groups.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  groups.resize(std::min(count, groups.size()));
  for (const auto& group : groups) addIfDifferent(directions, group.second, kLeastAngle);
}

Search searchAround(const std::vector<Vector3>& points) {
  constexpr int kSpread = 40;
  static const std::vector<Vector3> kExtremes = hemisphereDirections(250);
  const Mesh hull = convexHull(points).surface;
  Search search{hull.vertices, extremePoints(hull.vertices, kExtremes), {}};
  for (int i = 0; i < 3; ++i) search.directions.push_back(Vector3::Unit(i));
  std::vector<Vector3> normals;
  std::vector<Vector3> edges;
  for (const auto& [a, b, c] : hull.triangles) {
    const Vector3 ab = hull.vertices[b] - hull.vertices[a];
    const Vector3 ac = hull.vertices[c] - hull.vertices[a];
    normals.emplace_back(ab.cross(ac));
    edges.insert(edges.end(), {ab, ac, ac - ab});
  }
  addHeaviest(std::move(normals), 16, search.directions);
  addHeaviest(std::move(edges), 10, search.directions);
  const Eigen::Matrix3d principal = principalAxes(hull.vertices);
  for (int i = 0; i < 3; ++i) addIfDifferent(search.directions, principal.col(i), kLeastAngle);
  for (const Vector3& d : hemisphereDirections(kSpread)) search.directions.push_back(d);
  return search;
}

/// Moves by ever smaller steps while that makes the shape smaller.
/// @param step_of a neighbour of a candidate, by the step's size and number
template <typename StepOf>
Candidate descended(Candidate best, double smallest_step, int count, const StepOf& step_of) {
  for (double step = 0.08; step > smallest_step;) {
    Candidate next = best;
    for (int i = 0; i < count; ++i) keepSmaller(next, step_of(best, step, i));
    if (next.volume_m3 < best.volume_m3 * (1.0 - 1e-5)) {
      best = next;
    } else {
      step *= 0.5;
    }
  }
  return best;
}

/// Turns the axis by steps [rad]. The ring of steps is turned each time: the volume has creases,
/// along which fixed steps get stuck.
Candidate turned(const Search& search, Kind kind, const Candidate& start, double smallest_step) {
  constexpr int kRing = 6;
  double ring_angle = 0.0;
  return descended(start, smallest_step, kRing, [&](const Candidate& from, double step, int i) {
    if (i == 0) ring_angle += 0.7;
    const Eigen::Matrix3d axes = axesAbout(from.axis());
    const double angle = ring_angle + 2.0 * M_PI * i / kRing;
    const Vector3 aside = std::cos(angle) * axes.col(0) + std::sin(angle) * axes.col(1);
    const Vector3 direction = (from.axis() + step * aside).normalized();
    return kFits.at(kind)(viewAlong(search.points, direction));
  });
}

/// A box is exact along each of its own axes in turn.
Candidate settled(const Search& search, Candidate best) {
  constexpr int kRoundsMax = 10;
  for (int round = 0; round < kRoundsMax; ++round) {
    Candidate next = best;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3 direction = best.shape.pose.linear().col(axis);
      keepSmaller(next, boxIn(viewAlong(search.points, direction)));
    }
    if (!(next.volume_m3 < best.volume_m3 * (1.0 - 1e-9))) break;
    best = next;
  }
  return best;
}

/// The capsule turned [rad], moved aside and widened [radius] by steps.
Candidate stepped(const std::vector<Vector3>& points, const Candidate& from,
                  const Eigen::Matrix<double, 5, 1>& steps) {
  const Pose& pose = from.shape.pose;
  const double radius = std::get<Capsule>(from.shape.shape).radius;
  const View view =
      projected(points, (pose.linear() * Vector3(steps[0], steps[1], 1.0)).normalized());
  const Eigen::Matrix3d to_view = view.axes.transpose();
  const Vector3 through = to_view * (pose * Vector3(radius * steps[2], radius * steps[3], 0.0));
  const Vector2 axis = through.head<2>();
  double squared = 0.0;
  for (const Vector2& p : view.across) squared = std::max(squared, (p - axis).squaredNorm());
  const double excess = std::max(0.0, from.excess + steps[4]);
  const double needed = std::max(std::sqrt(squared), kThinnestHalf);
  Candidate capsule = capsuleAbout(view, axis, needed + excess * radius);
  capsule.excess = excess;
  return capsule;
}

/// Moves a capsule's axis and radius.
Candidate moved(const Search& search, const Candidate& start) {
  return descended(start, 5e-4, 10, [&](const Candidate& from, double step, int i) {
    Eigen::Matrix<double, 5, 1> steps = Eigen::Matrix<double, 5, 1>::Zero();
    steps[i / 2] = i % 2 == 0 ? step : -step;
    return stepped(search.points, from, steps);
  });
}

/// The same axis for all points of the hull.
Candidate aroundHull(const Search& search, Kind kind, const Candidate& found) {
  if (search.points.size() == search.hull.size()) return found;
  Candidate again = kFits.at(kind)(viewAlong(search.hull, found.axis()));
  if (kind != kCapsule) return again;
  Candidate no_wider = found;
  no_wider.excess = 0.0;
  keepSmaller(again, stepped(search.hull, no_wider, Eigen::Matrix<double, 5, 1>::Zero()));
  return again;
}

Candidate refined(const Search& search, Kind kind, Candidate found) {
  if (kind == kBox) found = settled(search, found);
  found = turned(search, kind, found, kind == kCapsule ? 0.01 : 5e-4);
  if (kind == kBox) found = settled(search, found);
  if (kind == kCapsule) found = moved(search, found);
  return aroundHull(search, kind, found);
}

/// The best of each kind along the search's directions, the smallest first.
std::array<std::vector<Candidate>, kFits.size()> starts(const Search& search, std::size_t count) {
  std::array<std::vector<Candidate>, kFits.size()> all;
  for (const Vector3& direction : search.directions) {
    const View view = viewAlong(search.points, direction);
    for (const Kind kind : {kBox, kCylinder, kCapsule}) {
      all.at(kind).push_back(kFits.at(kind)(view));
    }
  }
  for (std::vector<Candidate>& candidates : all) {
    std::stable_sort(
        candidates.begin(), candidates.end(),
        [](const Candidate& a, const Candidate& b) { return a.volume_m3 < b.volume_m3; });
    candidates.resize(std::min(count, candidates.size()));
  }
  return all;
}

/// The smallest of these kinds, or best.
/// @param count starts of a kind that are refined, unless larger than hopeless times the smallest
Candidate searched(const Search& search, const std::vector<Kind>& kinds, std::size_t count,
                   double hopeless, Candidate best) {
  const auto tries = starts(search, count);
  double least = best.volume_m3;
  for (const auto& candidates : tries) least = std::min(least, candidates.front().volume_m3);
  for (const Kind kind : kinds) {
    for (const Candidate& start : tries.at(kind)) {
      if (start.volume_m3 <= hopeless * least) keepSmaller(best, refined(search, kind, start));
    }
  }
  return best;
}

Candidate sphereAround(const std::vector<Vector3>& points) {
  const Ball<3> ball = smallestBall<3>(points);
  return placed(Sphere{std::max(ball.radius, kThinnestHalf)}, Eigen::Matrix3d::Identity(),
                ball.centre);
}

PlacedShape smallestOf(Kind kind, const std::vector<Vector3>& points) {
  constexpr double kAll = std::numeric_limits<double>::infinity();
  return searched(searchAround(points), {kind}, 5, kAll, {}).shape;
}

}  // namespace

PlacedShape enclosingSphere(const std::vector<Vector3>& points) {
  return sphereAround(points).shape;
}

PlacedShape enclosingBox(const std::vector<Vector3>& points) { return smallestOf(kBox, points); }

PlacedShape enclosingCylinder(const std::vector<Vector3>& points) {
  return smallestOf(kCylinder, points);
}

PlacedShape enclosingCapsule(const std::vector<Vector3>& points) {
  return smallestOf(kCapsule, points);
}

PlacedShape smallestEnclosing(const std::vector<Vector3>& points) {
  constexpr double kHopeless = 1.25;  // refinement does not gain that much
  const Search search = searchAround(points);
  return searched(search, {kBox, kCylinder, kCapsule}, 2, kHopeless, sphereAround(search.hull))
      .shape;
}

double enclosingVolumeAlong(const std::vector<Vector3>& points,
                            const std::vector<Vector3>& directions) {
  double least = sphereAround(points).volume_m3;
  for (const Vector3& direction : directions) {
    const View view = viewAlong(points, direction);
    for (const FitInView fit : kFits) least = std::min(least, fit(view).volume_m3);
  }
  return least;
}

}  // namespace tccm
