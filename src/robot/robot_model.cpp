#include "robot/robot_model.h"

#include <algorithm>
#include <map>
#include <sstream>

#include "mesh/text.h"
#include "robot/joint_tree.h"
#include "robot/link_geometry.h"
#include "robot/urdf_reader.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr std::size_t kMessageMax = 1000;
/// [m]; what is larger would be filtered out of scans with half of the surroundings.
constexpr double kObjectReachMax = 3.0;

std::vector<std::string> namesOf(const std::vector<urdf::LinkConstSharedPtr>& links) {
  std::vector<std::string> names;
  for (const auto& link : links) names.push_back(link->name);
  return names;
}

void requireKnownLinks(const LinkPrimitives& file, const urdf::ModelInterface& urdf,
                       const std::string& owner) {
  for (const auto& entry : file) {
    if (!urdf.getLink(entry.first)) {
      throw ConfigError(owner + ": robot_description has no link '" + entry.first + "'");
    }
  }
}

void requireMatches(const LinkSelector& selector, const RobotModel::Config& config) {
  selector.requireMatches(config.monitored_links, "monitored_links");
  selector.requireMatches(config.ignored_links, "ignored_links");
  selector.requireMatches(config.capsule_links, "capsule_links");
  selector.requireMatches(config.visual_links, "visual_links");
}

/// The links to monitor, by name; those without shape are told apart.
struct Monitored {
  std::vector<urdf::LinkConstSharedPtr> links;
  std::vector<std::string> without_shape;
};

Monitored monitoredLinks(const std::vector<urdf::LinkConstSharedPtr>& links,
                         const RobotModel::Config& config, const LinkSelector& selector,
                         const LinkGeometryReader& geometry) {
  Monitored monitored;
  for (const auto& link : links) {
    const bool has_shape = geometry.hasShape(*link);
    if (!has_shape) monitored.without_shape.push_back(link->name);
    if (selector.matches(config.ignored_links, link->name)) continue;
    const bool by_name = !config.monitored_links.empty();
    if (by_name && !selector.matches(config.monitored_links, link->name)) continue;
    if (has_shape) {
      monitored.links.push_back(link);
    } else if (by_name) {
      throw ConfigError("link '" + link->name +
                        "': it is monitored and has no collision element (give it a primitive, "
                        "name it in visual_links, or in ignored_links)");
    }
  }
  if (monitored.links.empty()) {
    throw ConfigError("robot_description: no link to monitor has a collision element");
  }
  return monitored;
}

template <typename List>
void write(std::ostream& out, const List& list) {
  for (const std::string& entry : list) out << entry << '\n';
  out << '\n';
}

}  // namespace

void RobotModel::Config::validate() const { fit.validate(); }

std::string RobotModel::Config::text() const {
  std::ostringstream out;
  out << std::hexfloat;
  for (const auto& [group, links] : link_groups) {
    out << group << ":\n";
    write(out, links);
  }
  for (const auto* list : {&monitored_links, &ignored_links, &capsule_links, &visual_links}) {
    write(out, *list);
  }
  for (const auto& [joint, position] : fixed_joints) out << joint << ' ' << position << '\n';
  out << primitives_file << '\n'
      << apply_mesh_up_axis << ' ' << fit.primitives_max << ' ' << fit.split_gain << ' '
      << fit.margin_m;
  return out.str();
}

RobotModel::RobotModel(const std::string& urdf_text, const Config& config,
                       const RobotResources& resources) try {
  config.validate();
  const urdf::ModelInterfaceSharedPtr urdf = readUrdf(urdf_text);
  name_ = urdf->getName();
  for (const auto& joint : urdf->joints_) all_joints_.insert(joint.first);
  fixed_joints_ = config.fixed_joints;
  const auto all_links = linksInOrder(*urdf);
  selector_ = std::make_shared<const LinkSelector>(config.link_groups, namesOf(all_links));
  requireMatches(*selector_, config);
  LinkGeometryReader geometry(config, resources, *selector_);
  requireKnownLinks(geometry.file(), *urdf, config.primitives_file);
  Monitored monitored = monitoredLinks(all_links, config, *selector_, geometry);
  links_without_shape_ = std::move(monitored.without_shape);

  JointTree tree = buildJointTree(*urdf, namesOf(monitored.links), config.fixed_joints);
  links_ = std::move(tree.links);
  roots_ = std::move(tree.roots);
  joints_ = std::move(tree.joints);
  variables_ = std::move(tree.variables);

  std::map<std::string, std::size_t> index_of;
  for (std::size_t i = 0; i < links_.size(); ++i) index_of.emplace(links_[i], i);
  std::vector<std::size_t> indices;
  for (const auto& link : monitored.links) indices.push_back(index_of.at(link->name));
  LinkGeometryReader::Result shapes = geometry.read(monitored.links, indices);
  shapes_ = std::move(shapes.shapes);
  elements_ = std::move(shapes.elements);
  cache_defect_ = geometry.cacheDefect();
} catch (const ConfigError& error) {
  throw ConfigError(printable(error.what(), kMessageMax));  // names may hold anything
}

std::vector<std::string> RobotModel::rootLinks() const {
  std::vector<std::string> names;
  for (const std::size_t root : roots_) names.push_back(links_[root]);
  return names;
}

UsedShapes RobotModel::shapesFor(const LinkUse& use, const LinkUse::Keys& keys) const {
  std::vector<std::string> shape_links;
  for (const LinkShape& shape : shapes_) shape_links.push_back(links_[shape.link]);
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
  for (const AttachedObject& object : objects) {
    const std::string owner = "object '" + object.name + "'";
    if (object.name.empty()) throw ConfigError(owner + ": it needs a name");
    const auto link = std::find(links_.begin(), links_.end(), object.link);
    if (link == links_.end()) {
      throw ConfigError(owner + ": link '" + object.link +
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
    model.shapes_.push_back({static_cast<std::size_t>(link - links_.begin()),
                             object.primitive.shape, object.primitive.pose, object.name});
  }
  return model;
}

bool RobotModel::turnsFreely(std::size_t variable) const {
  const JointVariable& limits = variables_[variable];
  return !limits.lower && !limits.upper &&
         std::none_of(joints_.begin(), joints_.end(), [variable](const RobotJoint& joint) {
           return joint.motion == RobotJoint::Motion::kTranslation && joint.variable == variable;
         });
}

}  // namespace tccm
