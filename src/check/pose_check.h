#pragma once

#include <memory>
#include <string>
#include <vector>

#include "check/collision_check.h"
#include "check/occlusion_check.h"
#include "check/verdict.h"
#include "robot/kinematics.h"
#include "robot/link_use.h"

namespace tccm {

/// Collision and occlusion of a whole robot at one pose.
class PoseCheck {
 public:
  struct Config {
    /// What is checked for collision.
    LinkUse collision_use{Expansion{1.0, 0.03}};
    LinkUse occlusion_use = linksAlone();  ///< what the sensor should see
    CollisionCheck::Config collision;
    OcclusionCheck::Config occlusion;
    bool check_occlusion = true;

    /// @throws ConfigError
    void validate() const;

   private:
    /// Whether a grasped object must be seen is decided by its link.
    [[nodiscard]] static LinkUse linksAlone() {
      LinkUse use;
      use.all_objects = false;
      return use;
    }
  };

  /// @throws ConfigError
  PoseCheck(std::shared_ptr<const RobotModel> model, const Config& config);

  /// @param positions one for each of the model's variables. @param T_fixed_roots one for each of
  /// its roots.
  /// @param findings reused. Contacts name the model's shapes, links the model's links.
  void check(const CuboidMap& map, const std::vector<double>& positions,
             const std::vector<Pose>& T_fixed_roots, PoseFindings& findings);

  void exempt(const ExemptRegions& regions) { collision_.exempt(regions); }

  [[nodiscard]] const OcclusionCheck& occlusion() const { return occlusion_; }
  /// The shape that the i-th body of the occlusion picture stands for.
  [[nodiscard]] std::size_t occlusionShape(std::size_t i) const {
    return occlusion_used_.shapes[i];
  }
  /// The primitives as drawn for occlusion, at the pose of the last check; none where occlusion is
  /// not checked.
  [[nodiscard]] const Body& occlusionBody() const { return occlusion_body_; }
  /// The primitives as checked for collision, at the pose of the last check.
  [[nodiscard]] const Body& collisionBody() const { return collision_body_; }
  /// The model's shapes that they stand for.
  [[nodiscard]] const std::vector<std::size_t>& collisionShapes() const {
    return collision_used_.shapes;
  }
  /// The model's shape that the i-th of them stands for.
  [[nodiscard]] std::size_t collisionShape(std::size_t i) const {
    return collision_used_.shapes[i];
  }
  [[nodiscard]] bool isOccluded(const LinkVisibility& link) const {
    return occlusion_.isOccluded(link);
  }
  /// The name of the link that is occluded most; empty where none is occluded.
  [[nodiscard]] std::string mostHiddenLink(const PoseFindings& findings) const;

 private:
  std::shared_ptr<const RobotModel> model_;
  Config config_;
  Kinematics kinematics_;
  UsedShapes collision_used_;
  UsedShapes occlusion_used_;
  Body collision_body_;
  Body occlusion_body_;
  CollisionCheck collision_;
  OcclusionCheck occlusion_;
};

}  // namespace tccm
