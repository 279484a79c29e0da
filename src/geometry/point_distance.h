#pragma once

#include <algorithm>
#include <cmath>

#include "tccm_monitor/shape.h"

namespace tccm {

/// From a point in a solid's frame to the solid; 0 inside. In a header, because it is asked for
/// each point of a cloud.
struct PointDistance {
  Vector3 p;
  double operator()(const Box& box) const {
    return (p.cwiseAbs() - box.half_extents).cwiseMax(0.0).norm();
  }
  double operator()(const Cylinder& c) const {
    const double outward = std::max(0.0, p.head<2>().norm() - c.radius);
    const double beyond = std::max(0.0, std::abs(p.z()) - c.half_length);
    return std::sqrt(outward * outward + beyond * beyond);
  }
  double operator()(const Capsule& c) const {
    const Vector3 on_axis(0.0, 0.0, std::clamp(p.z(), -c.half_length, c.half_length));
    return std::max(0.0, (p - on_axis).norm() - c.radius);
  }
  double operator()(const Sphere& s) const { return std::max(0.0, p.norm() - s.radius); }
};

/// Whether that distance is at most so much; without a root.
struct IsWithin {
  Vector3 p;
  double most;
  bool operator()(const Box& box) const {
    return (p.cwiseAbs() - box.half_extents).cwiseMax(0.0).squaredNorm() <= most * most;
  }
  bool operator()(const Cylinder& c) const {
    const double across = p.x() * p.x() + p.y() * p.y(), all = c.radius + most;
    const double beyond = std::max(0.0, std::abs(p.z()) - c.half_length);
    if (across > all * all || beyond > most) return false;
    return beyond == 0.0 || across <= c.radius * c.radius || PointDistance{p}(c) <= most;
  }
  bool operator()(const Capsule& c) const {
    const double beyond = p.z() - std::clamp(p.z(), -c.half_length, c.half_length);
    const double all = c.radius + most;
    return p.x() * p.x() + p.y() * p.y() + beyond * beyond <= all * all;
  }
  bool operator()(const Sphere& s) const {
    return p.squaredNorm() <= (s.radius + most) * (s.radius + most);
  }
};

}  // namespace tccm
