/// How a RobotModel is read: its constructor.

#include <cstdio>
#include <filesystem>
#include <utility>

#include "config/parameter_table.h"
#include "fit/fit_cache.h"
#include "fit/primitive_fit.h"
#include "fit/primitives_file.h"
#include "mesh/mesh_file.h"
#include "mesh/text.h"
#include "robot/joint_tree.h"
#include "robot/link_selector.h"
#include "robot/urdf_reader.h"
#include "tccm_monitor/config_error.h"
#include "tccm_monitor/robot_model.h"

namespace tccm {
namespace {

constexpr std::size_t kMessageMax = 1000;

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
  /// Keeps references. @throws ConfigError where the file of primitives cannot be taken.
  GeometryReader(const RobotModel::Config& config, const RobotResources& resources,
                 const LinkSelector& selector)
      : config_(config),
        resources_(resources),
        selector_(selector),
        cache_(resources.fit_cache_folder) {
    const std::string& path = config.primitives_file;  // a URI too, for whoever reads it
    if (!path.empty()) file_ = readPrimitives(contentOf(path, "primitives_file"), path);
  }

  [[nodiscard]] bool hasShape(const urdf::Link& link) const {
    return file_.count(link.name) > 0 || !geometriesOf(link).empty();
  }
  /// Links that the file of primitives names.
  [[nodiscard]] const LinkPrimitives& file() const { return file_; }

  struct Result {
    std::vector<LinkElement> elements;
    std::vector<LinkShape> shapes;
  };
  /// @param links to be read. @param model_links the model's, in the same order, and others
  /// between.
  /// @throws ConfigError naming link and element.
  [[nodiscard]] Result read(const Links& links, const std::vector<std::string>& model_links) {
    for (const auto& link : links) {
      for (const auto& placed : geometriesOf(*link)) {
        if (placed.first && placed.first->type == urdf::Geometry::MESH) ++meshes_;
      }
    }
    LinkElement element;
    for (const auto& link : links) {
      while (model_links[element.link] != link->name) ++element.link;
      if (file_.count(link->name) > 0) readFromFile(file_.at(link->name), element);
      for (const auto& placed : geometriesOf(*link)) readElement(*link, placed, element);
    }
    if (resources_.progress && meshes_ > 0) resources_.progress(meshes_, meshes_);
    return std::move(result_);
  }

  [[nodiscard]] std::string cacheDefect() const { return cache_.saveProblem(); }

 private:
  /// A geometry and where it is.
  using Placed = std::pair<urdf::GeometrySharedPtr, urdf::Pose>;

  /// Those that stand for a link, unless the file of primitives does.
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

  /// @param primitives in the link's frame
  void add(LinkElement element, const std::vector<PlacedShape>& primitives) {
    element.first_shape = result_.shapes.size();
    element.shapes = primitives.size();
    for (const PlacedShape& primitive : primitives) {
      result_.shapes.push_back({element.link, primitive.shape, primitive.pose});
    }
    result_.elements.push_back(std::move(element));
  }

  void readFromFile(const std::vector<PlacedShape>& primitives, LinkElement element) {
    element.source = "file";
    for (const PlacedShape& primitive : primitives) {
      element.hull_volume_m3 += volume(primitive.shape);
    }
    add(element, primitives);
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
    element.hull_volume_m3 = volume(shape);
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
  Result result_;
};

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
  requireMatches(*selector_, config);
  GeometryReader geometry(config, resources, *selector_);
  requireKnownLinks(geometry.file(), *urdf, config.primitives_file);
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
  GeometryReader::Result read = geometry.read(monitored, tree_.links);
  shapes_ = std::move(read.shapes);
  elements_ = std::move(read.elements);
  cache_defect_ = geometry.cacheDefect();
} catch (const ConfigError& error) {
  throw ConfigError(printable(error.what(), kMessageMax));  // names may hold anything
}

}  // namespace tccm
