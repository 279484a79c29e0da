#pragma once

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/collision_object.h>
#include <fcl/narrowphase/distance.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "support/robot_meshes.h"

namespace tccm::test {

using JointPositions = std::map<std::string, double>;  ///< [rad] or [m]; 0 where not named

/// A robot's collision meshes themselves in FCL, placed by urdfdom's joints: nothing of the
/// project's own code decides where they are or what they touch.
class ExactRobot {
 public:
  explicit ExactRobot(const SharedRobot& robot) : urdf_(urdf::parseURDF(robot.urdf())) {
    for (const LinkMesh& mesh : collisionMeshes(*urdf_, robot)) {
      parts_.push_back({mesh.link, fcl::CollisionObjectd(modelOf(mesh.mesh))});
    }
  }

  [[nodiscard]] const urdf::ModelInterface& urdf() const { return *urdf_; }
  /// How many meshes there are.
  [[nodiscard]] std::size_t size() const { return parts_.size(); }

  void place(const JointPositions& positions) {
    for (Part& part : parts_) {
      part.object.setTransform(poseOf(*urdf_->getLink(part.link), positions));
      part.object.computeAABB();
    }
  }

  /// The centre of the box around the i-th link's mesh.
  [[nodiscard]] Vector3 centre(std::size_t i) const { return parts_[i].object.getAABB().center(); }

  /// The links whose meshes have a point in common with any of the solids.
  [[nodiscard]] std::set<std::string> touching(
      const std::vector<fcl::CollisionObjectd>& solids) const {
    std::set<std::string> links;
    for (const Part& part : parts_) {
      const bool touches = std::any_of(solids.begin(), solids.end(), [&](const auto& solid) {
        return collide(part.object, solid);
      });
      if (touches) links.insert(part.link);
    }
    return links;
  }

  /// From the link's meshes to the nearest of the solids [m].
  [[nodiscard]] double distance(const std::string& link,
                                const std::vector<fcl::CollisionObjectd>& solids) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Part& part : parts_) {
      if (part.link != link) continue;
      for (const auto& solid : solids) nearest = std::min(nearest, apart(part.object, solid));
    }
    return nearest;
  }

  /// From any of the meshes.
  [[nodiscard]] double distance(const std::vector<fcl::CollisionObjectd>& solids) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Part& part : parts_) nearest = std::min(nearest, distance(part.link, solids));
    return nearest;
  }

 private:
  using Model = fcl::BVHModel<fcl::OBBRSSd>;
  struct Part {
    std::string link;
    fcl::CollisionObjectd object;
  };

  static std::shared_ptr<Model> modelOf(const Mesh& mesh) {
    std::vector<fcl::Triangle> triangles;
    for (const Mesh::Triangle& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
    auto model = std::make_shared<Model>();
    model->beginModel();
    model->addSubModel(mesh.vertices, triangles);
    model->endModel();
    return model;
  }

  static bool collide(const fcl::CollisionObjectd& mesh, const fcl::CollisionObjectd& solid) {
    if (!mesh.getAABB().overlap(solid.getAABB())) return false;
    fcl::CollisionRequestd request;
    fcl::CollisionResultd result;
    return fcl::collide(&mesh, &solid, request, result) > 0;
  }

  static double apart(const fcl::CollisionObjectd& mesh, const fcl::CollisionObjectd& solid) {
    fcl::DistanceRequestd request;
    request.gjk_solver_type = fcl::GST_INDEP;
    fcl::DistanceResultd result;
    return std::max(0.0, fcl::distance(&mesh, &solid, request, result));
  }

  [[nodiscard]] Pose poseOf(const urdf::Link& link, const JointPositions& positions) const {
    if (!link.parent_joint) return Pose::Identity();
    const urdf::Joint& joint = *link.parent_joint;
    return poseOf(*link.getParent(), positions) * toPose(joint.parent_to_joint_origin_transform) *
           motion(joint, position(joint, positions));
  }

  [[nodiscard]] double position(const urdf::Joint& joint, const JointPositions& positions) const {
    if (joint.mimic) {
      const urdf::Joint& other = *urdf_->getJoint(joint.mimic->joint_name);
      return joint.mimic->multiplier * position(other, positions) + joint.mimic->offset;
    }
    const auto found = positions.find(joint.name);
    return found == positions.end() ? 0.0 : found->second;
  }

  static Pose motion(const urdf::Joint& joint, double position) {
    const Vector3 axis = Vector3(joint.axis.x, joint.axis.y, joint.axis.z).normalized();
    Pose pose = Pose::Identity();
    if (joint.type == urdf::Joint::PRISMATIC) pose.translation() = position * axis;
    if (joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS) {
      pose.linear() = Eigen::AngleAxisd(position, axis).toRotationMatrix();
    }
    return pose;
  }

  urdf::ModelInterfaceSharedPtr urdf_;
  std::vector<Part> parts_;
};

}  // namespace tccm::test
