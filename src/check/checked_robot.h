#pragma once

#include <memory>
#include <vector>

#include "check/collision_check.h"
#include "check/occlusion_check.h"
#include "robot/joint_path.h"
#include "robot/kinematics.h"
#include "robot/link_use.h"

namespace tccm {

/// The primitives that one use of a robot takes, as large as it takes them.
struct UsedBody {
  /// @throws ConfigError naming the key where a name or pattern matches no monitored link.
  UsedBody(const RobotModel& model, const LinkUse& use, const LinkUse::Keys& keys);

  void place(const Posture& posture) {
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      body.poses[i] = posture.T_fixed_shapes[shapes[i]];
    }
  }
  /// Around each shape's frame, with whatever it may grow by [m].
  [[nodiscard]] std::vector<double> radii(double growth_m) const;

  std::vector<std::size_t> shapes;   ///< indices into the model's shapes
  std::vector<std::uint32_t> links;  ///< of each of them, index into the model's links
  Body body;                         ///< one shape for each of them; not placed at first
};

/// A way of the robot among the cuboids of a map. Its roots stand still meanwhile.
struct Way {
  const CuboidMap& map;
  const JointPath& path;
  const std::vector<Pose>& T_fixed_roots;  ///< one for each of the model's roots
};

/// What all checks have to know of the robot, made once for a model and a configuration: which
/// primitives are checked, how large, what counts as a contact, and what is exempt.
class CheckedRobot {
 public:
  struct Config {
    LinkUse collision_use{Expansion{1.0, 0.03}};
    LinkUse occlusion_use;
    CollisionCheck::Config collision;
    OcclusionCheck::Config occlusion;
    bool check_occlusion = true;

    /// Whether a grasped object must be seen is decided by its link.
    Config() { occlusion_use.all_objects = false; }
    void describe(ParameterTable& table);
    /// @throws ConfigError
    void validate() const;
  };

  /// @throws ConfigError
  CheckedRobot(std::shared_ptr<const RobotModel> model, const Config& config);

  [[nodiscard]] const Config& config() const { return config_; }
  [[nodiscard]] const RobotModel& model() const { return *model_; }
  [[nodiscard]] const std::shared_ptr<const RobotModel>& sharedModel() const { return model_; }
  /// What is checked for collision, padded; to be copied and placed.
  [[nodiscard]] const UsedBody& collisionBody() const { return collision_body_; }
  /// What the sensor should see.
  [[nodiscard]] const UsedBody& occlusionBody() const { return occlusion_body_; }
  /// What counts as a contact of the collision body.
  [[nodiscard]] const CollisionCheck& collision() const { return collision_; }
  /// What shapes of the collision body may touch from now on.
  void exempt(ExemptRegions regions) { collision_.exempt(std::move(regions)); }

 private:
  std::shared_ptr<const RobotModel> model_;
  Config config_;
  UsedBody collision_body_;
  UsedBody occlusion_body_;
  CollisionCheck collision_;
};

}  // namespace tccm
