#include "fit/smallest.h"

#include <Eigen/LU>
#include <algorithm>
#include <boost/container/static_vector.hpp>
#include <cassert>
#include <limits>

namespace tccm {
namespace {

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

std::vector<Vector2> planarHull(std::vector<Vector2> points) {
  std::sort(points.begin(), points.end(), [](const Vector2& a, const Vector2& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
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
