#include "fit/points.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <boost/container/static_vector.hpp>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>
#include <string>

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace tccm {
namespace {

constexpr double kFlat = 1e-9;  // of the extent

/// Each once, in the order of their coordinates.
template <typename Point>
std::vector<Point> different(std::vector<Point> points) {
  std::sort(points.begin(), points.end(), [](const Point& a, const Point& b) {
    return std::lexicographical_compare(a.data(), a.data() + a.size(), b.data(),
                                        b.data() + b.size());
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

/// The point for which measure is largest.
template <typename Measure>
Vector3 farthest(const std::vector<Vector3>& points, const Measure& measure) {
  return *std::max_element(points.begin(), points.end(), [&](const Vector3& a, const Vector3& b) {
    return measure(a) < measure(b);
  });
}

/// Whether points of extent 1 lie near one plane, line or point.
bool isFlat(const std::vector<Vector3>& points) {
  const Vector3 a = points.front();
  const Vector3 b = farthest(points, [&](const Vector3& p) { return (p - a).norm(); });
  const Vector3 along = (b - a).normalized();
  const auto from_line = [&](const Vector3& p) { return along.cross(p - a).norm(); };
  const Vector3 c = farthest(points, from_line);
  if (from_line(c) < kFlat) return true;
  const Vector3 normal = along.cross(c - a).normalized();
  const auto from_plane = [&](const Vector3& p) { return std::abs(normal.dot(p - a)); };
  return from_plane(farthest(points, from_plane)) < kFlat;
}

/// Qhull's state, silent, and freed whatever happens.
struct Qhull {
  Qhull() { qh_zero(&state, silence); }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;
  ~Qhull() {
    int long_blocks = 0;
    int long_bytes = 0;
    qh_freeqhull(&state, !qh_ALL);
    qh_memfreeshort(&state, &long_blocks, &long_bytes);
    if (silence != nullptr) std::fclose(silence);
  }

  std::FILE* silence = std::fopen("/dev/null", "w");
  qhT state;
};

/// Corners as numbers of points.
std::vector<Mesh::Triangle> trianglesOf(qhT& state) {
  std::vector<Mesh::Triangle> triangles;
  for (const facetT* facet = state.facet_list; facet && facet->next; facet = facet->next) {
    if (qh_setsize(&state, facet->vertices) != 3) continue;
    Mesh::Triangle triangle{};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      auto* vertex = static_cast<vertexT*>(facet->vertices->e[corner].p);
      triangle[corner] = static_cast<std::uint32_t>(qh_pointid(&state, vertex->point));
    }
    triangles.push_back(triangle);
  }
  return triangles;
}

/// None where Qhull finds no hull.
std::vector<Mesh::Triangle> hullTriangles(std::vector<Vector3> points) {
  // Merged faces first; joggled input gets through where their merging fails.
  for (std::string command : {"qhull Qt Pp", "qhull QJ Pp"}) {
    Qhull qhull;
    if (qh_new_qhull(&qhull.state, 3, static_cast<int>(points.size()), points.front().data(), False,
                     command.data(), nullptr, qhull.silence) == qh_ERRnone) {
      return trianglesOf(qhull.state);
    }
  }
  return {};
}

/// Of a star-shaped surface about the vertices' mean, whatever the winding.
double enclosedVolume(const Mesh& mesh) {
  Vector3 middle = Vector3::Zero();
  for (const Vector3& p : mesh.vertices) middle += p / static_cast<double>(mesh.vertices.size());
  double sixfold = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vector3 from = mesh.vertices[a] - middle;
    const Vector3 normal = (mesh.vertices[b] - middle).cross(mesh.vertices[c] - middle);
    sixfold += std::abs(from.dot(normal));
  }
  return sixfold / 6.0;
}

double cross(const Vector2& a, const Vector2& b) { return a.x() * b.y() - a.y() * b.x(); }

Vector2 leftOf(const Vector2& v) { return {-v.y(), v.x()}; }

/// Adds p to a chain that turns left, dropping the corners that would not.
void extend(std::vector<Vector2>& chain, std::size_t kept, const Vector2& p) {
  while (chain.size() >= kept + 2) {
    const Vector2& last = chain.back();
    const Vector2& before = chain[chain.size() - 2];
    if (cross(last - before, p - last) > 0.0) break;
    chain.pop_back();
  }
  chain.push_back(p);
}

/// A caliper: the corner that is farthest along a direction which turns anticlockwise.
class Caliper {
 public:
  explicit Caliper(const std::vector<Vector2>& hull) : hull_(hull) {}

  double reach(const Vector2& direction) {
    if (!placed_) {
      placed_ = true;
      for (std::size_t i = 1; i < hull_.size(); ++i) {
        if (direction.dot(hull_[i] - hull_[at_]) > 0.0) at_ = i;
      }
    }
    for (std::size_t step = 0; step < hull_.size(); ++step) {
      const std::size_t next = at_ + 1 == hull_.size() ? 0 : at_ + 1;
      if (direction.dot(hull_[next] - hull_[at_]) < 0.0) break;
      at_ = next;
    }
    return direction.dot(hull_[at_]);
  }

 private:
  const std::vector<Vector2>& hull_;
  std::size_t at_ = 0;
  bool placed_ = false;
};

template <int Dimension>
using Point = Eigen::Matrix<double, Dimension, 1>;

/// Points on the border that hold the ball; one more than the dimension at most.
template <int Dimension>
using Support = boost::container::static_vector<Point<Dimension>, Dimension + 2>;

/// The centre of the smallest sphere through the points, at most Count; not finite where they are
/// degenerate.
template <int Dimension, std::size_t Count = Dimension + 1>
Point<Dimension> centreOf(const Support<Dimension>& points) {
  if constexpr (Count == 1) {
    return points[0];
  } else {
    if (points.size() < Count) return centreOf<Dimension, Count - 1>(points);
    Eigen::Matrix<double, Dimension, Count - 1> edges;
    for (std::size_t i = 1; i < Count; ++i) {
      edges.col(static_cast<Eigen::Index>(i) - 1) = points[i] - points[0];
    }
    const Eigen::Matrix<double, Count - 1, Count - 1> gram = edges.transpose() * edges;
    const Eigen::Matrix<double, Count - 1, 1> shares = gram.inverse() * (0.5 * gram.diagonal());
    return points[0] + edges * shares;
  }
}

template <int Dimension, typename Points>
Point<Dimension> farthestFrom(const Point<Dimension>& centre, const Points& points) {
  Point<Dimension> farthest = points.front();
  double apart = 0.0;
  for (const Point<Dimension>& p : points) {
    const double squared = (p - centre).squaredNorm();
    if (squared <= apart) continue;
    apart = squared;
    farthest = p;
  }
  return farthest;
}

/// The smallest ball around at most Dimension + 2 points, by trying every subset that holds the
/// last of them; the support shrinks to those that hold it.
template <int Dimension>
Ball<Dimension> smallestBallOfFew(Support<Dimension>& support) {
  Ball<Dimension> best{support[0], std::numeric_limits<double>::infinity()};
  Support<Dimension> best_chosen = support;
  const std::size_t last = support.size() - 1;
  for (unsigned subset = 0; subset < (1U << last); ++subset) {
    Support<Dimension> chosen{support[last]};
    for (std::size_t i = 0; i < last; ++i) {
      if (subset & (1U << i)) chosen.push_back(support[i]);
    }
    if (chosen.size() > Dimension + 1) continue;
    const Point<Dimension> centre = centreOf<Dimension>(chosen);
    const double radius = (farthestFrom<Dimension>(centre, support) - centre).norm();
    if (radius < best.radius) {
      best = {centre, radius};
      best_chosen = chosen;
    }
  }
  support = best_chosen;
  return best;
}

}  // namespace

ConvexHull convexHull(const std::vector<Vector3>& points) {
  const std::vector<Vector3> unique = different(points);
  ConvexHull hull;
  hull.surface.vertices = unique;
  if (unique.size() < 4) return hull;

  Eigen::AlignedBox3d box;
  for (const Vector3& p : unique) box.extend(p);
  const double extent = box.sizes().maxCoeff();
  // Qhull's tolerances are relative to the largest coordinate.
  std::vector<Vector3> scaled;
  scaled.reserve(unique.size());
  for (const Vector3& p : unique) scaled.emplace_back((p - box.center()) / extent);
  if (isFlat(scaled)) return hull;

  hull.surface.triangles = hullTriangles(std::move(scaled));
  if (hull.surface.triangles.empty()) return hull;
  hull.surface.vertices = withoutUnused(unique, hull.surface.triangles);
  hull.volume_m3 = enclosedVolume(hull.surface);
  return hull;
}

std::vector<Vector3> hemisphereDirections(int count) {
  const double golden_angle = M_PI * (3.0 - std::sqrt(5.0));
  std::vector<Vector3> directions;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (i + 0.5) / count;
    const double across = std::sqrt(1.0 - z * z);
    directions.emplace_back(across * std::cos(i * golden_angle),
                            across * std::sin(i * golden_angle), z);
  }
  return directions;
}

Eigen::Matrix3d principalAxes(const std::vector<Vector3>& points) {
  Vector3 mean = Vector3::Zero();
  for (const Vector3& p : points) mean += p / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vector3& p : points) spread += (p - mean) * (p - mean).transpose();
  const double scale = spread.trace();
  if (!(scale > 0.0)) return Eigen::Matrix3d::Identity();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread / scale);
  Eigen::Matrix3d axes = solver.eigenvectors().rowwise().reverse();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

Eigen::Matrix3d axesAbout(const Vector3& z) {
  int across = 0;
  z.cwiseAbs().minCoeff(&across);
  Eigen::Matrix3d axes;
  axes.col(2) = z;
  axes.col(0) = Vector3::Unit(across).cross(z).normalized();
  axes.col(1) = z.cross(axes.col(0));
  return axes;
}

void addIfDifferent(std::vector<Vector3>& directions, const Vector3& direction,
                    double least_angle) {
  const double cosine = std::cos(least_angle);
  const auto same = [&](const Vector3& d) { return std::abs(d.dot(direction)) > cosine; };
  if (std::none_of(directions.begin(), directions.end(), same)) directions.push_back(direction);
}

std::vector<Vector3> extremePoints(const std::vector<Vector3>& points,
                                   const std::vector<Vector3>& directions) {
  if (points.size() <= 2 * directions.size()) return points;
  const Eigen::Map<const Matrix3X> all(points.front().data(), 3,
                                       static_cast<Eigen::Index>(points.size()));
  std::set<Eigen::Index> chosen;
  Eigen::RowVectorXd heights(all.cols());
  for (const Vector3& direction : directions) {
    heights.noalias() = direction.transpose() * all;
    Eigen::Index lowest = 0;
    Eigen::Index highest = 0;
    heights.minCoeff(&lowest);
    heights.maxCoeff(&highest);
    chosen.insert({lowest, highest});
  }
  std::vector<Vector3> extreme;
  for (const Eigen::Index i : chosen) extreme.push_back(points[static_cast<std::size_t>(i)]);
  return extreme;
}

std::vector<Vector2> planarHull(const std::vector<Vector2>& all) {
  const std::vector<Vector2> points = different(all);
  if (points.size() < 3) return points;
  std::vector<Vector2> chain;
  chain.reserve(points.size() + 1);
  for (const Vector2& p : points) extend(chain, 0, p);
  const std::size_t lower = chain.size() - 1;
  for (auto p = points.rbegin() + 1; p != points.rend(); ++p) extend(chain, lower, *p);
  chain.pop_back();
  return chain;
}

Rectangle smallestRectangle(const std::vector<Vector2>& hull, double thinnest) {
  assert(!hull.empty());
  Rectangle best{hull.front(), Vector2::UnitX(), Vector2::Constant(0.5 * thinnest)};
  double least = std::numeric_limits<double>::infinity();
  Caliper right(hull);
  Caliper left(hull);
  Caliper back(hull);
  for (std::size_t i = 0; i < hull.size() && hull.size() > 1; ++i) {
    const Vector2 edge = hull[i + 1 == hull.size() ? 0 : i + 1] - hull[i];
    const Vector2 x = edge.normalized();
    const Vector2 y = leftOf(x);
    const Vector2 high(right.reach(x), left.reach(y));
    const Vector2 low(-back.reach(-x), y.dot(hull[i]));
    const Vector2 size = (high - low).cwiseMax(thinnest);
    if (size.prod() >= least) continue;
    least = size.prod();
    const Vector2 middle = 0.5 * (high + low);
    best = {x * middle.x() + y * middle.y(), x, 0.5 * size};
  }
  return best;
}

template <int Dimension>
Ball<Dimension> smallestBall(const std::vector<Point<Dimension>>& points) {
  assert(!points.empty());
  // The farthest point joins the support until none is outside; the radius rises each time.
  constexpr int kRoundsMax = 1000;
  Support<Dimension> support{points.front()};
  Ball<Dimension> ball{points.front(), 0.0};
  for (int round = 0;; ++round) {
    const Point<Dimension> farthest = farthestFrom<Dimension>(ball.centre, points);
    const double needed = (farthest - ball.centre).norm();
    const Ball<Dimension> containing{ball.centre, std::max(ball.radius, needed)};
    if (needed <= ball.radius * (1.0 + 1e-12) || round == kRoundsMax) return containing;
    support.push_back(farthest);
    const Ball<Dimension> larger = smallestBallOfFew<Dimension>(support);
    if (!(larger.radius > ball.radius)) return containing;
    ball = larger;
  }
}

template Ball<2> smallestBall<2>(const std::vector<Eigen::Vector2d>& points);
template Ball<3> smallestBall<3>(const std::vector<Eigen::Vector3d>& points);

}  // namespace tccm
