#include "tccm_monitor/robot_model.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <tuple>
#include <utility>

#include "config/parameter_table.h"
#include "fit/primitive_fit.h"
#include "fit/primitives_file.h"
#include "mesh/mesh.h"
#include "mesh/text.h"
#include "robot/link_use.h"
#include "robot/urdf_reader.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

/// [m]; what is larger would be filtered out of scans with half of the surroundings.
constexpr double kObjectReachMax = 3.0;
constexpr std::size_t kMessageMax = 1000;  // bytes

using Links = std::vector<urdf::LinkConstSharedPtr>;

std::vector<std::string> namesOf(const Links& links) {
  std::vector<std::string> names;
  for (const auto& link : links) names.push_back(link->name);
  return names;
}

Shape toShape(const urdf::Geometry& geometry, bool as_capsule, const std::string& owner) {
  Shape shape = Sphere{0.0};
  if (const auto* box = dynamic_cast<const urdf::Box*>(&geometry)) {
    shape = Box{0.5 * Vector3(box->dim.x, box->dim.y, box->dim.z)};
  } else if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(&geometry)) {
    const double half_length = 0.5 * cylinder->length;
    shape = as_capsule ? Shape(Capsule{cylinder->radius, half_length})
                       : Shape(Cylinder{cylinder->radius, half_length});
  } else if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(&geometry)) {
    shape = Sphere{sphere->radius};
  } else {
    throw ConfigError(owner + ": its geometry is of an unknown kind");
  }
  validate(shape, owner);
  return shape;
}

/// All that a fit depends on, beside the file's content.
std::string fitKey(const std::string& uri, const MeshScaling& scaling,
                   const PrimitiveFitConfig& fit) {
  char text[200];
  std::snprintf(text, sizeof text, "%a %a %a %d %d %a %a ", scaling.scale.x(), scaling.scale.y(),
                scaling.scale.z(), scaling.apply_up_axis ? 1 : 0, fit.primitives_max,
                fit.split_gain, fit.margin_m);
  return text + std::filesystem::path(uri).extension().string();
}

/// Reads the primitives of links: from the file of primitives, from the URDF's primitives, or by a
/// fit to its meshes.
class GeometryReader {
 public:
  /// Keeps references but for urdf. @throws ConfigError where the file of primitives cannot be
  /// taken.
  GeometryReader(const urdf::ModelInterface& urdf, const RobotModel::Config& config,
                 const RobotResources& resources, const LinkSelector& selector)
      : config_(config),
        resources_(resources),
        selector_(selector),
        cache_(resources.fit_cache_folder) {
    const std::string& path = config.primitives_file;  // a URI too, for whoever reads it
    if (!path.empty()) file_ = readPrimitives(contentOf(path, "primitives_file"), path);
    for (const auto& [link, primitives] : file_) {
      if (urdf.getLink(link)) continue;
      throw ConfigError(path + ": robot_description has no link '" + link + "'");
    }
  }

  [[nodiscard]] bool hasShape(const urdf::Link& link) const {
    return file_.count(link.name) > 0 || !geometriesOf(link).empty();
  }

  /// @param links to be read. @param model_links the model's, in the same order, and others
  /// between.
  /// @throws ConfigError naming link and element.
  [[nodiscard]] std::pair<std::vector<LinkElement>, std::vector<LinkShape>> read(
      const Links& links, const std::vector<std::string>& model_links) {
    for (const auto& link : links) {
      for (const auto& placed : geometriesOf(*link)) {
        if (placed.first && placed.first->type == urdf::Geometry::MESH) ++meshes_;
      }
    }
    LinkElement element;
    for (const auto& link : links) {
      while (model_links[element.link] != link->name) ++element.link;
      if (file_.count(link->name) > 0) {
        element.source = "file";
        add(element, file_.at(link->name));
      }
      for (const auto& placed : geometriesOf(*link)) readElement(*link, placed, element);
    }
    if (resources_.progress && meshes_ > 0) resources_.progress(meshes_, meshes_);
    return {std::move(elements_), std::move(shapes_)};
  }

  [[nodiscard]] std::string cacheDefect() const { return cache_.saveProblem(); }

 private:
  /// A geometry and where it is.
  using Placed = std::pair<urdf::GeometrySharedPtr, urdf::Pose>;

  /// Those that stand for a link, unless the file of primitives does. Asked for its visual
  /// geometry, a link that has none shows its collision elements.
  [[nodiscard]] std::vector<Placed> geometriesOf(const urdf::Link& link) const {
    std::vector<Placed> found;
    if (file_.count(link.name) > 0) return found;
    if (selector_.matches(config_.visual_links, link.name)) {
      for (const auto& visual : link.visual_array) {
        found.emplace_back(visual->geometry, visual->origin);
      }
    }
    if (!found.empty()) return found;
    for (const auto& collision : link.collision_array) {
      found.emplace_back(collision->geometry, collision->origin);
    }
    return found;
  }

  /// @param primitives in the link's frame; their volume is the hull's where no mesh has another.
  void add(LinkElement element, const std::vector<PlacedShape>& primitives) {
    element.first_shape = shapes_.size();
    element.shapes = primitives.size();
    for (const PlacedShape& primitive : primitives) {
      if (element.source != "mesh") element.hull_volume_m3 += volume(primitive.shape);
      shapes_.push_back({element.link, primitive.shape, primitive.pose});
    }
    elements_.push_back(std::move(element));
  }

  void readElement(const urdf::Link& link, const Placed& placed, LinkElement element) {
    const std::string owner = "link '" + link.name + "'";
    const auto& [geometry, origin] = placed;
    if (!geometry) throw ConfigError(owner + ": a geometry of it has no shape");
    element.T_link_element = toPose(origin, owner);
    if (geometry->type == urdf::Geometry::MESH) {
      return fitMesh(dynamic_cast<const urdf::Mesh&>(*geometry), owner, element);
    }
    const bool as_capsule = selector_.matches(config_.capsule_links, link.name);
    const Shape shape = toShape(*geometry, as_capsule, owner);
    element.source = tccm::name(shape);
    add(element, {{shape, element.T_link_element}});
  }

  void fitMesh(const urdf::Mesh& mesh, const std::string& owner, LinkElement element) {
    if (resources_.progress) resources_.progress(meshes_done_++, meshes_);
    element.source = "mesh";
    element.uri = mesh.filename;
    element.mesh_scale << mesh.scale.x, mesh.scale.y, mesh.scale.z;
    element.mesh_up_axis = config_.apply_mesh_up_axis;
    const MeshScaling scaling{element.mesh_scale, element.mesh_up_axis};
    try {
      const std::string content = contentOf(mesh.filename, "its mesh " + mesh.filename);
      PrimitiveFit fit = cache_.fit(content, fitKey(mesh.filename, scaling, config_.fit), [&] {
        return fitPrimitives(readMesh(content, mesh.filename, scaling), config_.fit, mesh.filename);
      });
      element.hull_volume_m3 = fit.hull_volume_m3;
      element.overhang_m = fit.overhang_m;
      for (PlacedShape& primitive : fit.primitives) {
        primitive.pose = element.T_link_element * primitive.pose;
      }
      add(element, fit.primitives);
    } catch (const ConfigError& error) {
      throw ConfigError(owner + ": " + error.what());
    }
  }

  [[nodiscard]] std::string contentOf(const std::string& uri, const std::string& owner) const {
    if (resources_.read) return resources_.read(uri);
    throw ConfigError(owner + ": nothing reads files here");
  }

  const RobotModel::Config& config_;
  const RobotResources& resources_;
  const LinkSelector& selector_;
  LinkPrimitives file_;
  FitCache cache_;
  std::size_t meshes_done_ = 0;
  std::size_t meshes_ = 0;
  std::vector<LinkElement> elements_;
  std::vector<LinkShape> shapes_;
};

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
  const urdf::ModelInterfaceSharedPtr urdf = readUrdf(urdf_text);
  name_ = urdf->getName();
  for (const auto& joint : urdf->joints_) all_joints_.insert(joint.first);
  fixed_joints_ = config.fixed_joints;
  const Links all_links = linksInOrder(*urdf);
  selector_ = std::make_shared<const LinkSelector>(config.link_groups, namesOf(all_links));
  selector_->requireMatches(config.monitored_links, "monitored_links");
  selector_->requireMatches(config.ignored_links, "ignored_links");
  selector_->requireMatches(config.capsule_links, "capsule_links");
  selector_->requireMatches(config.visual_links, "visual_links");
  GeometryReader geometry(*urdf, config, resources, *selector_);
  Links monitored;
  for (const auto& link : all_links) {
    const bool has_shape = geometry.hasShape(*link);
    if (!has_shape) links_without_shape_.push_back(link->name);
    if (isMonitored(*link, has_shape, config, *selector_)) monitored.push_back(link);
  }
  if (monitored.empty()) {
    throw ConfigError("robot_description: no link to monitor has a collision element");
  }
  tree_ = buildJointTree(*urdf, namesOf(monitored), config.fixed_joints);
  std::tie(elements_, shapes_) = geometry.read(monitored, tree_.links);
  cache_defect_ = geometry.cacheDefect();
} catch (const ConfigError& error) {
  throw ConfigError(printable(error.what(), kMessageMax));  // names may hold anything
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
  table.add("primitives_file", &primitives_file,
            "path or URI of primitives in place of links' own shapes, as fit_primitives writes it");
  table.add("apply_mesh_up_axis", &apply_mesh_up_axis,
            "turns COLLADA meshes by the up axis they state; rviz and MoveIt do not");
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
  const auto differs = [variable](const RobotJoint& joint) {
    if (joint.motion == RobotJoint::Motion::kFixed || joint.variable != variable) return false;
    return joint.motion == RobotJoint::Motion::kTranslation ||
           joint.multiplier != std::round(joint.multiplier);
  };
  return !limits.lower && !limits.upper &&
         std::none_of(tree_.joints.begin(), tree_.joints.end(), differs);
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
