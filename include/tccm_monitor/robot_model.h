#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tccm_monitor/shape.h"

namespace tccm {

class LinkSelector;
class ParameterTable;
struct LinkGeometry;
struct LinkUse;
struct LinkUseKeys;
struct UsedShapes;

/// A primitive fixed to a link.
struct LinkShape {
  std::size_t link;  ///< index into RobotModel::links()
  Shape shape;
  Pose T_link_shape;
  std::string object = {};  ///< the grasped object it belongs to; empty: the robot itself
};

/// One element of a link's geometry as the URDF states it, and what stands for it.
struct LinkElement {
  std::size_t link = 0;  ///< index into RobotModel::links()
  std::string source;    ///< "box", "cylinder", "sphere", "mesh" or "file" (primitives_file)
  std::string uri;       ///< of a mesh
  Vector3 mesh_scale = Vector3::Ones();
  bool mesh_up_axis = false;    ///< Config::apply_mesh_up_axis
  double mesh_longest_m = 0.0;  ///< the longest side of the upright box around a mesh, scaled
  Pose T_link_element = Pose::Identity();
  std::size_t first_shape = 0;  ///< index into RobotModel::shapes()
  std::size_t shapes = 0;
  double hull_volume_m3 = 0.0;  ///< of the mesh's convex hull, or of the primitive itself
  double overhang_m = 0.0;      ///< as in PrimitiveFit
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
  std::optional<double> speed_max;  ///< [rad/s or m/s]; nothing where the URDF states none above 0
};

/// The links that are monitored, and those on the way to them from the next link that transforms
/// place.
struct JointTree {
  std::vector<std::string> links;  ///< parents first
  std::vector<std::size_t> roots;
  std::vector<RobotJoint> joints;  ///< in the order of their child links
  std::vector<JointVariable> variables;
  /// What is taken otherwise than it stands in the URDF, one line each.
  std::vector<std::string> warnings;

  /// Whether a variable is the same after a whole turn: a rotation without limits, and no mimic of
  /// it turns by a part of a turn meanwhile.
  [[nodiscard]] bool turnsFreely(std::size_t variable) const;
};

/// What the robot holds: it moves with a link.
struct AttachedObject {
  std::string name;
  std::string link;
  PlacedShape primitive;  ///< in the link's frame
};

/// What an arm controller is told to do (trajectory_msgs/JointTrajectory without its header).
struct JointTrajectory {
  struct Point {
    double time_s = 0.0;                ///< from the trajectory's start
    std::vector<double> positions;      ///< [rad or m], one for each name
    std::vector<double> velocities;     ///< the same, or empty
    std::vector<double> accelerations;  ///< the same, or empty
  };
  std::vector<std::string> names;
  std::vector<Point> points;
};

/// What became of a message of joint states.
struct AddedJoints {
  std::size_t taken = 0;  ///< positions of joints that matter
  /// Of those that matter: not finite, beyond 1e6, or not newer than the last.
  std::size_t refused = 0;
};

/// The bytes of what a URI, such as package://robot/meshes/arm.stl, stands for.
/// Throws ConfigError "uri: why" where it cannot be had.
using ReadResource = std::function<std::string(const std::string& uri)>;

/// Where a model finds what its URDF refers to.
struct RobotResources {
  ReadResource read;             ///< without it, what refers to files is refused
  std::string fit_cache_folder;  ///< empty: fits are not kept
  /// Told before each mesh: how many are done, of how many. May be empty.
  std::function<void(std::size_t done, std::size_t all)> progress;
};

/// The links to monitor, the primitives on them, and the joints that move them, read from a URDF.
/// Joints that move no monitored link are left out: nobody has to publish them. Meshes are covered
/// by a few primitives each.
///
/// Links under a floating or planar joint cannot be placed by joint states. Such a link is a root
/// of its own, which transforms have to place, as they place the robot's root.
class RobotModel {
 public:
  struct Config {  ///< describe() says what each means
    std::map<std::string, std::vector<std::string>> link_groups;
    std::vector<std::string> monitored_links;
    std::vector<std::string> ignored_links;
    std::vector<std::string> capsule_links;
    std::vector<std::string> visual_links;
    std::map<std::string, double> fixed_joints;
    std::vector<std::string> trusted_frames;
    std::string tf_prefix;
    std::string primitives_file;
    bool apply_mesh_up_axis = false;
    double link_size_max_m = 3.0;
    PrimitiveFitConfig fit;

    void describe(ParameterTable& table);
    /// All of it as text, numbers to 15 digits: equal where the configurations are.
    [[nodiscard]] std::string text() const;
  };

  /// @throws ConfigError naming the element, also where a pattern matches no link, or a monitored
  /// link has no shape, one that cannot be read, or one that is too large or too small to be meant.
  RobotModel(const std::string& urdf, const Config& config, const RobotResources& resources = {});

  [[nodiscard]] const std::string& name() const { return name_; }
  /// Parents come before their children.
  [[nodiscard]] const std::vector<std::string>& links() const { return tree_.links; }
  /// Indices of the links that transforms have to place; the robot's own root alone, unless there
  /// are floating or planar joints.
  [[nodiscard]] const std::vector<std::size_t>& roots() const { return tree_.roots; }
  [[nodiscard]] std::vector<std::string> rootLinks() const;
  /// The same as transforms call them.
  [[nodiscard]] const std::vector<std::string>& rootFrames() const { return root_frames_; }
  /// What transforms call a link: with the prefix, and without a slash in front.
  [[nodiscard]] std::string frameOf(const std::string& link) const;
  [[nodiscard]] const std::vector<RobotJoint>& joints() const { return tree_.joints; }
  [[nodiscard]] const std::vector<JointVariable>& variables() const { return tree_.variables; }
  [[nodiscard]] bool turnsFreely(std::size_t variable) const { return tree_.turnsFreely(variable); }
  /// All links of the URDF that can be placed, monitored or not, to compare them with transforms. A
  /// trusted link is a root in it.
  [[nodiscard]] const JointTree& frames() const { return frames_; }
  /// Whether a variable is in metres: its own joint slides, or the first that mimics it.
  [[nodiscard]] bool slides(std::size_t variable) const;
  /// Whether the URDF has a joint of that name, also where it moves no monitored link.
  [[nodiscard]] bool hasJoint(const std::string& joint) const {
    return all_joints_.count(joint) > 0;
  }
  /// Joints that are where the configuration says, whatever is published.
  [[nodiscard]] const std::map<std::string, double>& fixedJoints() const { return fixed_joints_; }
  [[nodiscard]] const std::vector<LinkShape>& shapes() const { return shapes_; }
  [[nodiscard]] const std::string& linkOf(std::size_t shape) const {
    return tree_.links[shapes_[shape].link];
  }
  [[nodiscard]] const std::vector<LinkElement>& elements() const { return elements_; }
  /// Links of the URDF that have no shape and are not watched therefore.
  [[nodiscard]] const std::vector<std::string>& linksWithoutShape() const {
    return links_without_shape_;
  }
  /// What of the URDF and its meshes is taken otherwise than it stands, or left out: one line each.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
  /// Why fits could not be kept for the next start; empty where they could.
  [[nodiscard]] const std::string& cacheDefect() const { return cache_defect_; }

  /// @throws ConfigError naming the key where a name or pattern matches no monitored link.
  [[nodiscard]] UsedShapes shapesFor(const LinkUse& use, const LinkUseKeys& keys) const;

  /// The same robot with something in its hand. Joints, links and variables keep their indices.
  /// @throws ConfigError where the link is not among links(), or the primitive is not valid or
  /// reaches further than 3 m from its link.
  [[nodiscard]] RobotModel holding(const std::vector<AttachedObject>& objects) const;

 private:
  void add(const std::string& link, const LinkGeometry& geometry);
  [[nodiscard]] std::set<std::string> trustedAmong(const std::vector<std::string>& links,
                                                   const Config& config);

  std::string name_;
  std::shared_ptr<const LinkSelector> selector_;
  JointTree tree_;
  JointTree frames_;
  std::string tf_prefix_;
  std::vector<std::string> root_frames_;
  std::vector<LinkShape> shapes_;
  std::vector<LinkElement> elements_;
  std::vector<std::string> links_without_shape_;
  std::set<std::string> all_joints_;
  std::map<std::string, double> fixed_joints_;
  std::vector<std::string> warnings_;
  std::string cache_defect_;
};

}  // namespace tccm
