#include "robot/urdf_reader.h"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <set>

#include "base/printable.h"
#include "robot/urdf_text.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr double kMultiplierMax = 1e6;   // of a mimic joint; beyond it is a slip
constexpr std::size_t kMimicsMax = 100;  // one after the other
constexpr double kFurthest = 1e6;        // [m]; beyond it is a slip, and sums would end at infinity

/// Catches what urdfdom logs while it parses: only there it says which element is wrong.
class ErrorCatcher : public console_bridge::OutputHandler {
 public:
  ErrorCatcher() {
    console_bridge::useOutputHandler(this);
    console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_ERROR);
  }
  ~ErrorCatcher() override {
    console_bridge::setLogLevel(level_);
    console_bridge::restorePreviousOutputHandler();
  }
  ErrorCatcher(const ErrorCatcher&) = delete;
  ErrorCatcher& operator=(const ErrorCatcher&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char* /*file*/,
           int /*line*/) override {
    constexpr std::size_t kKept = 3;
    if (level < console_bridge::CONSOLE_BRIDGE_LOG_ERROR || count_++ >= kKept) return;
    errors_ += (errors_.empty() ? "" : "; ") + text;
  }
  [[nodiscard]] const std::string& errors() const { return errors_; }

 private:
  inline static std::mutex mutex_;
  std::lock_guard<std::mutex> lock_{mutex_};
  console_bridge::LogLevel level_ = console_bridge::getLogLevel();
  std::size_t count_ = 0;
  std::string errors_;
};

[[noreturn]] void refuse(const urdf::Joint& joint, const std::string& why) {
  throw ConfigError("joint '" + joint.name + "': " + why);
}

/// Whether joint states say where the joint's child is; not so for floating and planar joints.
bool isPlacedByJointStates(const urdf::Joint& joint) {
  return joint.type != urdf::Joint::FLOATING && joint.type != urdf::Joint::PLANAR;
}

RobotJoint::Motion motionOf(const urdf::Joint& joint) {
  if (joint.type == urdf::Joint::FIXED) return RobotJoint::Motion::kFixed;
  if (joint.type == urdf::Joint::PRISMATIC) return RobotJoint::Motion::kTranslation;
  const bool turns = joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS;
  if (!turns) refuse(joint, "its type is unknown");
  return RobotJoint::Motion::kRotation;
}

JointVariable variableOf(const urdf::Joint& joint) {
  JointVariable variable{joint.name, std::nullopt, std::nullopt, std::nullopt};
  if (joint.limits && joint.limits->velocity > 0.0 && std::isfinite(joint.limits->velocity)) {
    variable.speed_max = joint.limits->velocity;
  }
  // A <limit> that states neither end is read as 0, 0: that is no limit.
  const bool stated = joint.limits && (joint.limits->lower != 0.0 || joint.limits->upper != 0.0);
  if (joint.type != urdf::Joint::CONTINUOUS && stated) {
    variable.lower = joint.limits->lower;
    variable.upper = joint.limits->upper;
    if (!(*variable.lower <= *variable.upper)) {
      refuse(joint, "its lower limit is above its upper limit");
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

Drive driveOf(const urdf::ModelInterface& urdf, const urdf::JointConstSharedPtr& joint) {
  Drive drive{joint};
  for (std::size_t hops = 0; drive.joint->mimic; ++hops) {
    const urdf::JointMimic& mimic = *drive.joint->mimic;
    const auto source = urdf.getJoint(mimic.joint_name);
    if (!source || hops == kMimicsMax) {
      refuse(*joint, "it mimics '" + mimic.joint_name +
                         "', which leads to no joint that moves by itself within 100 mimics");
    }
    drive.offset += drive.multiplier * mimic.offset;
    drive.multiplier *= mimic.multiplier;
    drive.joint = source;
  }
  if (!(std::abs(drive.multiplier) <= kMultiplierMax && std::abs(drive.offset) <= kMultiplierMax)) {
    refuse(*joint, "the multiplier or offset of its mimic is out of all range");
  }
  if (!isPlacedByJointStates(*drive.joint) || drive.joint->type == urdf::Joint::FIXED) {
    refuse(*joint, "it mimics '" + drive.joint->name + "', which has no position of its own");
  }
  return drive;
}

/// Which of the trusted links are roots.
enum class TrustedRoots { kUnmoved, kAll };

class TreeBuilder {
 public:
  TreeBuilder(const urdf::ModelInterface& urdf, const JointFacts& facts, TrustedRoots trusted_roots)
      : urdf_(urdf), facts_(facts), trusted_roots_(trusted_roots) {
    for (const auto& [joint, position] : facts_.fixed_joints) requireMovable(joint, position);
  }

  JointTree build(const std::vector<std::string>& monitored) {
    std::set<std::string> kept;
    for (const std::string& name : monitored) {
      const urdf::Link* link = urdf_.getLink(name).get();
      // Above a link that is kept already all are.
      while (kept.insert(link->name).second && !isRoot(*link)) link = link->getParent().get();
    }
    for (const auto& link : linksInOrder(urdf_)) {
      if (kept.count(link->name) > 0) addLink(*link);
    }
    return std::move(tree_);
  }

  JointTree buildAll() {
    for (const auto& link : linksInOrder(urdf_)) {
      const bool hangs = isRoot(*link) || link_indices_.count(link->getParent()->name) > 0;
      if (!hangs) continue;
      try {
        addLink(*link);
      } catch (const ConfigError&) {
        // Of a monitored link it is a refusal elsewhere; of another nobody has to know.
      }
    }
    return std::move(tree_);
  }

 private:
  /// Whether transforms have to place the link.
  [[nodiscard]] bool isRoot(const urdf::Link& link) const {
    if (!link.parent_joint || !isPlacedByJointStates(*link.parent_joint)) return true;
    if (facts_.trusted.count(link.name) == 0) return false;
    return trusted_roots_ == TrustedRoots::kAll || !isMoved(link);
  }

  /// Whether a joint moves the link against the root above it.
  [[nodiscard]] bool isMoved(const urdf::Link& link) const {
    const urdf::Link* at = &link;
    for (; at->parent_joint && isPlacedByJointStates(*at->parent_joint);
         at = at->getParent().get()) {
      const urdf::Joint& above = *at->parent_joint;
      const bool is_fixed =
          above.type == urdf::Joint::FIXED || facts_.fixed_joints.count(above.name) > 0;
      if (!is_fixed) return true;
    }
    return false;
  }

  void requireMovable(const std::string& name, double position) const {
    const std::string key = "fixed_joints/" + name;
    const auto joint = urdf_.getJoint(name);
    if (!joint) throw ConfigError(key + ": robot_description has no such joint");
    if (joint->mimic) throw ConfigError(key + ": it mimics '" + joint->mimic->joint_name + "'");
    if (!isPlacedByJointStates(*joint) || joint->type == urdf::Joint::FIXED) {
      throw ConfigError(key + ": the joint has no position");
    }
    const JointVariable variable = variableOf(*joint);
    requireInRange(key, position, variable.lower.value_or(-1e6), variable.upper.value_or(1e6));
  }

  void addLink(const urdf::Link& link) {
    const std::size_t index = tree_.links.size();
    if (isRoot(link)) {
      tree_.roots.push_back(index);
    } else {
      tree_.joints.push_back(jointAbove(link, index));
    }
    tree_.links.push_back(link.name);
    link_indices_.emplace(link.name, index);
    if (!isRoot(link) && facts_.trusted.count(link.name) > 0) {
      tree_.warnings.push_back("link '" + link.name +
                               "': a joint moves it, so that it is checked where the URDF has it; "
                               "trusted_frames only keeps it from being compared with tf");
    }
  }

  RobotJoint jointAbove(const urdf::Link& link, std::size_t index) {
    const urdf::Joint& above = *link.parent_joint;
    RobotJoint joint;
    joint.name = above.name;
    joint.motion = motionOf(above);
    joint.child = index;
    joint.parent = link_indices_.at(above.parent_link_name);
    joint.T_parent_joint =
        toPose(above.parent_to_joint_origin_transform, "joint '" + above.name + "'");
    if (joint.motion != RobotJoint::Motion::kFixed) addMotion(link.parent_joint, joint);
    return joint;
  }

  void addMotion(const urdf::JointConstSharedPtr& urdf_joint, RobotJoint& joint) {
    joint.axis << urdf_joint->axis.x, urdf_joint->axis.y, urdf_joint->axis.z;
    const double length = joint.axis.norm();
    const bool turns_nothing = joint.motion == RobotJoint::Motion::kRotation && length == 0.0;
    if (!turns_nothing && !(length > 1e-6 && std::isfinite(length))) {
      refuse(*urdf_joint, "its axis has no direction");
    }
    const Drive drive = driveOf(urdf_, urdf_joint);
    if (turns_nothing) {
      joint.motion = RobotJoint::Motion::kFixed;
      joint.axis = Vector3::UnitX();
      tree_.warnings.push_back("joint '" + joint.name +
                               "': its axis is 0 0 0; it is taken for a fixed joint");
      return;
    }
    joint.axis /= length;
    joint.multiplier = drive.multiplier;
    joint.offset = drive.offset;
    const auto fixed = facts_.fixed_joints.find(drive.joint->name);
    if (fixed == facts_.fixed_joints.end()) {
      joint.variable = variableIndex(*drive.joint);
      return;
    }
    const double position = joint.multiplier * fixed->second + joint.offset;
    joint.T_parent_joint =
        joint.T_parent_joint * (joint.motion == RobotJoint::Motion::kRotation
                                    ? Pose(Eigen::AngleAxisd(position, joint.axis))
                                    : Pose(Eigen::Translation3d(position * joint.axis)));
    joint.motion = RobotJoint::Motion::kFixed;
  }

  std::size_t variableIndex(const urdf::Joint& joint) {
    const auto [entry, is_new] = variable_indices_.emplace(joint.name, tree_.variables.size());
    if (is_new) tree_.variables.push_back(variableOf(joint));
    return entry->second;
  }

  const urdf::ModelInterface& urdf_;
  const JointFacts& facts_;
  TrustedRoots trusted_roots_;
  JointTree tree_;
  std::map<std::string, std::size_t> link_indices_;
  std::map<std::string, std::size_t> variable_indices_;
};

}  // namespace

ReadUrdf readUrdf(const std::string& text) {
  CheckedUrdf checked = checkedUrdf(text);
  urdf::ModelInterfaceSharedPtr urdf;
  std::string why;
  ErrorCatcher catcher;
  try {
    urdf = urdf::parseURDF(checked.xml);
    why = catcher.errors();
  } catch (const std::exception& error) {
    why = error.what();
  }
  // Of a link with a fault, urdfdom drops what comes after it, collision elements too, and goes on.
  if (urdf && urdf->getRoot() && why.empty()) {
    return {urdf, std::move(checked.visual_defects)};
  }
  throw ConfigError("robot_description: it is not a valid URDF" +
                    (why.empty() ? "" : ": " + printable(why)));
}

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

Pose toPose(const urdf::Pose& pose, const std::string& owner) {
  Pose result = Pose::Identity();
  const urdf::Rotation& q = pose.rotation;
  result.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
  result.translation() << pose.position.x, pose.position.y, pose.position.z;
  if (!isRigid(result) || result.translation().cwiseAbs().maxCoeff() > kFurthest) {
    throw ConfigError(owner + ": its origin is not finite, or beyond 1000 km");
  }
  return result;
}

JointTree buildJointTree(const urdf::ModelInterface& urdf,
                         const std::vector<std::string>& monitored, const JointFacts& facts) {
  return TreeBuilder(urdf, facts, TrustedRoots::kUnmoved).build(monitored);
}

JointTree buildFrameTree(const urdf::ModelInterface& urdf, const JointFacts& facts) {
  return TreeBuilder(urdf, facts, TrustedRoots::kAll).buildAll();
}

}  // namespace tccm
