#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "mesh/collada_geometry.h"
#include "mesh/mesh_formats.h"
#include "mesh/printable.h"
#include "mesh/token_reader.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using tinyxml2::XMLElement;

constexpr std::ptrdiff_t kElementsMax = 2'000'000;
constexpr std::size_t kVisitsMax = 1'000'000;      // of elements, instances counted
constexpr std::size_t kVerticesMax = 8'000'000;    // before places are merged
constexpr std::size_t kTrianglesMax = 16'000'000;  // instances counted
constexpr int kDepthMax = 200;

template <std::size_t count>
std::array<double, count> numbersOf(const XMLElement& element) {
  const std::string text = textOf(element);
  TokenReader words(text);
  std::array<double, count> numbers;
  for (double& number : numbers) {
    number = readNumber(words, "<" + std::string(element.Name()) + ">");
  }
  return numbers;
}

Eigen::Affine3d matrixOf(const XMLElement& element) {
  const auto numbers = numbersOf<16>(element);
  Eigen::Affine3d matrix;
  matrix.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data());
  if (!matrix.matrix().row(3).isApprox(Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0), 1e-6)) {
    throw ConfigError("a <matrix> does not end with 0 0 0 1");
  }
  return matrix;
}

Eigen::Affine3d rotationOf(const XMLElement& element) {
  const auto n = numbersOf<4>(element);
  const Vector3 axis(n[0], n[1], n[2]);
  if (!(axis.norm() > 0.0)) throw ConfigError("a <rotate> has no axis");
  return Eigen::Affine3d(Eigen::AngleAxisd(n[3] * M_PI / 180.0, axis.normalized()));
}

/// From the node to its parent: what stands at the eye and looks along -z.
Eigen::Affine3d lookatOf(const XMLElement& element) {
  const auto n = numbersOf<9>(element);
  const Vector3 eye(n[0], n[1], n[2]);
  const Vector3 z = (eye - Vector3(n[3], n[4], n[5])).normalized();
  const Vector3 x = Vector3(n[6], n[7], n[8]).cross(z).normalized();
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  transform.linear() << x, z.cross(x), z;
  transform.translation() = eye;
  return transform;
}

/// Identity for what is no transform.
Eigen::Affine3d transformOf(const XMLElement& element) {
  const std::string name = element.Name();
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  if (name == "matrix") return matrixOf(element);
  if (name == "rotate") return rotationOf(element);
  if (name == "lookat") return lookatOf(element);
  if (name == "skew") throw ConfigError("<skew> is not supported");
  if (name == "translate") {
    transform.translation() = Vector3(numbersOf<3>(element).data());
  } else if (name == "scale") {
    transform.linear() = Vector3(numbersOf<3>(element).data()).asDiagonal();
  }
  return transform;
}

/// [m]
double unitOf(const XMLElement& root) {
  const XMLElement* asset = root.FirstChildElement("asset");
  const XMLElement* unit = asset != nullptr ? asset->FirstChildElement("unit") : nullptr;
  const char* meter = unit != nullptr ? unit->Attribute("meter") : nullptr;
  if (meter == nullptr) return 1.0;  // the format's default
  const auto value = toNumber(meter);
  if (!value || !(*value > 0.0) || !std::isfinite(*value)) {
    throw ConfigError("its unit of '" + printable(meter) + "' metres is none");
  }
  return *value;
}

/// From the file's axes to those with z up.
Eigen::Matrix3d upright(const XMLElement& root) {
  const XMLElement* asset = root.FirstChildElement("asset");
  const XMLElement* stated = asset != nullptr ? asset->FirstChildElement("up_axis") : nullptr;
  const std::string text = stated != nullptr ? textOf(*stated) : "Y_UP";  // the format's default
  const std::string_view up = TokenReader(text).peek();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  if (up == "X_UP") {
    rotation << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  } else if (up == "Y_UP") {
    rotation << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  } else if (up != "Z_UP") {
    throw ConfigError("its up axis '" + printable(std::string(up)) + "' is none");
  }
  return rotation;
}

/// Places every instance of every geometry of a document's scene.
class SceneReader {
 public:
  explicit SceneReader(const XMLElement& root) : root_(root), ids_(root) {}

  /// @param T the file's frame to the mesh's, with the unit.
  Mesh read(const Eigen::Affine3d& T) {
    const XMLElement* scene = root_.FirstChildElement("scene");
    const XMLElement* instance =
        scene != nullptr ? scene->FirstChildElement("instance_visual_scene") : nullptr;
    if (instance == nullptr) throw ConfigError("it has no <scene> with an <instance_visual_scene>");
    addNodes(ids_.at(*instance, "url", "visual_scene"), T, 0);
    return std::move(mesh_);
  }

 private:
  void addNodes(const XMLElement& parent, const Eigen::Affine3d& T, int depth) {
    for (const XMLElement& child : ChildElements(parent)) {
      if (++visits_ > kVisitsMax) throw ConfigError("it instances too many nodes");
      const std::string name = child.Name();
      if (name == "node") addNode(child, T, depth);
      if (name == "instance_node") addNode(ids_.at(child, "url", "node"), T, depth);
      if (name == "instance_geometry") addGeometry(ids_.at(child, "url", "geometry"), T);
      if (name == "instance_controller") {
        addController(ids_.at(child, "url", "controller"), T, depth);
      }
    }
  }

  void addNode(const XMLElement& node, const Eigen::Affine3d& T_parent, int depth) {
    if (depth == kDepthMax) throw ConfigError("its nodes instance each other in a circle");
    Eigen::Affine3d T = T_parent;
    for (const XMLElement& child : ChildElements(node)) T = T * transformOf(child);
    addNodes(node, T, depth + 1);
  }

  /// A skin or morph shows its geometry, undeformed.
  void addController(const XMLElement& controller, const Eigen::Affine3d& T, int depth) {
    if (depth >= kDepthMax) throw ConfigError("its controllers name each other in a circle");
    const XMLElement* shown = controller.FirstChildElement("skin");
    if (shown == nullptr) shown = controller.FirstChildElement("morph");
    if (shown == nullptr) throw ConfigError("a <controller> has neither <skin> nor <morph>");
    const XMLElement& source = ids_.at(*shown, "source", "");
    const std::string name = source.Name();
    if (name == "geometry") return addGeometry(source, T);
    if (name != "controller") throw ConfigError("a <controller> shows no geometry");
    addController(source, T, depth + 1);
  }

  void addGeometry(const XMLElement& geometry, const Eigen::Affine3d& T) {
    const auto entry = geometries_.try_emplace(&geometry);
    Mesh& part = entry.first->second;
    if (entry.second) part = readGeometry(geometry, ids_);
    if (mesh_.vertices.size() + part.vertices.size() > kVerticesMax ||
        mesh_.triangles.size() + part.triangles.size() > kTrianglesMax) {
      throw ConfigError("it has too many vertices or triangles");
    }
    const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
    for (const Vector3& p : part.vertices) mesh_.vertices.emplace_back(T * p);
    for (const Mesh::Triangle& t : part.triangles) {
      mesh_.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
  }

  const XMLElement& root_;
  ElementIds ids_;
  std::map<const XMLElement*, Mesh> geometries_;
  std::size_t visits_ = 0;
  Mesh mesh_;
};

}  // namespace

Mesh readCollada(const std::string& content, bool apply_up_axis) {
  if (content.find('\0') != std::string::npos)
    throw ConfigError("it is no COLLADA file, or not in UTF-8");
  if (std::count(content.begin(), content.end(), '<') > kElementsMax) {
    throw ConfigError("it has over 2 million XML elements");
  }
  tinyxml2::XMLDocument document;
  if (document.Parse(content.c_str(), content.size()) != tinyxml2::XML_SUCCESS) {
    throw ConfigError("it is damaged or no COLLADA file: XML error " +
                      std::string(document.ErrorName()) + " in line " +
                      std::to_string(document.ErrorLineNum()));
  }
  const XMLElement* root = document.RootElement();
  if (root == nullptr || std::string(root->Name()) != "COLLADA") {
    throw ConfigError("it is no COLLADA file: its root element is not <COLLADA>");
  }
  Eigen::Affine3d T = Eigen::Affine3d::Identity();
  if (apply_up_axis) T.linear() = upright(*root);
  T.linear() *= unitOf(*root);
  return SceneReader(*root).read(T);
}

}  // namespace tccm
