#include "tccm_monitor/shape.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/point_distance.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr double kLargestSize = 1e3;  // [m]; beyond it is a slip of units

struct Expand {
  Expansion by;
  [[nodiscard]] double grow(double size) const { return size * by.scale + by.padding_m; }
  Shape operator()(const Box& box) const {
    return Box{(box.half_extents * by.scale).array() + by.padding_m};
  }
  Shape operator()(const Cylinder& c) const {
    return Cylinder{grow(c.radius), grow(c.half_length)};
  }
  Shape operator()(const Capsule& c) const {
    return Capsule{grow(c.radius), c.half_length * by.scale};
  }
  Shape operator()(const Sphere& s) const { return Sphere{grow(s.radius)}; }
};

struct Volume {
  double operator()(const Box& box) const { return 8.0 * box.half_extents.prod(); }
  double operator()(const Cylinder& c) const {
    return M_PI * c.radius * c.radius * 2.0 * c.half_length;
  }
  double operator()(const Capsule& c) const {
    return (*this)(Cylinder{c.radius, c.half_length}) + (*this)(Sphere{c.radius});
  }
  double operator()(const Sphere& s) const { return 4.0 / 3.0 * M_PI * std::pow(s.radius, 3); }
};

struct BoundingRadius {
  double operator()(const Box& box) const { return box.half_extents.norm(); }
  double operator()(const Cylinder& c) const { return std::hypot(c.radius, c.half_length); }
  double operator()(const Capsule& c) const { return c.radius + c.half_length; }
  double operator()(const Sphere& s) const { return s.radius; }
};

/// Half the extents of the upright box around the rotated shape.
struct BoundingExtents {
  Eigen::Matrix3d rotation;
  Vector3 operator()(const Box& box) const { return rotation.cwiseAbs() * box.half_extents; }
  Vector3 operator()(const Cylinder& c) const {
    const Vector3 across = rotation.leftCols<2>().rowwise().norm();
    return rotation.col(2).cwiseAbs() * c.half_length + across * c.radius;
  }
  Vector3 operator()(const Capsule& c) const {
    return (rotation.col(2).cwiseAbs() * c.half_length).array() + c.radius;
  }
  Vector3 operator()(const Sphere& s) const { return Vector3::Constant(s.radius); }
};

struct Validate {
  std::string owner;
  void requireSize(const char* what, double value) const {
    requireInRange(owner + ": " + what, value, 1e-9, kLargestSize);
  }
  void operator()(const Box& box) const {
    for (const double half : {box.half_extents.x(), box.half_extents.y(), box.half_extents.z()}) {
      requireSize("box size", 2.0 * half);
    }
  }
  void operator()(const Cylinder& c) const {
    requireSize("cylinder radius", c.radius);
    requireSize("cylinder length", 2.0 * c.half_length);
  }
  void operator()(const Capsule& c) const {
    requireSize("capsule radius", c.radius);
    requireInRange(owner + ": capsule length", 2.0 * c.half_length, 0.0, kLargestSize);
  }
  void operator()(const Sphere& s) const { requireSize("sphere radius", s.radius); }
};

}  // namespace

Shape expanded(const Shape& shape, const Expansion& expansion) {
  return std::visit(Expand{expansion}, shape);
}

double volume(const Shape& shape) { return std::visit(Volume{}, shape); }

double boundingRadius(const Shape& shape) { return std::visit(BoundingRadius{}, shape); }

UprightBox bounds(const Shape& shape, const Pose& T_fixed_shape) {
  const Vector3 half = std::visit(BoundingExtents{T_fixed_shape.linear()}, shape);
  return {T_fixed_shape.translation() - half, T_fixed_shape.translation() + half};
}

double distance(const Shape& shape, const Vector3& p_shape) {
  return std::visit(PointDistance{p_shape}, shape);
}

std::string name(const Shape& shape) {
  static const std::array<const char*, 4> kNames = {"box", "cylinder", "capsule", "sphere"};
  return kNames[shape.index()];
}

void validate(const Shape& shape, const std::string& owner) { std::visit(Validate{owner}, shape); }

}  // namespace tccm
