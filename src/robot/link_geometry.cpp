#include "robot/link_geometry.h"

#include <cstdio>
#include <utility>

#include "robot/urdf_reader.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

/// A path is a URI too, for whoever reads it.
std::string primitivesText(const RobotModel::Config& config, const RobotResources& resources) {
  if (!resources.read) throw ConfigError("primitives_file: nothing reads files here");
  return resources.read(config.primitives_file);
}

Shape toShape(const urdf::Geometry& geometry, bool as_capsule, const std::string& owner) {
  Shape shape = Sphere{0.0};
  if (geometry.type == urdf::Geometry::BOX) {
    const auto& box = dynamic_cast<const urdf::Box&>(geometry);
    shape = Box{0.5 * Vector3(box.dim.x, box.dim.y, box.dim.z)};
  } else if (geometry.type == urdf::Geometry::CYLINDER) {
    const auto& cylinder = dynamic_cast<const urdf::Cylinder&>(geometry);
    const double half_length = 0.5 * cylinder.length;
    shape = as_capsule ? Shape(Capsule{cylinder.radius, half_length})
                       : Shape(Cylinder{cylinder.radius, half_length});
  } else if (geometry.type == urdf::Geometry::SPHERE) {
    shape = Sphere{dynamic_cast<const urdf::Sphere&>(geometry).radius};
  } else {
    throw ConfigError(owner + ": its geometry is of an unknown kind");
  }
  validate(shape, owner);
  return shape;
}

/// All that a fit depends on, beside the file's content.
std::string fitKey(const std::string& uri, const MeshScaling& scaling,
                   const PrimitiveFitConfig& fit) {
  const std::size_t dot = uri.find_last_of('.');
  char text[200];
  std::snprintf(text, sizeof text, "%a %a %a %d %d %a %a ", scaling.scale.x(), scaling.scale.y(),
                scaling.scale.z(), scaling.apply_up_axis ? 1 : 0, fit.primitives_max,
                fit.split_gain, fit.margin_m);
  return text + (dot == std::string::npos ? std::string() : uri.substr(dot));
}

}  // namespace

LinkGeometryReader::LinkGeometryReader(const RobotModel::Config& config,
                                       const RobotResources& resources,
                                       const LinkSelector& selector)
    : config_(config),
      resources_(resources),
      selector_(selector),
      cache_(resources.fit_cache_folder) {
  if (config.primitives_file.empty()) return;
  file_ = readPrimitives(primitivesText(config, resources), config.primitives_file);
}

std::vector<LinkGeometryReader::Placed> LinkGeometryReader::geometriesOf(
    const urdf::Link& link) const {
  std::vector<Placed> found;
  if (selector_.matches(config_.visual_links, link.name)) {
    for (const auto& visual : link.visual_array)
      found.push_back({visual->geometry, visual->origin});
  }
  if (!found.empty()) return found;
  for (const auto& collision : link.collision_array) {
    found.push_back({collision->geometry, collision->origin});
  }
  return found;
}

bool LinkGeometryReader::hasShape(const urdf::Link& link) const {
  return file_.count(link.name) > 0 || !geometriesOf(link).empty();
}

LinkGeometryReader::Result LinkGeometryReader::read(
    const std::vector<urdf::LinkConstSharedPtr>& links, const std::vector<std::size_t>& indices) {
  result_ = {};
  meshes_done_ = meshes_ = 0;
  for (const auto& link : links) {
    if (file_.count(link->name) > 0) continue;
    for (const Placed& placed : geometriesOf(*link)) {
      if (placed.geometry && placed.geometry->type == urdf::Geometry::MESH) ++meshes_;
    }
  }
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (file_.count(links[i]->name) > 0) {
      readFromFile(*links[i], indices[i]);
    } else {
      for (const Placed& placed : geometriesOf(*links[i])) {
        readElement(*links[i], indices[i], placed);
      }
    }
  }
  if (resources_.progress && meshes_ > 0) resources_.progress(meshes_, meshes_);
  return std::move(result_);
}

void LinkGeometryReader::readFromFile(const urdf::Link& link, std::size_t index) {
  LinkElement element;
  element.link = index;
  element.source = "file";
  element.first_shape = result_.shapes.size();
  for (const PlacedShape& primitive : file_.at(link.name)) {
    result_.shapes.push_back({index, primitive.shape, primitive.pose});
    element.hull_volume_m3 += volume(primitive.shape);
  }
  element.shapes = result_.shapes.size() - element.first_shape;
  result_.elements.push_back(element);
}

void LinkGeometryReader::readElement(const urdf::Link& link, std::size_t index,
                                     const Placed& placed) {
  const std::string owner = "link '" + link.name + "'";
  if (!placed.geometry) throw ConfigError(owner + ": a geometry of it has no shape");
  LinkElement element;
  element.link = index;
  element.T_link_element = toPose(placed.origin, owner);
  element.first_shape = result_.shapes.size();
  if (placed.geometry->type == urdf::Geometry::MESH) {
    fitMesh(dynamic_cast<const urdf::Mesh&>(*placed.geometry), owner, element);
  } else {
    const bool as_capsule = selector_.matches(config_.capsule_links, link.name);
    const Shape shape = toShape(*placed.geometry, as_capsule, owner);
    element.source = tccm::name(shape);
    element.hull_volume_m3 = volume(shape);
    result_.shapes.push_back({index, shape, element.T_link_element});
  }
  element.shapes = result_.shapes.size() - element.first_shape;
  result_.elements.push_back(element);
}

void LinkGeometryReader::fitMesh(const urdf::Mesh& mesh, const std::string& owner,
                                 LinkElement& element) {
  if (resources_.progress) resources_.progress(meshes_done_++, meshes_);
  element.source = "mesh";
  element.uri = mesh.filename;
  element.scaling.scale << mesh.scale.x, mesh.scale.y, mesh.scale.z;
  element.scaling.apply_up_axis = config_.apply_mesh_up_axis;
  try {
    const std::string content = contentOf(mesh.filename);
    const PrimitiveFit fit =
        cache_.fit(content, fitKey(mesh.filename, element.scaling, config_.fit), [&] {
          return fitPrimitives(readMesh(content, mesh.filename, element.scaling), config_.fit,
                               mesh.filename);
        });
    element.hull_volume_m3 = fit.hull_volume_m3;
    element.overhang_m = fit.overhang_m;
    for (const PlacedShape& primitive : fit.primitives) {
      result_.shapes.push_back(
          {element.link, primitive.shape, element.T_link_element * primitive.pose});
    }
  } catch (const ConfigError& error) {
    throw ConfigError(owner + ": " + error.what());
  }
}

std::string LinkGeometryReader::contentOf(const std::string& uri) const {
  if (resources_.read) return resources_.read(uri);
  throw ConfigError("its mesh " + uri + " cannot be read here");
}

}  // namespace tccm
