#pragma once

#include <fcl/geometry/shape/utility.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>
#include <yaml-cpp/yaml.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tccm::test {

/// One of a link's primitives for FCL.
class PrimitiveByFcl {
 public:
  /// @param entry as fit_primitives writes it. @param padding_m on every side; box and cylinder
  /// grow along their own axes.
  PrimitiveByFcl(const YAML::Node& entry, double padding_m) {
    const auto kind = entry["shape"].as<std::string>();
    const double around = 2.0 * padding_m;
    if (kind == "box") {
      const auto size = entry["size"].as<std::vector<double>>();
      take(fcl::Boxd(size[0] + around, size[1] + around, size[2] + around));
    } else {
      const double radius = entry["radius"].as<double>() + padding_m;
      if (kind == "sphere") {
        take(fcl::Sphered(radius));
      } else if (kind == "capsule") {
        take(fcl::Capsuled(radius, entry["length"].as<double>()));
      } else {
        take(fcl::Cylinderd(radius, entry["length"].as<double>() + around));
      }
    }
    const auto xyz = entry["xyz"].as<std::vector<double>>(std::vector<double>(3, 0.0));
    const auto rpy = entry["rpy"].as<std::vector<double>>(std::vector<double>(3, 0.0));
    T_link_shape_.translation() = Eigen::Vector3d(xyz[0], xyz[1], xyz[2]);
    T_link_shape_.linear() = (Eigen::AngleAxisd(rpy[2], Eigen::Vector3d::UnitZ()) *
                              Eigen::AngleAxisd(rpy[1], Eigen::Vector3d::UnitY()) *
                              Eigen::AngleAxisd(rpy[0], Eigen::Vector3d::UnitX()))
                                 .toRotationMatrix();
  }

  void place(const Eigen::Isometry3d& T_fixed_link) {
    T_fixed_shape_ = T_fixed_link * T_link_shape_;
  }

  /// The upright box around it where it was placed.
  [[nodiscard]] Eigen::AlignedBox3d bounds() const { return bounds_(T_fixed_shape_); }

  [[nodiscard]] bool touches(const Eigen::AlignedBox3d& cuboid) const {
    fcl::CollisionRequestd request;
    fcl::CollisionResultd result;
    return collide(cuboid, request, result);
  }

  /// How far apart they are; below 0 by how much they overlap [m].
  [[nodiscard]] double signedDistance(const Eigen::AlignedBox3d& cuboid) const {
    constexpr std::size_t kContacts = 8;
    fcl::CollisionRequestd request(kContacts, true);
    fcl::CollisionResultd collision;
    if (collide(cuboid, request, collision)) {
      double depth = 0.0;
      for (std::size_t i = 0; i < collision.numContacts(); ++i) {
        depth = std::max(depth, collision.getContact(i).penetration_depth);
      }
      return -depth;
    }
    const fcl::Boxd upright(Eigen::Vector3d(cuboid.sizes()));
    fcl::DistanceRequestd from_outside;
    fcl::DistanceResultd distance;
    return fcl::distance(geometry_.get(), T_fixed_shape_, &upright, centre(cuboid), from_outside,
                         distance);
  }

 private:
  static Eigen::Isometry3d centre(const Eigen::AlignedBox3d& cuboid) {
    return Eigen::Isometry3d(Eigen::Translation3d(cuboid.center()));
  }

  bool collide(const Eigen::AlignedBox3d& cuboid, fcl::CollisionRequestd& request,
               fcl::CollisionResultd& result) const {
    request.gjk_solver_type = fcl::GST_LIBCCD;
    const fcl::Boxd upright(Eigen::Vector3d(cuboid.sizes()));
    return fcl::collide(geometry_.get(), T_fixed_shape_, &upright, centre(cuboid), request,
                        result) > 0;
  }

  template <typename FclShape>
  void take(const FclShape& shape) {
    geometry_ = std::make_shared<FclShape>(shape);
    bounds_ = [shape](const Eigen::Isometry3d& T_fixed_shape) {
      fcl::AABBd box;
      fcl::computeBV(shape, T_fixed_shape, box);
      return Eigen::AlignedBox3d(box.min_, box.max_);
    };
  }

  std::shared_ptr<fcl::CollisionGeometryd> geometry_;
  std::function<Eigen::AlignedBox3d(const Eigen::Isometry3d&)> bounds_;
  Eigen::Isometry3d T_link_shape_ = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_fixed_shape_ = Eigen::Isometry3d::Identity();
};

}  // namespace tccm::test
