#pragma once

#include <memory>
#include <string>
#include <vector>

#include "check/collision_check.h"
#include "check/occlusion_check.h"
#include "check/surroundings.h"
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

/// A way of the robot among obstacles. Its roots stand still meanwhile.
struct Way {
  Obstacles obstacles;
  const JointPath& path;
  const std::vector<Pose>& T_fixed_roots;  ///< one for each of the model's roots
};

/// What all checks have to know of the robot, made once for a model and a configuration: which
/// primitives are checked, how large, what counts as a contact, and what is exempt.
struct CheckedRobot {
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
  CheckedRobot(std::shared_ptr<const RobotModel> of_model, const Config& new_config);

  std::shared_ptr<const RobotModel> model;
  Config config;
  UsedBody collision_body;   ///< what is checked for collision, padded; to be copied and placed
  UsedBody occlusion_body;   ///< what the sensor should see
  CollisionCheck collision;  ///< what counts as a contact of the collision body, and what is exempt
};

/// Collision, occlusion and clearance of a whole robot at one pose.
class PoseCheck {
 public:
  /// @param old_periods looks that are older than so many tilt periods say nothing.
  PoseCheck(std::shared_ptr<const CheckedRobot> robot, double old_periods);

  /// Where the robot is from now on. The reference is valid until the next call.
  const Posture& place(const std::vector<double>& positions,
                       const std::vector<Pose>& T_fixed_roots);
  [[nodiscard]] const Posture& posture() const { return kinematics_.posture(); }

  /// @param findings reused. Contacts name the model's shapes, links the model's links.
  void check(const Surroundings& around, PoseFindings& findings);
  /// The parts of it, in this order.
  void findContacts(const Surroundings& around, PoseFindings& findings) const;
  void findOcclusion(const Surroundings& around, PoseFindings& findings);
  /// The same at this pose and at one of the same robot ahead: what stands at both is looked at
  /// once.
  void findOcclusion(const Surroundings& around, PoseFindings& findings, const PoseCheck& ahead,
                     PoseFindings& ahead_findings);

  /// The distance from each link that is checked for collision to the nearest cuboid or region, in
  /// the order of their first primitives: of the primitives as they are, without padding. Only
  /// cuboids with enough support count, as for contacts. The reference is valid until the next
  /// call.
  /// @param radius_m what is further away is not looked for.
  const std::vector<LinkClearance>& findClearances(const Surroundings& around, double radius_m);
  /// The least of all links; infinite where nothing lies within the radius. Faster.
  [[nodiscard]] double leastClearance(const Surroundings& around, double radius_m) const;

  [[nodiscard]] const OcclusionCheck& occlusion() const { return occlusion_; }
  /// The primitives as checked for collision, and as drawn for occlusion.
  [[nodiscard]] const UsedBody& collisionBody() const { return collision_body_; }
  [[nodiscard]] const UsedBody& occlusionBody() const { return occlusion_body_; }
  [[nodiscard]] bool isOccluded(const LinkVisibility& link) const {
    return occlusion_.isOccluded(link);
  }
  /// The name of the link that is occluded most; empty where none is occluded.
  [[nodiscard]] std::string mostHiddenLink(const PoseFindings& findings) const;

 private:
  /// @param i index into the collision body's shapes.
  [[nodiscard]] LinkClearance nearest(const Surroundings& around, std::size_t i,
                                      double nearer_than_m) const;
  /// @param contacts as a check finds them: names the model's shapes.
  void nameShapes(std::vector<Contact>& contacts) const;

  std::shared_ptr<const CheckedRobot> robot_;
  Kinematics kinematics_;
  UsedBody collision_body_;
  UsedBody occlusion_body_;
  OcclusionCheck occlusion_;
  std::vector<LinkClearance> clearances_;
  std::vector<std::size_t> clearance_of_shape_;  ///< index into clearances_, by the body's shapes
};

/// Whether the check finds what it is there for: a virtual cuboid is put into the middle of each of
/// the primitives that are to be checked for collision, and has to be found as a contact of its
/// link. A checker that silently does not check is worse than none.
/// @return the links whose cuboid was not found; none where all is well.
[[nodiscard]] std::vector<std::string> selfTest(const CheckedRobot& robot, PoseCheck& check);

}  // namespace tccm
