#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tccm_monitor/check/collision_check.h"
#include "tccm_monitor/check/occlusion_check.h"
#include "tccm_monitor/check/verdict.h"
#include "tccm_monitor/robot/kinematics.h"

namespace tccm {

/// Collision and occlusion of a whole robot at one pose.
class PoseCheck {
 public:
  struct Config {
    /// How the primitives grow before they are checked for collision. The self filter erases what
    /// comes nearer than its own padding, so this one should not be much smaller.
    Expansion expansion{1.0, 0.04};
    CollisionCheck::Config collision;
    OcclusionCheck::Config occlusion;
    bool check_occlusion = true;
    /// Link names or patterns with * and ?; empty: all monitored links.
    std::vector<std::string> collision_links;
    std::vector<std::string> occlusion_links;

    /// @throws ConfigError
    void validate() const;
  };

  /// @throws ConfigError
  PoseCheck(std::shared_ptr<const RobotModel> model, const Config& config);

  /// @param positions one for each of the model's variables.
  /// @param findings reused. Contacts name the model's shapes, links the model's links.
  void check(const CuboidMap& map, const std::vector<double>& positions, const Pose& T_fixed_root,
             PoseFindings& findings);

  [[nodiscard]] const OcclusionCheck& occlusion() const { return occlusion_; }
  /// The shape that the i-th body of the occlusion picture stands for.
  [[nodiscard]] std::size_t occlusionShape(std::size_t i) const { return occlusion_shapes_[i]; }
  /// The primitives as checked for collision, at the pose of the last check.
  [[nodiscard]] const Body& collisionBody() const { return collision_body_; }
  /// The model's shape that the i-th of them stands for.
  [[nodiscard]] std::size_t collisionShape(std::size_t i) const { return collision_shapes_[i]; }
  [[nodiscard]] bool isOccluded(const LinkVisibility& link) const {
    return occlusion_.isOccluded(link);
  }

 private:
  std::shared_ptr<const RobotModel> model_;
  Config config_;
  Kinematics kinematics_;
  std::vector<std::size_t> collision_shapes_;
  std::vector<std::size_t> occlusion_shapes_;
  Body collision_body_;
  Body occlusion_body_;
  CollisionCheck collision_;
  OcclusionCheck occlusion_;
};

}  // namespace tccm
