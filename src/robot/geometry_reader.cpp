#include "robot/geometry_reader.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "mesh/mesh.h"
#include "robot/link_size.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr double kNothing = 1e-9;   // [m]; a size below it is 0
constexpr double kThinnest = 1e-4;  // [m] that a size of 0 is taken for beside one that is none

std::string ownerOf(const urdf::Link& link) { return "link '" + link.name + "'"; }

std::string articleOf(const LinkElement& element) {
  return element.source == "mesh" ? "its mesh " + element.uri : "its " + element.source;
}

/// What the sizes of one of the URDF's primitives are taken for: some may be 0.
class Sizes {
 public:
  explicit Sizes(std::vector<double> stated) : sizes_(std::move(stated)) {
    const auto isNothing = [](double size) { return size >= 0.0 && size < kNothing; };
    const auto nothing = std::count_if(sizes_.begin(), sizes_.end(), isNothing);
    is_nothing_ = static_cast<std::size_t>(nothing) == sizes_.size();
    is_thin_ = nothing > 0;
    std::replace_if(sizes_.begin(), sizes_.end(), isNothing, kThinnest);
  }

  [[nodiscard]] double operator[](std::size_t i) const { return sizes_[i]; }
  [[nodiscard]] bool isNothing() const { return is_nothing_; }
  /// Empty where all are above 0.
  [[nodiscard]] std::string warning() const {
    if (is_nothing_) return "has the size 0 and is left out";
    return is_thin_ ? "has a size of 0 and is taken for 0.1 mm there" : "";
  }

 private:
  std::vector<double> sizes_;
  bool is_nothing_ = false;
  bool is_thin_ = false;
};

struct ReadShape {
  std::optional<Shape> shape;  ///< nothing where its size is 0
  std::string warning;
};

ReadShape toShape(const urdf::Geometry& geometry, bool as_capsule, const std::string& owner) {
  if (const auto* box = dynamic_cast<const urdf::Box*>(&geometry)) {
    const Sizes sizes({box->dim.x, box->dim.y, box->dim.z});
    if (sizes.isNothing()) return {std::nullopt, "its box " + sizes.warning()};
    const Shape shape = Box{0.5 * Vector3(sizes[0], sizes[1], sizes[2])};
    validate(shape, owner);
    return {shape, sizes.warning().empty() ? "" : "its box " + sizes.warning()};
  }
  if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(&geometry)) {
    const Sizes sizes({cylinder->radius, cylinder->length});
    if (sizes.isNothing()) return {std::nullopt, "its cylinder " + sizes.warning()};
    const Shape shape = as_capsule ? Shape(Capsule{sizes[0], 0.5 * sizes[1]})
                                   : Shape(Cylinder{sizes[0], 0.5 * sizes[1]});
    validate(shape, owner);
    return {shape, sizes.warning().empty() ? "" : "its cylinder " + sizes.warning()};
  }
  if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(&geometry)) {
    const Sizes sizes({sphere->radius});
    if (sizes.isNothing()) return {std::nullopt, "its sphere " + sizes.warning()};
    const Shape shape = Sphere{sphere->radius};
    validate(shape, owner);
    return {shape, ""};
  }
  throw ConfigError(owner + ": its geometry is of an unknown kind");
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

Vector3 scaleOf(const urdf::Mesh& mesh) { return {mesh.scale.x, mesh.scale.y, mesh.scale.z}; }

double lengthOf(const urdf::Joint& joint) {
  const urdf::Vector3& p = joint.parent_to_joint_origin_transform.position;
  return Vector3(p.x, p.y, p.z).norm();
}

/// How far the link's joints are from each other.
std::vector<double> jointOffsets(const urdf::Link& link) {
  std::vector<double> offsets;
  if (link.parent_joint) offsets.push_back(lengthOf(*link.parent_joint));
  for (const auto& joint : link.child_joints) offsets.push_back(lengthOf(*joint));
  return offsets;
}

}  // namespace

GeometryReader::GeometryReader(const ReadUrdf& urdf, const RobotModel::Config& config,
                               const RobotResources& resources, const LinkSelector& selector)
    : urdf_(urdf),
      config_(config),
      resources_(resources),
      selector_(selector),
      cache_(resources.fit_cache_folder) {
  const std::string& path = config.primitives_file;  // a URI too, for whoever reads it
  if (!path.empty()) file_ = readPrimitives(contentOf(path, "primitives_file"), path);
  for (const auto& [link, primitives] : file_) {
    if (urdf.model->getLink(link)) continue;
    throw ConfigError(path + ": robot_description has no link '" + link + "'");
  }
}

bool GeometryReader::hasShape(const urdf::Link& link) const {
  return file_.count(link.name) > 0 || !geometriesOf(link).empty();
}

/// Whether its visual geometry stands for the link: where that is asked for and there.
bool GeometryReader::isVisual(const urdf::Link& link) const {
  return selector_.matches(config_.visual_links, link.name) && !link.visual_array.empty();
}

/// Those that stand for a link, unless the file of primitives does.
std::vector<GeometryReader::Placed> GeometryReader::geometriesOf(const urdf::Link& link) const {
  std::vector<Placed> found;
  if (file_.count(link.name) > 0) return found;
  if (isVisual(link)) {
    for (const auto& visual : link.visual_array)
      found.emplace_back(visual->geometry, visual->origin);
    return found;
  }
  for (const auto& collision : link.collision_array) {
    found.emplace_back(collision->geometry, collision->origin);
  }
  return found;
}

std::vector<LinkGeometry> GeometryReader::read(const std::vector<urdf::LinkConstSharedPtr>& links) {
  for (const auto& link : links) {
    for (const auto& placed : geometriesOf(*link)) {
      if (placed.first && placed.first->type == urdf::Geometry::MESH) ++meshes_;
    }
  }
  std::vector<LinkGeometry> geometries;
  for (const auto& link : links) {
    try {
      geometries.push_back(readLink(*link));
      requireMeantSizes(*link, geometries.back());
    } catch (const ConfigError& error) {
      throw ConfigError(ownerOf(*link) + ": " + error.what());
    }
    for (std::string& warning : geometries.back().warnings) {
      warning = ownerOf(*link) + ": " + warning;
    }
  }
  if (resources_.progress && meshes_ > 0) resources_.progress(meshes_, meshes_);
  return geometries;
}

LinkGeometry GeometryReader::readLink(const urdf::Link& link) {
  LinkGeometry geometry;
  const auto primitives = file_.find(link.name);
  if (primitives != file_.end()) {
    LinkElement element;
    element.source = "file";
    element.shapes = primitives->second.size();
    for (const PlacedShape& placed : primitives->second) {
      element.hull_volume_m3 += volume(placed.shape);
    }
    geometry.shapes = primitives->second;
    geometry.elements.push_back(element);
    return geometry;
  }
  const auto defect = urdf_.visual_defects.find(link.name);
  if (defect != urdf_.visual_defects.end() && selector_.matches(config_.visual_links, link.name)) {
    throw ConfigError(defect->second);
  }
  const bool as_capsule = selector_.matches(config_.capsule_links, link.name);
  for (const Placed& placed : geometriesOf(link)) {
    if (!placed.first) throw ConfigError("a geometry of it has no shape");
    if (placed.first->type == urdf::Geometry::MESH) {
      LinkElement element;
      element.T_link_element = toPose(placed.second, "its geometry");
      fitMesh(dynamic_cast<const urdf::Mesh&>(*placed.first), std::move(element), geometry);
    } else {
      readElement(placed, as_capsule, geometry);
    }
  }
  return geometry;
}

void GeometryReader::readElement(const Placed& placed, bool as_capsule,
                                 LinkGeometry& geometry) const {
  const Pose T_link_element = toPose(placed.second, "its geometry");
  const auto [shape, warning] = toShape(*placed.first, as_capsule, "its geometry");
  if (!warning.empty()) geometry.warnings.push_back(warning);
  if (!shape) return;
  LinkElement element;
  element.source = tccm::name(*shape);
  element.T_link_element = T_link_element;
  element.first_shape = geometry.shapes.size();
  element.shapes = 1;
  element.hull_volume_m3 = volume(*shape);
  geometry.shapes.push_back({*shape, T_link_element});
  geometry.elements.push_back(std::move(element));
}

PrimitiveFit GeometryReader::fitOf(const urdf::Mesh& mesh) {
  const MeshScaling scaling{scaleOf(mesh), config_.apply_mesh_up_axis};
  const std::string content = contentOf(mesh.filename, "its mesh " + mesh.filename);
  return cache_.fit(content, fitKey(mesh.filename, scaling, config_.fit), [&] {
    return fitPrimitives(readMesh(content, mesh.filename, scaling), config_.fit, mesh.filename);
  });
}

void GeometryReader::fitMesh(const urdf::Mesh& mesh, LinkElement element, LinkGeometry& geometry) {
  if (resources_.progress) resources_.progress(meshes_done_++, meshes_);
  const PrimitiveFit fit = fitOf(mesh);
  for (const std::string& warning : fit.warnings) {
    geometry.warnings.push_back("its mesh " + mesh.filename + ": " + warning);
  }
  if (fit.primitives.empty()) return;
  element.source = "mesh";
  element.uri = mesh.filename;
  element.mesh_scale = scaleOf(mesh);
  element.mesh_up_axis = config_.apply_mesh_up_axis;
  element.mesh_longest_m = fit.mesh_extents_m.maxCoeff();
  element.hull_volume_m3 = fit.hull_volume_m3;
  element.overhang_m = fit.overhang_m;
  element.first_shape = geometry.shapes.size();
  element.shapes = fit.primitives.size();
  for (const PlacedShape& primitive : fit.primitives) {
    geometry.shapes.push_back({primitive.shape, element.T_link_element * primitive.pose});
  }
  geometry.elements.push_back(std::move(element));
}

/// Of the geometry that does not stand for the link, for want of better. What cannot be read tells
/// nothing.
std::vector<double> GeometryReader::visualSizes(const urdf::Link& link) const {
  std::vector<double> sizes;
  const auto add = [&](const urdf::GeometrySharedPtr& geometry) {
    if (!geometry) return;
    try {
      if (const auto* mesh = dynamic_cast<const urdf::Mesh*>(geometry.get())) {
        const std::string content = contentOf(mesh->filename, "");
        UprightBox box;
        for (const Vector3& p :
             readMesh(content, mesh->filename, {scaleOf(*mesh), false}).vertices) {
          box.extend(p);
        }
        if (!box.isEmpty()) sizes.push_back(box.sizes().maxCoeff());
      } else if (const auto shape = toShape(*geometry, false, "").shape) {
        sizes.push_back(longestSide(*shape));
      }
    } catch (const ConfigError&) {
    }
  };
  if (isVisual(link)) {
    for (const auto& collision : link.collision_array) add(collision->geometry);
  } else {
    for (const auto& visual : link.visual_array) add(visual->geometry);
  }
  return sizes;
}

void GeometryReader::requireMeantSizes(const urdf::Link& link, const LinkGeometry& geometry) const {
  const double size_max_m = config_.link_size_max_m;
  const auto refuseIf = [](const std::string& defect) {
    if (!defect.empty()) throw ConfigError(defect);
  };
  std::vector<double> longest_m;
  for (const LinkElement& element : geometry.elements) {
    double longest = element.mesh_longest_m;
    for (std::size_t i = 0; element.source != "mesh" && i < element.shapes; ++i) {
      longest = std::max(longest, longestSide(geometry.shapes[element.first_shape + i].shape));
    }
    refuseIf(sizeDefect(longest, size_max_m, articleOf(element), element.source == "mesh"));
    longest_m.push_back(longest);
  }
  for (std::size_t i = 0; i < geometry.elements.size(); ++i) {
    const LinkElement& element = geometry.elements[i];
    if (element.source != "mesh" || !isOfDoubtfulSize(longest_m[i], size_max_m)) continue;
    MeshSize mesh{longest_m[i], jointOffsets(link)};
    for (std::size_t k = 0; k < longest_m.size(); ++k) {
      if (k != i) mesh.others_m.push_back(longest_m[k]);
    }
    if (!saysEnough(mesh)) mesh.others_m = visualSizes(link);
    refuseIf(unitDefect(mesh, size_max_m, articleOf(element)));
  }
}

std::string GeometryReader::contentOf(const std::string& uri, const std::string& owner) const {
  if (resources_.read) return resources_.read(uri);
  throw ConfigError(owner + ": nothing reads files here");
}

}  // namespace tccm
