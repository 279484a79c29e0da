#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tccm_monitor/geometry/shape.h"

namespace tccm {

/// A primitive fixed to a link.
struct LinkShape {
  std::size_t link;  ///< index into RobotModel::links()
  Shape shape;
  Pose T_link_shape;
};

/// One joint of the tree, with what moves it.
struct RobotJoint {
  enum class Motion { kFixed, kRotation, kTranslation };

  std::string name;
  Motion motion = Motion::kFixed;
  std::size_t parent = 0;  ///< link index, always below child
  std::size_t child = 0;
  Pose T_parent_joint = Pose::Identity();  ///< at position 0
  Vector3 axis = Vector3::UnitX();         ///< in the joint's frame, of length 1
  /// Index into RobotModel::variables(); of the joint it mimics, where it does.
  std::size_t variable = 0;
  double multiplier = 1.0;  ///< position = multiplier * variable + offset
  double offset = 0.0;
};

/// A joint whose position has to be known: [rad] or [m].
struct JointVariable {
  std::string name;
  std::optional<double> lower;  ///< nothing for continuous joints
  std::optional<double> upper;
};

/// The links to monitor, the primitives on them, and the joints that move them, read from a URDF.
/// Joints that move no monitored link are left out: nobody has to publish them.
class RobotModel {
 public:
  struct Config {
    /// Link names or patterns with * and ?. Empty: every link that has a collision element.
    std::vector<std::string> monitored_links;
    /// Links whose cylinders are to be capsules: the same straight part, round ends on top.
    std::vector<std::string> capsule_links;
  };

  /// @throws ConfigError naming the element, also where a pattern matches no link, or a monitored
  /// link has no collision element, a mesh, or a joint that joint states cannot place.
  RobotModel(const std::string& urdf, const Config& config);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::string& rootLink() const { return links_.front(); }
  /// Parents come before their children.
  [[nodiscard]] const std::vector<std::string>& links() const { return links_; }
  [[nodiscard]] const std::vector<RobotJoint>& joints() const { return joints_; }
  [[nodiscard]] const std::vector<JointVariable>& variables() const { return variables_; }
  /// Whether the URDF has a joint of that name, also where it moves no monitored link.
  [[nodiscard]] bool hasJoint(const std::string& joint) const {
    return all_joints_.count(joint) > 0;
  }
  [[nodiscard]] const std::vector<LinkShape>& shapes() const { return shapes_; }
  [[nodiscard]] const std::string& linkOf(std::size_t shape) const {
    return links_[shapes_[shape].link];
  }
  /// The indices of the shapes whose link matches one of the patterns; all for no patterns.
  /// @throws ConfigError naming key where a pattern matches none.
  [[nodiscard]] std::vector<std::size_t> shapesOf(const std::vector<std::string>& patterns,
                                                  const std::string& key) const;

 private:
  std::string name_;
  std::vector<std::string> links_;
  std::vector<RobotJoint> joints_;
  std::vector<JointVariable> variables_;
  std::vector<LinkShape> shapes_;
  std::set<std::string> all_joints_;
};

}  // namespace tccm
