#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <unordered_map>

#include "base/printable.h"
#include "mesh/mesh.h"
#include "mesh/text.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using tinyxml2::XMLElement;
using Indices = std::vector<std::uint32_t>;

constexpr std::ptrdiff_t kElementsMax = 2'000'000;
constexpr std::size_t kVisitsMax = 1'000'000;      // of elements, instances counted
constexpr std::size_t kVerticesMax = 8'000'000;    // before places are merged
constexpr std::size_t kTrianglesMax = 16'000'000;  // instances counted
constexpr int kDepthMax = 200;

std::string nameOf(const XMLElement& element) { return "<" + std::string(element.Name()) + ">"; }

/// The elements right below one: all, or those of one name.
std::vector<const XMLElement*> childrenOf(const XMLElement& parent, const char* name = nullptr) {
  std::vector<const XMLElement*> children;
  const XMLElement* child = parent.FirstChildElement(name);
  for (; child != nullptr; child = child->NextSiblingElement(name)) children.push_back(child);
  return children;
}

/// An element's text, without that of its children.
std::string textOf(const XMLElement& element) {
  std::string text;
  for (const auto* child = element.FirstChild(); child != nullptr; child = child->NextSibling()) {
    if (child->ToText() != nullptr) text += child->Value();
  }
  return text;
}

/// The numbers of an element's text: the first `count`, or all.
std::vector<double> numbersOf(const XMLElement& element, std::optional<std::size_t> count = {}) {
  const std::string text = textOf(element);
  TokenReader words(text);
  std::vector<double> numbers;
  while (count ? numbers.size() < *count : !words.peek().empty()) {
    numbers.push_back(readNumber(words, nameOf(element)));
  }
  return numbers;
}

/// A count, offset or stride; fallback where the attribute is absent.
std::size_t countIn(const XMLElement& element, const char* attribute, std::size_t fallback) {
  const char* text = element.Attribute(attribute);
  if (text == nullptr) return fallback;
  const auto value = toInteger(text);
  if (value && *value >= 0) return static_cast<std::size_t>(*value);
  throw ConfigError("a " + nameOf(element) + " has the " + attribute + " '" + printable(text) +
                    "'");
}

/// The child <input> of that meaning.
const XMLElement& inputOf(const XMLElement& element, const char* semantic) {
  for (const XMLElement* input : childrenOf(element, "input")) {
    if (input->Attribute("semantic", semantic) != nullptr) return *input;
  }
  throw ConfigError("a " + nameOf(element) + " has no " + semantic + " input");
}

/// From the frame of an element's node to what the node stands in; identity for what is no
/// transform.
Eigen::Affine3d transformOf(const XMLElement& element) {
  static const std::map<std::string, std::size_t> kNumbers{
      {"matrix", 16}, {"rotate", 4}, {"lookat", 9}, {"translate", 3}, {"scale", 3}};
  Eigen::Affine3d T = Eigen::Affine3d::Identity();
  const std::string name = element.Name();
  if (name == "skew") throw ConfigError("<skew> is not supported");
  const auto count = kNumbers.find(name);
  if (count == kNumbers.end()) return T;
  const std::vector<double> n = numbersOf(element, count->second);
  const Vector3 first(n.data());
  if (name == "translate") T.translation() = first;
  if (name == "scale") T.linear() = first.asDiagonal();
  if (name == "rotate") {
    if (!(first.norm() > 0.0)) throw ConfigError("a <rotate> has no axis");
    T = Eigen::AngleAxisd(n[3] * M_PI / 180.0, first.normalized());
  }
  if (name == "matrix") {
    T.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(n.data());
    if (!T.matrix().row(3).isApprox(Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0), 1e-6)) {
      throw ConfigError("a <matrix> does not end with 0 0 0 1");
    }
  }
  if (name == "lookat") {  // what stands at the first point and looks along -z at the second
    const Vector3 z = (first - Vector3(&n[3])).normalized();
    const Vector3 x = Vector3(&n[6]).cross(z).normalized();
    T.linear() << x, z.cross(x), z;
    T.translation() = first;
  }
  return T;
}

/// The element down a path of names; nullptr where there is none.
const XMLElement* elementAt(const XMLElement& top, std::initializer_list<const char*> path) {
  const XMLElement* element = &top;
  for (const char* name : path) element = element ? element->FirstChildElement(name) : nullptr;
  return element;
}

/// [m]
double unitOf(const XMLElement& root) {
  const XMLElement* unit = elementAt(root, {"asset", "unit"});
  const char* meter = unit != nullptr ? unit->Attribute("meter") : nullptr;
  if (meter == nullptr) return 1.0;  // the format's default
  const auto value = toNumber(meter);
  if (value && *value > 0.0 && std::isfinite(*value)) return *value;
  throw ConfigError("its unit of '" + printable(meter) + "' metres is none");
}

/// From the file's axes to those with z up.
Eigen::Matrix3d upright(const XMLElement& root) {
  const XMLElement* stated = elementAt(root, {"asset", "up_axis"});
  const std::string text = stated != nullptr ? textOf(*stated) : "Y_UP";  // the format's default
  const std::string_view up = TokenReader(text).peek();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  if (up == "X_UP") {
    rotation << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  } else if (up == "Y_UP") {
    rotation << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  } else if (up != "Z_UP") {
    throw ConfigError("its up axis '" + printable(up) + "' is none");
  }
  return rotation;
}

/// The lists of a <mesh> that name a vertex; others have no face.
std::vector<const XMLElement*> faceListsOf(const XMLElement& mesh) {
  std::vector<const XMLElement*> lists;
  for (const char* name :
       {"triangles", "lines", "polylist", "polygons", "trifans", "tristrips", "linestrips"}) {
    for (const XMLElement* list : childrenOf(mesh, name)) {
      const bool is_named = list->FirstChildElement("p") || list->FirstChildElement("ph");
      if (is_named || countIn(*list, "count", 0) > 0) lists.push_back(list);
    }
  }
  return lists;
}

/// Adds the faces of one of a mesh's lists.
class FaceReader {
 public:
  FaceReader(const XMLElement& list, Mesh& mesh) : list_(list), mesh_(mesh) {}

  void read() {
    const std::string name = list_.Name();
    if (name == "triangles") addSized(3);
    if (name == "lines") addSized(2);
    if (name == "polylist") addSized(0);
    if (name == "trifans" || name == "polygons") addRuns(list_, 0);
    if (name == "tristrips") addRuns(list_, 3);
    if (name == "linestrips") addRuns(list_, 2);
    // Holes are left filled.
    for (const XMLElement* with_holes : childrenOf(list_, "ph")) addRuns(*with_holes, 0);
  }

 private:
  /// The positions that the <p> name.
  [[nodiscard]] Indices corners(const std::vector<const XMLElement*>& indices) const {
    const std::size_t offset = countIn(inputOf(list_, "VERTEX"), "offset", 0);
    std::size_t stride = 1;
    for (const XMLElement* input : childrenOf(list_, "input")) {
      stride = std::max(stride, countIn(*input, "offset", 0) + 1);
    }
    Indices found;
    for (const XMLElement* p : indices) {
      const std::string text = textOf(*p);
      TokenReader words(text);
      std::size_t count = 0;
      for (; !words.peek().empty(); ++count) {
        const std::string_view word = words.next();
        if (count % stride == offset) found.push_back(vertex(word));
      }
      if (count % stride != 0) throw ConfigError("a " + nameOf(list_) + " ends within a vertex");
    }
    return found;
  }

  [[nodiscard]] std::uint32_t vertex(std::string_view word) const {
    const auto index = toInteger(word);
    if (index && *index >= 0 && static_cast<std::size_t>(*index) < mesh_.vertices.size()) {
      return static_cast<std::uint32_t>(*index);
    }
    throw ConfigError("a " + nameOf(list_) + " names vertex '" + printable(word) + "' of " +
                      std::to_string(mesh_.vertices.size()));
  }

  /// Faces of so many corners each; 0: of as many as <vcount> says.
  void addSized(std::size_t equal) {
    const Indices all = corners(childrenOf(list_, "p"));
    std::vector<std::size_t> sizes;
    if (equal > 0) sizes.assign(all.size() / equal, equal);
    const XMLElement* vcount = list_.FirstChildElement("vcount");
    const std::string text = equal == 0 && vcount != nullptr ? textOf(*vcount) : "";
    for (TokenReader words(text); !words.peek().empty();) {
      sizes.push_back(static_cast<std::size_t>(toInteger(words.next()).value_or(-1)));
    }
    const std::size_t count = countIn(list_, "count", sizes.size());
    bool fits = equal == 2 || count == sizes.size();  // some programs count lines wrongly
    std::size_t first = 0;
    for (std::size_t i = 0; fits && i < sizes.size(); first += sizes[i++]) {
      fits = sizes[i] <= all.size() - first;
      if (fits) mesh_.addFace(all.data() + first, sizes[i]);
    }
    if (fits && first == all.size()) return;
    throw ConfigError("a " + nameOf(list_) + " has more or fewer indices than its counts say");
  }

  /// Each <p> is a strip of faces of so many corners; 0: one face.
  void addRuns(const XMLElement& parent, std::size_t size) {
    for (const XMLElement* p : childrenOf(parent, "p")) {
      const Indices run = corners({p});
      const std::size_t width = size > 0 ? size : run.size();
      for (std::size_t i = 0; i + width <= run.size(); ++i) mesh_.addFace(run.data() + i, width);
    }
  }

  const XMLElement& list_;
  Mesh& mesh_;
};

/// Where x, y and z stand among an accessor's parameters: those without a name are passed over.
std::array<std::size_t, 3> coordinateOffsets(const XMLElement& accessor) {
  std::array<std::size_t, 3> offsets{0, 1, 2};
  const std::vector<const XMLElement*> parameters = childrenOf(accessor, "param");
  std::size_t named = 0;
  for (std::size_t i = 0; i < parameters.size() && named < 3; ++i) {
    if (parameters[i]->Attribute("name") != nullptr) offsets[named++] = i;
  }
  if (named == 1 || named == 2) throw ConfigError("a position has fewer than three coordinates");
  return offsets;
}

/// Reads geometries, and places every instance of each in a document's scene.
class SceneReader {
 public:
  explicit SceneReader(const XMLElement& root) : root_(root) { addIds(root); }

  /// @param T the file's frame to the mesh's, with the unit.
  Mesh read(const Eigen::Affine3d& T) {
    const XMLElement* instance = elementAt(root_, {"scene", "instance_visual_scene"});
    if (instance == nullptr) throw ConfigError("it has no <scene> with an <instance_visual_scene>");
    addNodes(named(*instance, "url", "visual_scene"), T, 0);
    const auto bare = std::count_if(geometries_.begin(), geometries_.end(),
                                    [](const auto& part) { return part.second.triangles.empty(); });
    if (bare > 0) {
      mesh_.warnings.push_back(std::to_string(bare) + " of its " +
                               std::to_string(geometries_.size()) + " geometries hold no face");
    }
    return std::move(mesh_);
  }

 private:
  void addIds(const XMLElement& element) {
    if (const char* id = element.Attribute("id")) ids_.emplace(id, &element);
    for (const XMLElement* child : childrenOf(element)) addIds(*child);
  }

  /// The element that an attribute such as url="#id" refers to.
  /// @param name what the element has to be; empty where anything may follow.
  [[nodiscard]] const XMLElement& named(const XMLElement& from, const char* attribute,
                                        const std::string& name) const {
    const char* text = from.Attribute(attribute);
    const std::string url = text != nullptr ? text : "";
    const auto found = url.size() > 1 && url[0] == '#' ? ids_.find(url.substr(1)) : ids_.end();
    if (found != ids_.end() && (name.empty() || name == found->second->Name())) {
      return *found->second;
    }
    throw ConfigError("a " + nameOf(from) + " refers to '" + printable(url) +
                      "', which is not in this file");
  }

  [[nodiscard]] std::vector<Vector3> positionsOf(const XMLElement& source) const {
    const XMLElement* accessor = elementAt(source, {"technique_common", "accessor"});
    if (accessor == nullptr) throw ConfigError("a <source> has no <accessor>");
    const XMLElement& array = named(*accessor, "source", "float_array");
    const std::vector<double> numbers = numbersOf(array);
    if (numbers.size() < countIn(array, "count", 0)) {
      throw ConfigError("a <float_array> has fewer numbers than its count says");
    }
    const auto [x, y, z] = coordinateOffsets(*accessor);
    const std::size_t count = countIn(*accessor, "count", 0);
    const std::size_t first = countIn(*accessor, "offset", 0);
    const std::size_t stride = countIn(*accessor, "stride", 1);
    const std::size_t furthest = std::max({x, y, z});
    if (stride <= furthest) throw ConfigError("a position's stride is less than its coordinates");
    if (count > 0 && first + (count - 1) * stride + furthest >= numbers.size()) {
      throw ConfigError("an <accessor> reaches beyond its <float_array>");
    }
    std::vector<Vector3> positions;
    for (std::size_t i = first; positions.size() < count; i += stride) {
      positions.emplace_back(numbers[i + x], numbers[i + y], numbers[i + z]);
    }
    return positions;
  }

  /// The positions and faces of a <geometry>'s <mesh>; nothing for a spline.
  [[nodiscard]] Mesh meshOf(const XMLElement& geometry) const {
    Mesh mesh;
    const XMLElement* element = geometry.FirstChildElement("mesh");
    if (element == nullptr || faceListsOf(*element).empty()) return mesh;
    const XMLElement* vertices = element->FirstChildElement("vertices");
    if (vertices == nullptr) throw ConfigError("a <mesh> has no <vertices>");
    mesh.vertices = positionsOf(named(inputOf(*vertices, "POSITION"), "source", "source"));
    for (const XMLElement* list : faceListsOf(*element)) FaceReader(*list, mesh).read();
    return mesh;
  }

  void addNodes(const XMLElement& parent, const Eigen::Affine3d& T, int depth) {
    for (const XMLElement* child : childrenOf(parent)) {
      if (++visits_ > kVisitsMax) throw ConfigError("it instances too many nodes");
      const std::string name = child->Name();
      if (name == "node") addNode(*child, T, depth);
      if (name == "instance_node") addNode(named(*child, "url", "node"), T, depth);
      if (name == "instance_geometry") addGeometry(named(*child, "url", "geometry"), T);
      if (name == "instance_controller")
        addController(named(*child, "url", "controller"), T, depth);
    }
  }

  void addNode(const XMLElement& node, const Eigen::Affine3d& T_parent, int depth) {
    if (depth == kDepthMax) throw ConfigError("its nodes instance each other in a circle");
    Eigen::Affine3d T = T_parent;
    for (const XMLElement* child : childrenOf(node)) T = T * transformOf(*child);
    addNodes(node, T, depth + 1);
  }

  /// A skin or morph shows its geometry, undeformed.
  void addController(const XMLElement& controller, const Eigen::Affine3d& T, int depth) {
    if (depth >= kDepthMax) throw ConfigError("its controllers name each other in a circle");
    const XMLElement* shown = controller.FirstChildElement("skin");
    if (shown == nullptr) shown = controller.FirstChildElement("morph");
    if (shown == nullptr) throw ConfigError("a <controller> has neither <skin> nor <morph>");
    const XMLElement& source = named(*shown, "source", "");
    const std::string name = source.Name();
    if (name == "geometry") return addGeometry(source, T);
    if (name != "controller") throw ConfigError("a <controller> shows no geometry");
    addController(source, T, depth + 1);
  }

  void addGeometry(const XMLElement& geometry, const Eigen::Affine3d& T) {
    const auto [entry, is_new] = geometries_.try_emplace(&geometry);
    Mesh& part = entry->second;
    if (is_new) part = meshOf(geometry);
    if (mesh_.vertices.size() + part.vertices.size() > kVerticesMax ||
        mesh_.triangles.size() + part.triangles.size() > kTrianglesMax) {
      throw ConfigError("it has too many vertices or triangles");
    }
    const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
    for (const Vector3& p : part.vertices) mesh_.vertices.emplace_back(T * p);
    for (const auto& [a, b, c] : part.triangles) {
      mesh_.triangles.push_back({first + a, first + b, first + c});
    }
  }

  const XMLElement& root_;
  std::unordered_map<std::string, const XMLElement*> ids_;
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
    throw ConfigError(std::string("it is damaged or no COLLADA file: XML error ") +
                      document.ErrorName() + " in line " + std::to_string(document.ErrorLineNum()));
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
