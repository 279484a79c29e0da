#include "fit/smallest_ball.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

namespace tccm {
namespace {

template <int Dimension>
using Point = Eigen::Matrix<double, Dimension, 1>;

/// Points on the border that hold the ball; one more than the dimension at most.
template <int Dimension>
struct Support {
  std::array<Point<Dimension>, Dimension + 2> points;
  std::size_t count = 0;
};

/// The centre of the smallest sphere through the first Count points; not finite where they are
/// degenerate.
template <int Count, int Dimension>
Point<Dimension> centreOf(const std::array<Point<Dimension>, Dimension + 2>& points) {
  if constexpr (Count == 1) {
    return points[0];
  } else {
    Eigen::Matrix<double, Dimension, Count - 1> edges;
    for (int i = 1; i < Count; ++i)
      edges.col(i - 1) = points[static_cast<std::size_t>(i)] - points[0];
    const Eigen::Matrix<double, Count - 1, Count - 1> gram = edges.transpose() * edges;
    const Eigen::Matrix<double, Count - 1, 1> shares = gram.inverse() * (0.5 * gram.diagonal());
    return points[0] + edges * shares;
  }
}

template <int Dimension>
Point<Dimension> centreOf(const Support<Dimension>& chosen) {
  switch (chosen.count) {
    case 1:
      return centreOf<1, Dimension>(chosen.points);
    case 2:
      return centreOf<2, Dimension>(chosen.points);
    case 3:
      return centreOf<3, Dimension>(chosen.points);
    default:
      return centreOf<Dimension + 1, Dimension>(chosen.points);
  }
}

template <int Dimension>
double reach(const Support<Dimension>& support, const Point<Dimension>& centre) {
  double squared = 0.0;
  for (std::size_t i = 0; i < support.count; ++i) {
    const double apart = (support.points.at(i) - centre).squaredNorm();
    if (!std::isfinite(apart)) return apart;
    squared = std::max(squared, apart);
  }
  return std::sqrt(squared);
}

/// The smallest ball around at most Dimension + 2 points, by trying every subset that holds the
/// last of them; the support shrinks to those that hold it.
template <int Dimension>
Ball<Dimension> smallestBallOfFew(Support<Dimension>& support) {
  Ball<Dimension> best{support.points[0], std::numeric_limits<double>::infinity()};
  Support<Dimension> best_chosen = support;
  const std::size_t last = support.count - 1;
  for (unsigned subset = 0; subset < (1U << last); ++subset) {
    Support<Dimension> chosen;
    chosen.points[chosen.count++] = support.points.at(last);
    for (std::size_t i = 0; i < last; ++i) {
      if (subset & (1U << i)) chosen.points.at(chosen.count++) = support.points.at(i);
    }
    if (chosen.count > Dimension + 1) continue;
    const Point<Dimension> centre = centreOf(chosen);
    const double radius = reach(support, centre);
    if (radius < best.radius) {
      best = {centre, radius};
      best_chosen = chosen;
    }
  }
  support = best_chosen;
  return best;
}

template <int Dimension>
Point<Dimension> farthestFrom(const Point<Dimension>& centre,
                              const std::vector<Point<Dimension>>& points) {
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

}  // namespace

template <int Dimension>
Ball<Dimension> smallestBall(const std::vector<Point<Dimension>>& points) {
  assert(!points.empty());
  // The farthest point joins the support until none is outside; the radius rises each time.
  constexpr int kRoundsMax = 1000;
  Support<Dimension> support;
  support.points[support.count++] = points.front();
  Ball<Dimension> ball{points.front(), 0.0};
  for (int round = 0;; ++round) {
    const Point<Dimension> farthest = farthestFrom(ball.centre, points);
    const double needed = (farthest - ball.centre).norm();
    const Ball<Dimension> containing{ball.centre, std::max(ball.radius, needed)};
    if (needed <= ball.radius * (1.0 + 1e-12) || round == kRoundsMax) return containing;
    support.points.at(support.count++) = farthest;
    const Ball<Dimension> larger = smallestBallOfFew(support);
    if (!(larger.radius > ball.radius)) return containing;
    ball = larger;
  }
}

template Ball<2> smallestBall<2>(const std::vector<Eigen::Vector2d>& points);
template Ball<3> smallestBall<3>(const std::vector<Eigen::Vector3d>& points);

}  // namespace tccm
