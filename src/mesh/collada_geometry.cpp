#include "mesh/collada_geometry.h"

#include <algorithm>
#include <array>

#include "mesh/mesh_formats.h"
#include "mesh/printable.h"
#include "mesh/token_reader.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using tinyxml2::XMLElement;
using Indices = std::vector<std::uint32_t>;

std::string nameOf(const XMLElement& element) { return "<" + std::string(element.Name()) + ">"; }

const XMLElement& childOf(const XMLElement& parent, const char* name) {
  const XMLElement* child = parent.FirstChildElement(name);
  if (child != nullptr) return *child;
  throw ConfigError("a " + nameOf(parent) + " has no <" + name + ">");
}

/// A count, offset or stride; fallback where the attribute is absent.
std::size_t countIn(const XMLElement& element, const char* attribute, std::size_t fallback) {
  const char* text = element.Attribute(attribute);
  if (text == nullptr) return fallback;
  const auto value = toInteger(text);
  if (!value || *value < 0) {
    throw ConfigError("a " + nameOf(element) + " has the " + attribute + " '" + printable(text) +
                      "'");
  }
  return static_cast<std::size_t>(*value);
}

/// The child <input> of that meaning; null where there is none.
const XMLElement* inputOf(const XMLElement& element, const std::string& semantic) {
  for (const XMLElement& child : ChildElements(element)) {
    const char* found = child.Attribute("semantic");
    if (std::string(child.Name()) == "input" && found != nullptr && semantic == found) {
      return &child;
    }
  }
  return nullptr;
}

std::vector<double> floatsOf(const XMLElement& array) {
  const std::string text = textOf(array);
  std::vector<double> numbers;
  for (TokenReader words(text); !words.peek().empty();) {
    numbers.push_back(readNumber(words, nameOf(array)));
  }
  if (numbers.size() < countIn(array, "count", 0)) {
    throw ConfigError("a <float_array> has fewer numbers than its count says");
  }
  return numbers;
}

/// Where x, y and z stand among an accessor's parameters: those without a name are passed over.
std::array<std::size_t, 3> coordinateOffsets(const XMLElement& accessor) {
  std::array<std::size_t, 3> offsets{0, 1, 2};
  std::size_t parameter = 0;
  std::size_t named = 0;
  for (const XMLElement& child : ChildElements(accessor)) {
    if (std::string(child.Name()) != "param") continue;
    if (child.Attribute("name") != nullptr && named < 3) offsets[named++] = parameter;
    ++parameter;
  }
  if (named == 0) return {0, 1, 2};
  if (named < 3) throw ConfigError("a position has fewer than three coordinates");
  return offsets;
}

std::vector<Vector3> positionsOf(const XMLElement& source, const ElementIds& ids) {
  const XMLElement& accessor = childOf(childOf(source, "technique_common"), "accessor");
  const std::vector<double> numbers = floatsOf(ids.at(accessor, "source", "float_array"));
  const std::array<std::size_t, 3> offsets = coordinateOffsets(accessor);
  const std::size_t count = countIn(accessor, "count", 0);
  const std::size_t first = countIn(accessor, "offset", 0);
  const std::size_t stride = countIn(accessor, "stride", 1);
  const std::size_t furthest = *std::max_element(offsets.begin(), offsets.end());
  if (stride <= furthest) throw ConfigError("a position's stride is less than its coordinates");
  if (count > 0 && first + (count - 1) * stride + furthest >= numbers.size()) {
    throw ConfigError("an <accessor> reaches beyond its <float_array>");
  }
  std::vector<Vector3> positions;
  for (std::size_t i = first; positions.size() < count; i += stride) {
    positions.emplace_back(numbers[i + offsets[0]], numbers[i + offsets[1]],
                           numbers[i + offsets[2]]);
  }
  return positions;
}

/// Adds the faces of one of a mesh's lists.
class FaceReader {
 public:
  FaceReader(const XMLElement& list, Mesh& mesh) : list_(list), mesh_(mesh) {
    const XMLElement* vertex = inputOf(list, "VERTEX");
    if (vertex == nullptr) throw ConfigError("a " + nameOf(list) + " has no VERTEX input");
    offset_ = countIn(*vertex, "offset", 0);
    for (const XMLElement& child : ChildElements(list)) {
      if (std::string(child.Name()) != "input") continue;
      stride_ = std::max(stride_, countIn(child, "offset", 0) + 1);
    }
  }

  void read() {
    const std::string name = list_.Name();
    if (name == "triangles") addEqual(3, true);
    if (name == "lines") addEqual(2, false);  // some programs state a wrong count
    if (name == "polylist") addPolylist();
    if (name == "polygons") addPolygons();
    if (name == "trifans") addRuns(list_, 0);
    if (name == "tristrips") addRuns(list_, 3);
    if (name == "linestrips") addRuns(list_, 2);
  }

  static bool isFaceList(const XMLElement& element) {
    static const std::array<const char*, 7> kNames{
        "triangles", "lines", "polylist", "polygons", "trifans", "tristrips", "linestrips"};
    return std::find(kNames.begin(), kNames.end(), std::string(element.Name())) != kNames.end();
  }

 private:
  /// The positions that one <p> names.
  [[nodiscard]] Indices corners(const XMLElement& p) const {
    const std::string text = textOf(p);
    TokenReader words(text);
    Indices found;
    std::size_t count = 0;
    for (; !words.peek().empty(); ++count) {
      const std::string_view word = words.next();
      if (count % stride_ != offset_) continue;
      const auto index = toInteger(word);
      if (!index || *index < 0 || *index >= static_cast<std::int64_t>(mesh_.vertices.size())) {
        throw ConfigError("a " + nameOf(list_) + " names vertex '" + printable(std::string(word)) +
                          "' of " + std::to_string(mesh_.vertices.size()));
      }
      found.push_back(static_cast<std::uint32_t>(*index));
    }
    if (count % stride_ != 0) throw ConfigError("a " + nameOf(list_) + " ends within a vertex");
    return found;
  }

  /// The positions of all <p> together.
  [[nodiscard]] Indices allCorners() const {
    Indices all;
    for (const XMLElement& child : ChildElements(list_)) {
      if (std::string(child.Name()) != "p") continue;
      const Indices some = corners(child);
      all.insert(all.end(), some.begin(), some.end());
    }
    return all;
  }

  /// Faces of `size` corners each, from first on.
  void addSlices(const Indices& all, std::size_t size, std::size_t step) {
    for (std::size_t i = 0; i + size <= all.size(); i += step) {
      const auto first = all.begin() + static_cast<std::ptrdiff_t>(i);
      addFace(Indices(first, first + static_cast<std::ptrdiff_t>(size)), mesh_);
    }
  }

  void addEqual(std::size_t size, bool count_holds) {
    const Indices all = allCorners();
    const std::size_t count = countIn(list_, "count", all.size() / size);
    if (all.size() % size != 0 || (count_holds && all.size() != size * count)) refuseCount();
    addSlices(all, size, size);
  }

  void addPolylist() {
    const Indices all = allCorners();
    const XMLElement* vcount = list_.FirstChildElement("vcount");
    const std::string text = vcount != nullptr ? textOf(*vcount) : "";
    std::size_t first = 0;
    std::size_t faces = 0;
    for (TokenReader words(text); !words.peek().empty(); ++faces) {
      const auto size = toInteger(words.next());
      if (!size || *size < 0 || static_cast<std::size_t>(*size) > all.size() - first) refuseCount();
      const auto begin = all.begin() + static_cast<std::ptrdiff_t>(first);
      addFace(Indices(begin, begin + *size), mesh_);
      first += static_cast<std::size_t>(*size);
    }
    if (first != all.size() || faces != countIn(list_, "count", faces)) refuseCount();
  }

  /// Holes are left filled.
  void addPolygons() {
    addRuns(list_, 0);
    for (const XMLElement& child : ChildElements(list_)) {
      if (std::string(child.Name()) == "ph") addRuns(child, 0);
    }
  }

  /// Each <p> is a strip of faces of so many corners; 0: one face.
  void addRuns(const XMLElement& parent, std::size_t size) {
    for (const XMLElement& child : ChildElements(parent)) {
      if (std::string(child.Name()) != "p") continue;
      const Indices run = corners(child);
      if (size == 0) addFace(run, mesh_);
      if (size > 0) addSlices(run, size, 1);
    }
  }

  [[noreturn]] void refuseCount() const {
    throw ConfigError("a " + nameOf(list_) + " has more or fewer indices than its counts say");
  }

  const XMLElement& list_;
  Mesh& mesh_;
  std::size_t offset_ = 0;
  std::size_t stride_ = 1;
};

}  // namespace

std::string textOf(const XMLElement& element) {
  std::string text;
  for (const auto* child = element.FirstChild(); child != nullptr; child = child->NextSibling()) {
    if (child->ToText() != nullptr) text += child->Value();
  }
  return text;
}

void ElementIds::add(const XMLElement& element) {
  if (const char* id = element.Attribute("id")) elements_.emplace(id, &element);
  for (const XMLElement& child : ChildElements(element)) add(child);
}

const XMLElement& ElementIds::at(const XMLElement& from, const char* attribute,
                                 const std::string& name) const {
  const char* text = from.Attribute(attribute);
  const std::string url = text != nullptr ? text : "";
  const auto found =
      url.size() > 1 && url[0] == '#' ? elements_.find(url.substr(1)) : elements_.end();
  if (found == elements_.end() || (!name.empty() && name != found->second->Name())) {
    throw ConfigError("a " + nameOf(from) + " refers to '" + printable(url) +
                      "', which is not in this file");
  }
  return *found->second;
}

Mesh readGeometry(const XMLElement& geometry, const ElementIds& ids) {
  Mesh mesh;
  const XMLElement* element = geometry.FirstChildElement("mesh");
  if (element == nullptr) return mesh;
  const XMLElement& vertices = childOf(*element, "vertices");
  const XMLElement* position = inputOf(vertices, "POSITION");
  if (position == nullptr) throw ConfigError("a <vertices> has no POSITION input");
  mesh.vertices = positionsOf(ids.at(*position, "source", "source"), ids);
  for (const XMLElement& child : ChildElements(*element)) {
    if (FaceReader::isFaceList(child)) FaceReader(child, mesh).read();
  }
  return mesh;
}

}  // namespace tccm
