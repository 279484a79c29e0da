#include "experiments/exact_clearance.h"

#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <variant>
#include <vector>

namespace tccm::simulation {
namespace {

using Geometry = std::shared_ptr<fcl::CollisionGeometryd>;

struct ToFcl {
  Geometry operator()(const Box& b) const {
    return std::make_shared<fcl::Boxd>(Vector3(2.0 * b.half_extents));
  }
  Geometry operator()(const Cylinder& c) const {
    return std::make_shared<fcl::Cylinderd>(c.radius, 2.0 * c.half_length);
  }
  Geometry operator()(const Capsule& c) const {
    return std::make_shared<fcl::Capsuled>(c.radius, 2.0 * c.half_length);
  }
  Geometry operator()(const Sphere& s) const { return std::make_shared<fcl::Sphered>(s.radius); }
};

std::vector<Geometry> geometriesOf(const Body& body) {
  std::vector<Geometry> geometries;
  for (const Shape& shape : body.shapes) geometries.push_back(std::visit(ToFcl{}, shape));
  return geometries;
}

bool touch(const Geometry& a, const Pose& T_fixed_a, const Geometry& b, const Pose& T_fixed_b) {
  fcl::CollisionRequestd request;
  request.gjk_solver_type = fcl::GST_LIBCCD;
  fcl::CollisionResultd result;
  return fcl::collide(a.get(), T_fixed_a, b.get(), T_fixed_b, request, result) > 0;
}

double apart(const Geometry& a, const Pose& T_fixed_a, const Geometry& b, const Pose& T_fixed_b) {
  fcl::DistanceRequestd request;
  request.gjk_solver_type = fcl::GST_LIBCCD;
  fcl::DistanceResultd result;
  return fcl::distance(a.get(), T_fixed_a, b.get(), T_fixed_b, request, result);
}

}  // namespace

bool exactlyTouch(const Body& a, const Body& b) {
  for (std::size_t i = 0; i < a.shapes.size(); ++i) {
    for (std::size_t j = 0; j < b.shapes.size(); ++j) {
      const double centres = (a.poses[i].translation() - b.poses[j].translation()).norm();
      if (centres > boundingRadius(a.shapes[i]) + boundingRadius(b.shapes[j])) continue;
      const Geometry of_a = std::visit(ToFcl{}, a.shapes[i]);
      const Geometry of_b = std::visit(ToFcl{}, b.shapes[j]);
      if (touch(of_a, a.poses[i], of_b, b.poses[j])) return true;
    }
  }
  return false;
}

double exactClearance(const Body& a, const Body& b) {
  const std::vector<Geometry> of_a = geometriesOf(a), of_b = geometriesOf(b);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < of_a.size(); ++i) {
    for (std::size_t j = 0; j < of_b.size(); ++j) {
      const double centres = (a.poses[i].translation() - b.poses[j].translation()).norm();
      if (centres - boundingRadius(a.shapes[i]) - boundingRadius(b.shapes[j]) >= least) continue;
      if (touch(of_a[i], a.poses[i], of_b[j], b.poses[j])) return 0.0;
      least = std::min(least, apart(of_a[i], a.poses[i], of_b[j], b.poses[j]));
    }
  }
  return least;
}

}  // namespace tccm::simulation
