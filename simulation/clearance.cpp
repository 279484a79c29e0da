#include "simulation/clearance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tccm::simulation {
namespace {

/// From -half to half, both included.
std::vector<double> steps(double half, double spacing) {
  const int count = std::max(1, static_cast<int>(std::ceil(2.0 * half / spacing)));
  std::vector<double> result;
  for (int i = 0; i <= count; ++i) result.push_back(half * (2.0 * i / count - 1.0));
  return result;
}

struct Sampler {
  double spacing;
  std::vector<Vector3> points;

  void ring(double radius, double z) {
    const int count = std::max(1, static_cast<int>(std::ceil(2.0 * M_PI * radius / spacing)));
    for (int i = 0; i < count; ++i) {
      const double angle = 2.0 * M_PI * i / count;
      points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
  }
  void tube(double radius, double half_length) {
    for (const double z : steps(half_length, spacing)) ring(radius, z);
  }
  /// @param side 1 for the upper half of a ball, -1 for the lower.
  void dome(double radius, double z, double side) {
    const int count = std::max(1, static_cast<int>(std::ceil(M_PI_2 * radius / spacing)));
    for (int i = 0; i <= count; ++i) {
      const double angle = M_PI_2 * i / count;
      ring(radius * std::cos(angle), z + side * radius * std::sin(angle));
    }
  }
  void operator()(const Box& box) {
    for (const double x : steps(box.half_extents.x(), spacing)) {
      for (const double y : steps(box.half_extents.y(), spacing)) {
        for (const double z : steps(box.half_extents.z(), spacing)) {
          const Vector3 p(x, y, z);
          if ((p.cwiseAbs() - box.half_extents).maxCoeff() > -1e-9) points.push_back(p);
        }
      }
    }
  }
  void operator()(const Cylinder& c) {
    tube(c.radius, c.half_length);
    for (const double radius : steps(0.5 * c.radius, spacing)) {
      for (const double z : {-c.half_length, c.half_length}) ring(radius + 0.5 * c.radius, z);
    }
  }
  void operator()(const Capsule& c) {
    tube(c.radius, c.half_length);
    dome(c.radius, c.half_length, 1.0);
    dome(c.radius, -c.half_length, -1.0);
  }
  void operator()(const Sphere& s) {
    dome(s.radius, 0.0, 1.0);
    dome(s.radius, 0.0, -1.0);
  }
};

double fromPointsOf(const SampledBody& a, const SampledBody& b) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < a.body().shapes.size(); ++i) {
    for (std::size_t j = 0; j < b.body().shapes.size(); ++j) {
      const Pose T_b_a = b.body().poses[j].inverse() * a.body().poses[i];
      for (const Vector3& p : a.points()[i]) {
        least = std::min(least, distance(b.body().shapes[j], T_b_a * p));
      }
    }
  }
  return least;
}

}  // namespace

std::vector<Vector3> surfacePoints(const Shape& shape, double spacing) {
  Sampler sampler{spacing, {}};
  std::visit(sampler, shape);
  return sampler.points;
}

SampledBody::SampledBody(Body body, double spacing) : body_(std::move(body)) {
  for (const Shape& shape : body_.shapes) points_.push_back(surfacePoints(shape, spacing));
}

void SampledBody::shift(const Vector3& offset) {
  for (Pose& pose : body_.poses) pose.pretranslate(offset);
}

double clearance(const SampledBody& a, const SampledBody& b) {
  return std::min(fromPointsOf(a, b), fromPointsOf(b, a));
}

}  // namespace tccm::simulation
