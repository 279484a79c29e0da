#include "tccm_monitor/robot_model.h"

#include <algorithm>
#include <sstream>

#include "config/parameter_table.h"
#include "robot/link_selector.h"
#include "robot/link_use.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

/// [m]; what is larger would be filtered out of scans with half of the surroundings.
constexpr double kObjectReachMax = 3.0;

template <typename List>
void write(std::ostream& out, const List& list) {
  for (const std::string& entry : list) out << entry << '\n';
  out << '\n';
}

}  // namespace

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
  table.add("primitives_file", &primitives_file,
            "path or URI of primitives in place of links' own shapes, as fit_primitives writes it");
  table.add("apply_mesh_up_axis", &apply_mesh_up_axis,
            "turns COLLADA meshes by the up axis they state; rviz and MoveIt do not");
  fit.describe(table);
}

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

std::vector<std::string> RobotModel::rootLinks() const {
  std::vector<std::string> names;
  for (const std::size_t root : tree_.roots) names.push_back(tree_.links[root]);
  return names;
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
  for (const AttachedObject& object : objects) {
    const std::string owner = "object '" + object.name + "'";
    if (object.name.empty()) throw ConfigError(owner + ": it needs a name");
    const auto link = std::find(tree_.links.begin(), tree_.links.end(), object.link);
    if (link == tree_.links.end()) {
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
    model.shapes_.push_back({static_cast<std::size_t>(link - tree_.links.begin()),
                             object.primitive.shape, object.primitive.pose, object.name});
  }
  return model;
}

bool RobotModel::turnsFreely(std::size_t variable) const {
  const JointVariable& limits = tree_.variables[variable];
  return !limits.lower && !limits.upper &&
         std::none_of(tree_.joints.begin(), tree_.joints.end(),
                      [variable](const RobotJoint& joint) {
                        return joint.motion == RobotJoint::Motion::kTranslation &&
                               joint.variable == variable;
                      });
}

}  // namespace tccm
