#include "tccm_monitor/robot/robot_model.h"

#include <fnmatch.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <map>
#include <set>

#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

bool matches(const std::string& pattern, const std::string& link) {
  return fnmatch(pattern.c_str(), link.c_str(), 0) == 0;
}

bool matchesAny(const std::vector<std::string>& patterns, const std::string& link) {
  return std::any_of(patterns.begin(), patterns.end(),
                     [&](const std::string& pattern) { return matches(pattern, link); });
}

/// Every pattern has to match a link: a slip in a name must not leave a link unwatched.
void requireMatches(const std::vector<std::string>& patterns, const std::vector<std::string>& links,
                    const std::string& key) {
  for (const std::string& pattern : patterns) {
    if (!std::any_of(links.begin(), links.end(),
                     [&](const std::string& link) { return matches(pattern, link); })) {
      throw ConfigError(key + ": '" + pattern + "' matches no link of robot_description");
    }
  }
}

Pose toPose(const urdf::Pose& pose, const std::string& owner) {
  Pose result = Pose::Identity();
  const urdf::Rotation& q = pose.rotation;
  result.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
  result.translation() << pose.position.x, pose.position.y, pose.position.z;
  if (!isRigid(result)) throw ConfigError(owner + ": its origin is not finite");
  return result;
}

Shape toShape(const urdf::Geometry& geometry, bool as_capsule, const std::string& owner) {
  Shape shape = Sphere{0.0};
  switch (geometry.type) {
    case urdf::Geometry::BOX: {
      const auto& box = dynamic_cast<const urdf::Box&>(geometry);
      shape = Box{0.5 * Vector3(box.dim.x, box.dim.y, box.dim.z)};
      break;
    }
    case urdf::Geometry::CYLINDER: {
      const auto& cylinder = dynamic_cast<const urdf::Cylinder&>(geometry);
      const double half_length = 0.5 * cylinder.length;
      shape = as_capsule ? Shape(Capsule{cylinder.radius, half_length})
                         : Shape(Cylinder{cylinder.radius, half_length});
      break;
    }
    case urdf::Geometry::SPHERE:
      shape = Sphere{dynamic_cast<const urdf::Sphere&>(geometry).radius};
      break;
    default:
      throw ConfigError(
          owner +
          ": its collision element is a mesh; only box, cylinder and sphere can be "
          "monitored (leave the link out of monitored_links, or give it a primitive)");
  }
  validate(shape, owner);
  return shape;
}

std::vector<urdf::CollisionSharedPtr> collisionsOf(const urdf::Link& link) {
  std::vector<urdf::CollisionSharedPtr> found = link.collision_array;
  if (found.empty() && link.collision) found.push_back(link.collision);
  return found;
}

/// The links from the root on, parents first, children by name.
std::vector<urdf::LinkConstSharedPtr> linksInOrder(const urdf::ModelInterface& urdf) {
  std::vector<urdf::LinkConstSharedPtr> order{urdf.getRoot()};
  for (std::size_t i = 0; i < order.size(); ++i) {
    auto children = order[i]->child_links;
    std::sort(children.begin(), children.end(),
              [](const auto& a, const auto& b) { return a->name < b->name; });
    order.insert(order.end(), children.begin(), children.end());
  }
  return order;
}

/// The links on the way from the root to any of the monitored ones.
std::set<std::string> linksOnTheWay(const urdf::ModelInterface& urdf,
                                    const std::vector<std::string>& monitored) {
  std::set<std::string> kept{urdf.getRoot()->name};
  for (const std::string& name : monitored) {
    for (auto link = urdf.getLink(name); link; link = link->getParent()) kept.insert(link->name);
  }
  return kept;
}

RobotJoint::Motion motionOf(const urdf::Joint& joint) {
  switch (joint.type) {
    case urdf::Joint::FIXED:
      return RobotJoint::Motion::kFixed;
    case urdf::Joint::REVOLUTE:
    case urdf::Joint::CONTINUOUS:
      return RobotJoint::Motion::kRotation;
    case urdf::Joint::PRISMATIC:
      return RobotJoint::Motion::kTranslation;
    default:
      throw ConfigError("joint '" + joint.name +
                        "': floating and planar joints on the way to a monitored link are not "
                        "supported; let tf place the robot's root");
  }
}

JointVariable variableOf(const urdf::Joint& joint) {
  JointVariable variable{joint.name, std::nullopt, std::nullopt};
  // A <limit> that states neither end is read as 0, 0: that is no limit.
  const bool stated = joint.limits && (joint.limits->lower != 0.0 || joint.limits->upper != 0.0);
  if (joint.type != urdf::Joint::CONTINUOUS && stated) {
    variable.lower = joint.limits->lower;
    variable.upper = joint.limits->upper;
    if (!(*variable.lower <= *variable.upper)) {
      throw ConfigError("joint '" + joint.name + "': its lower limit is above its upper limit");
    }
  }
  return variable;
}

/// A joint that moves by itself, with the multiplier and offset that lead from it to a mimic.
struct Drive {
  urdf::JointConstSharedPtr joint;
  double multiplier = 1.0;
  double offset = 0.0;
};

Drive driveOf(const urdf::ModelInterface& urdf, urdf::JointConstSharedPtr joint) {
  Drive drive{joint};
  for (std::size_t hops = 0; drive.joint->mimic; ++hops) {
    const urdf::JointMimic& mimic = *drive.joint->mimic;
    const auto source = urdf.getJoint(mimic.joint_name);
    if (!source || hops > urdf.joints_.size()) {
      throw ConfigError("joint '" + joint->name + "': it mimics '" + mimic.joint_name +
                        "', which leads to no joint that moves by itself");
    }
    drive.offset += drive.multiplier * mimic.offset;
    drive.multiplier *= mimic.multiplier;
    drive.joint = source;
  }
  return drive;
}

std::vector<std::string> monitoredLinks(const std::vector<urdf::LinkConstSharedPtr>& links,
                                        const std::vector<std::string>& patterns) {
  std::vector<std::string> monitored;
  for (const auto& link : links) {
    const bool has_shape = !collisionsOf(*link).empty();
    if (patterns.empty() ? !has_shape : !matchesAny(patterns, link->name)) continue;
    if (!has_shape) {
      throw ConfigError("link '" + link->name + "': it is monitored and has no collision element");
    }
    monitored.push_back(link->name);
  }
  if (monitored.empty()) throw ConfigError("robot_description: no link has a collision element");
  return monitored;
}

std::vector<std::string> namesOf(const std::vector<urdf::LinkConstSharedPtr>& links) {
  std::vector<std::string> names;
  for (const auto& link : links) names.push_back(link->name);
  return names;
}

/// Joints in the order of their child links, and the variables that move them.
class TreeBuilder {
 public:
  TreeBuilder(const urdf::ModelInterface& urdf, std::vector<std::string> links)
      : urdf_(urdf), links_(std::move(links)) {
    for (std::size_t i = 1; i < links_.size(); ++i) addJointTo(i);
  }
  std::vector<RobotJoint> joints;
  std::vector<JointVariable> variables;

 private:
  void addJointTo(std::size_t child) {
    const auto urdf_joint = urdf_.getLink(links_[child])->parent_joint;
    RobotJoint joint;
    joint.name = urdf_joint->name;
    joint.motion = motionOf(*urdf_joint);
    joint.child = child;
    joint.parent = indexOf(urdf_joint->parent_link_name);
    joint.T_parent_joint =
        toPose(urdf_joint->parent_to_joint_origin_transform, "joint '" + urdf_joint->name + "'");
    if (joint.motion != RobotJoint::Motion::kFixed) addMotion(urdf_joint, joint);
    joints.push_back(joint);
  }

  void addMotion(const urdf::JointConstSharedPtr& urdf_joint, RobotJoint& joint) {
    joint.axis << urdf_joint->axis.x, urdf_joint->axis.y, urdf_joint->axis.z;
    const double length = joint.axis.norm();
    if (!(length > 1e-6) || !joint.axis.allFinite()) {
      throw ConfigError("joint '" + joint.name + "': its axis has no direction");
    }
    joint.axis /= length;
    const Drive drive = driveOf(urdf_, urdf_joint);
    joint.multiplier = drive.multiplier;
    joint.offset = drive.offset;
    joint.variable = variableIndex(*drive.joint);
  }

  std::size_t variableIndex(const urdf::Joint& joint) {
    const auto found = std::find_if(variables.begin(), variables.end(),
                                    [&](const auto& v) { return v.name == joint.name; });
    if (found != variables.end()) return static_cast<std::size_t>(found - variables.begin());
    variables.push_back(variableOf(joint));
    return variables.size() - 1;
  }

  [[nodiscard]] std::size_t indexOf(const std::string& link) const {
    return static_cast<std::size_t>(std::find(links_.begin(), links_.end(), link) - links_.begin());
  }

  const urdf::ModelInterface& urdf_;
  std::vector<std::string> links_;
};

}  // namespace

RobotModel::RobotModel(const std::string& urdf_text, const Config& config) {
  const urdf::ModelInterfaceSharedPtr urdf = urdf::parseURDF(urdf_text);
  if (!urdf || !urdf->getRoot()) throw ConfigError("robot_description: it is not a valid URDF");
  name_ = urdf->getName();
  for (const auto& joint : urdf->joints_) all_joints_.insert(joint.first);
  const auto all_links = linksInOrder(*urdf);
  requireMatches(config.monitored_links, namesOf(all_links), "monitored_links");
  requireMatches(config.capsule_links, namesOf(all_links), "capsule_links");
  const auto monitored = monitoredLinks(all_links, config.monitored_links);
  const auto kept = linksOnTheWay(*urdf, monitored);
  for (const auto& link : all_links) {
    if (kept.count(link->name) > 0) links_.push_back(link->name);
  }
  TreeBuilder tree(*urdf, links_);
  joints_ = std::move(tree.joints);
  variables_ = std::move(tree.variables);
  for (std::size_t i = 0; i < links_.size(); ++i) {
    if (std::find(monitored.begin(), monitored.end(), links_[i]) == monitored.end()) continue;
    const std::string owner = "link '" + links_[i] + "'";
    for (const auto& collision : collisionsOf(*urdf->getLink(links_[i]))) {
      if (!collision->geometry) throw ConfigError(owner + ": its collision element has no shape");
      shapes_.push_back(
          {i, toShape(*collision->geometry, matchesAny(config.capsule_links, links_[i]), owner),
           toPose(collision->origin, owner)});
    }
  }
}

std::vector<std::size_t> RobotModel::shapesOf(const std::vector<std::string>& patterns,
                                              const std::string& key) const {
  std::vector<std::string> shape_links;
  for (const LinkShape& shape : shapes_) shape_links.push_back(links_[shape.link]);
  requireMatches(patterns, shape_links, key);
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    if (patterns.empty() || matchesAny(patterns, shape_links[i])) found.push_back(i);
  }
  return found;
}

}  // namespace tccm
