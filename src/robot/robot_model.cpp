#include "tccm_monitor/robot_model.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/frame_name.h"
#include "base/line_of.h"
#include "base/printable.h"
#include "config/parameter_table.h"
#include "robot/geometry_reader.h"
#include "robot/link_use.h"
#include "robot/urdf_reader.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

/// [m]; what is larger would be filtered out of scans with half of the surroundings.
constexpr double kObjectReachMax = 3.0;
constexpr std::size_t kObjectsMax = 64;  // each costs as much as a link

using Links = std::vector<urdf::LinkConstSharedPtr>;

std::vector<std::string> namesOf(const Links& links) {
  std::vector<std::string> names;
  for (const auto& link : links) names.push_back(link->name);
  return names;
}

/// Whether the configuration asks for the link. @throws ConfigError where it does by name, and the
/// link has no shape.
bool isMonitored(const urdf::Link& link, bool has_shape, const RobotModel::Config& config,
                 const LinkSelector& selector) {
  if (selector.matches(config.ignored_links, link.name)) return false;
  const bool by_name = !config.monitored_links.empty();
  if (by_name && !selector.matches(config.monitored_links, link.name)) return false;
  if (has_shape || !by_name) return has_shape;
  throw ConfigError("link '" + link.name +
                    "': it is monitored and has no collision element (give it a primitive, name "
                    "it in visual_links, or in ignored_links)");
}

}  // namespace

RobotModel::RobotModel(const std::string& urdf_text, const Config& config,
                       const RobotResources& resources) try {
  static_cast<void>(validated(config));
  const ReadUrdf urdf = readUrdf(urdf_text);
  name_ = urdf.model->getName();
  for (const auto& joint : urdf.model->joints_) all_joints_.insert(joint.first);
  fixed_joints_ = config.fixed_joints;
  tf_prefix_ = config.tf_prefix;
  const Links all_links = linksInOrder(*urdf.model);
  selector_ = std::make_shared<const LinkSelector>(config.link_groups, namesOf(all_links));
  selector_->requireMatches(config.monitored_links, "monitored_links");
  selector_->requireMatches(config.ignored_links, "ignored_links");
  selector_->requireMatches(config.capsule_links, "capsule_links");
  selector_->requireMatches(config.visual_links, "visual_links");
  GeometryReader reader(urdf, config, resources, *selector_);
  Links candidates;
  for (const auto& link : all_links) {
    const bool has_shape = reader.hasShape(*link);
    if (!has_shape) links_without_shape_.push_back(link->name);
    if (isMonitored(*link, has_shape, config, *selector_)) candidates.push_back(link);
  }
  const std::vector<LinkGeometry> geometries = reader.read(candidates);
  std::vector<std::string> monitored;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const bool has_shape = !geometries[i].shapes.empty();
    if (!has_shape) links_without_shape_.push_back(candidates[i]->name);
    if (isMonitored(*candidates[i], has_shape, config, *selector_)) {
      monitored.push_back(candidates[i]->name);
    }
  }
  if (monitored.empty()) {
    throw ConfigError("robot_description: no link to monitor has a collision element");
  }
  const JointFacts facts{config.fixed_joints, trustedAmong(namesOf(all_links), config)};
  tree_ = buildJointTree(*urdf.model, monitored, facts);
  for (const std::size_t root : tree_.roots) root_frames_.push_back(frameOf(tree_.links[root]));
  frames_ = buildFrameTree(*urdf.model, facts);
  warnings_.insert(warnings_.end(), tree_.warnings.begin(), tree_.warnings.end());
  for (std::size_t i = 0; i < candidates.size(); ++i) add(candidates[i]->name, geometries[i]);
  cache_defect_ = reader.cacheDefect();
} catch (const ConfigError& error) {
  throw ConfigError(printable(error.what(), kLineMax));  // names may hold anything
}

/// They may be called as tf calls them, too.
std::set<std::string> RobotModel::trustedAmong(const std::vector<std::string>& links,
                                               const Config& config) {
  std::set<std::string> trusted;
  for (const std::string& entry : config.trusted_frames) {
    bool means_one = false;
    for (const std::string& link : links) {
      if (!selector_->matches({entry}, link) && !selector_->matches({entry}, frameOf(link)))
        continue;
      trusted.insert(link);
      means_one = true;
    }
    if (means_one) continue;
    warnings_.push_back("trusted_frames: '" + entry +
                        "' matches no link: what the URDF does not know is not compared anyway");
  }
  return trusted;
}

void RobotModel::add(const std::string& link, const LinkGeometry& geometry) {
  warnings_.insert(warnings_.end(), geometry.warnings.begin(), geometry.warnings.end());
  if (geometry.shapes.empty()) return;
  const auto found = std::find(tree_.links.begin(), tree_.links.end(), link);
  const auto index = static_cast<std::size_t>(found - tree_.links.begin());
  const std::size_t first_shape = shapes_.size();
  for (const PlacedShape& placed : geometry.shapes) {
    shapes_.push_back({index, placed.shape, placed.pose});
  }
  for (LinkElement element : geometry.elements) {
    element.link = index;
    element.first_shape += first_shape;
    elements_.push_back(std::move(element));
  }
}

void RobotModel::Config::describe(ParameterTable& table) {
  table.add("link_groups", &link_groups,
            "names for lists of links, as `{arms: [l_*, r_*]}`, to be used in all other lists");
  table.add("monitored_links", &monitored_links,
            "links to filter out and to watch; empty: every link that has a shape; one that has "
            "none is refused");
  table.add("ignored_links", &ignored_links, "taken out again");
  table.add("capsule_links", &capsule_links,
            "links whose cylinders are to be capsules, with the cylinder as straight part");
  table.add("visual_links", &visual_links,
            "links whose visual geometry is taken in place of their collision elements");
  table.add("fixed_joints", &fixed_joints,
            "positions [rad or m] of joints that nobody publishes, as `{head_lock_joint: 0.0}`");
  table.add("trusted_frames", &trusted_frames,
            "links that tf places better than the URDF does: they are not compared with it, and "
            "what hangs below them is compared from there on; one that no joint moves is placed "
            "by tf");
  table.add("tf_prefix", &tf_prefix,
            "robot_state_publisher's: tf calls a link by it, a slash and the link's name; "
            "`fixed_frame` is a name of tf");
  table.add("primitives_file", &primitives_file,
            "path or URI of primitives in place of links' own shapes, as fit_primitives writes it");
  table.add("apply_mesh_up_axis", &apply_mesh_up_axis,
            "turns COLLADA meshes by the up axis they state; rviz and MoveIt do not");
  table.add("link_size_max_m", &link_size_max_m, "m", {0.01, 1000.0},
            "a robot of which one mesh or primitive is longer is refused: its unit is wrong, most "
            "likely");
  fit.describe(table);
}

std::string RobotModel::Config::text() const {
  Config copy = *this;
  return tableOf(copy).yaml() + textOf(&copy.fit.margin_m);  // which is no parameter
}

std::vector<std::string> RobotModel::rootLinks() const {
  std::vector<std::string> names;
  for (const std::size_t root : tree_.roots) names.push_back(tree_.links[root]);
  return names;
}

/// As robot_state_publisher has it: a name that begins with a slash takes no prefix.
std::string RobotModel::frameOf(const std::string& link) const {
  const bool takes_prefix = !tf_prefix_.empty() && (link.empty() || link.front() != '/');
  return withoutSlash(takes_prefix ? tf_prefix_ + "/" + link : link);
}

UsedShapes RobotModel::shapesFor(const LinkUse& use, const LinkUseKeys& keys) const {
  std::vector<std::string> shape_links;
  for (const LinkShape& shape : shapes_) shape_links.push_back(tree_.links[shape.link]);
  selector_->requireMatches(use.links, shape_links, keys.links);
  selector_->requireMatches(use.ignored, shape_links, keys.ignored);
  for (const LinkUse::Exception& exception : use.exceptions) {
    selector_->requireMatches(exception.links, shape_links, keys.exceptions);
  }
  UsedShapes used;
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    const std::string& link = shape_links[i];
    if (!(use.all_objects && !shapes_[i].object.empty())) {
      if (!use.links.empty() && !selector_->matches(use.links, link)) continue;
      if (selector_->matches(use.ignored, link)) continue;
    }
    Expansion expansion = use.expansion;
    for (const LinkUse::Exception& exception : use.exceptions) {
      if (!selector_->matches(exception.links, link)) continue;
      expansion.scale = exception.scale.value_or(use.expansion.scale);
      expansion.padding_m = exception.padding_m.value_or(use.expansion.padding_m);
    }
    used.shapes.push_back(i);
    used.expansions.push_back(expansion);
  }
  if (used.shapes.empty()) throw ConfigError(keys.ignored + ": no link is left");
  return used;
}

RobotModel RobotModel::holding(const std::vector<AttachedObject>& objects) const {
  RobotModel model = *this;
  if (objects.size() > kObjectsMax) {
    throw ConfigError(
        lineOf("object '%.80s': it would be one of %zu, at most %zu are held at once; "
               "detach what is not held any more",
               objects.back().name.c_str(), objects.size(), kObjectsMax));
  }
  for (const AttachedObject& object : objects) {
    const std::string owner = "object '" + printable(object.name) + "'";
    if (object.name.empty()) throw ConfigError(owner + ": it needs a name");
    const auto link = std::find(tree_.links.begin(), tree_.links.end(), object.link);
    if (link == tree_.links.end()) {
      throw ConfigError(owner + ": link '" + printable(object.link) +
                        "' is neither monitored nor on the way to a link that is");
    }
    validate(object.primitive.shape, owner);
    if (!isRigid(object.primitive.pose)) throw ConfigError(owner + ": its pose is not rigid");
    const double reach =
        object.primitive.pose.translation().norm() + boundingRadius(object.primitive.shape);
    if (reach > kObjectReachMax) {
      throw ConfigError(owner +
                        ": it reaches further than 3 m from its link; lengths are in metres");
    }
    model.shapes_.push_back({static_cast<std::size_t>(link - tree_.links.begin()),
                             object.primitive.shape, object.primitive.pose, object.name});
  }
  return model;
}

bool JointTree::turnsFreely(std::size_t variable) const {
  const JointVariable& limits = variables[variable];
  const auto differs = [variable](const RobotJoint& joint) {
    if (joint.motion == RobotJoint::Motion::kFixed || joint.variable != variable) return false;
    return joint.motion == RobotJoint::Motion::kTranslation ||
           joint.multiplier != std::round(joint.multiplier);
  };
  return !limits.lower && !limits.upper && std::none_of(joints.begin(), joints.end(), differs);
}

bool RobotModel::slides(std::size_t variable) const {
  const RobotJoint* found = nullptr;
  for (const RobotJoint& joint : tree_.joints) {
    if (joint.motion == RobotJoint::Motion::kFixed || joint.variable != variable) continue;
    if (!found || joint.name == tree_.variables[variable].name) found = &joint;
  }
  return found && found->motion == RobotJoint::Motion::kTranslation;
}

}  // namespace tccm
