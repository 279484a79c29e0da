#include "fit/planar.h"

#include <algorithm>
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

}  // namespace tccm
