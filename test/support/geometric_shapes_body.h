#pragma once

#include <geometric_shapes/bodies.h>
#include <geometric_shapes/shapes.h>

#include <memory>
#include <variant>

#include "tccm_monitor/shape.h"

namespace tccm::test {

/// Another library's idea of the shape. Nothing for a capsule, which geometric_shapes does not
/// know.
inline std::unique_ptr<bodies::Body> toBody(const Shape& shape) {
  if (const auto* b = std::get_if<Box>(&shape)) {
    const Vector3 size = 2.0 * b->half_extents;
    const shapes::Box box(size.x(), size.y(), size.z());
    return std::make_unique<bodies::Box>(&box);
  }
  if (const auto* c = std::get_if<Cylinder>(&shape)) {
    const shapes::Cylinder cylinder(c->radius, 2.0 * c->half_length);
    return std::make_unique<bodies::Cylinder>(&cylinder);
  }
  if (const auto* s = std::get_if<Sphere>(&shape)) {
    const shapes::Sphere sphere(s->radius);
    return std::make_unique<bodies::Sphere>(&sphere);
  }
  return nullptr;
}

}  // namespace tccm::test
