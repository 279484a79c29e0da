#pragma once

#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/collision_object.h>

#include <memory>

#include "tccm_monitor/shape.h"

namespace tccm::test {

struct ToFcl {
  using Geometry = std::shared_ptr<fcl::CollisionGeometryd>;
  Geometry operator()(const Box& b) const {
    const Vector3 size = 2.0 * b.half_extents;
    return std::make_shared<fcl::Boxd>(size);
  }
  Geometry operator()(const Cylinder& c) const {
    return std::make_shared<fcl::Cylinderd>(c.radius, 2.0 * c.half_length);
  }
  Geometry operator()(const Capsule& c) const {
    return std::make_shared<fcl::Capsuled>(c.radius, 2.0 * c.half_length);
  }
  Geometry operator()(const Sphere& s) const { return std::make_shared<fcl::Sphered>(s.radius); }
};

/// Another library's answer to overlaps(); its iterative solver stops at about 1e-6 m.
inline bool overlapsByFcl(const Shape& shape, const Pose& T_fixed_shape, const UprightBox& box) {
  const Vector3 size = box.sizes();
  const fcl::CollisionObjectd upright(std::make_shared<fcl::Boxd>(size),
                                      Eigen::Matrix3d::Identity(), box.center());
  const fcl::CollisionObjectd placed(std::visit(ToFcl{}, shape), T_fixed_shape.linear(),
                                     T_fixed_shape.translation());
  fcl::CollisionRequestd request;
  request.gjk_solver_type = fcl::GST_LIBCCD;
  fcl::CollisionResultd result;
  return fcl::collide(&placed, &upright, request, result) > 0;
}

}  // namespace tccm::test
