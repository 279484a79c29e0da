#include <array>
#include <boost/algorithm/string/predicate.hpp>
#include <boost/functional/hash.hpp>
#include <cmath>
#include <cstring>
#include <locale>
#include <sstream>
#include <unordered_map>

#include "mesh/mesh.h"
#include "mesh/text.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

// STL, OBJ, and then what they share; none of the readers names the file in its errors.

constexpr std::size_t kHeaderBytes = 80;
constexpr std::size_t kFacetsBegin = kHeaderBytes + 4;
constexpr std::size_t kNormalBytes = 12;
constexpr std::size_t kFacetBytes = 50;

/// Little-endian, as the format is and as every supported machine.
template <typename Value>
Value valueAt(const std::string& content, std::size_t position) {
  Value value;
  std::memcpy(&value, content.data() + position, sizeof(value));
  return value;
}

/// The size that a binary file states of itself; 0 where it is too short to state any.
std::size_t statedSize(const std::string& content) {
  if (content.size() < kFacetsBegin) return 0;
  return kFacetsBegin + kFacetBytes * valueAt<std::uint32_t>(content, kHeaderBytes);
}

Mesh readBinary(const std::string& content) {
  const auto facets = valueAt<std::uint32_t>(content, kHeaderBytes);
  Mesh mesh;
  mesh.vertices.reserve(std::size_t{3} * facets);
  mesh.triangles.reserve(facets);
  for (std::uint32_t facet = 0; facet < facets; ++facet) {
    const std::size_t corners = kFacetsBegin + kFacetBytes * facet + kNormalBytes;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const auto p = valueAt<std::array<float, 3>>(content, corners + 12 * corner);
      mesh.vertices.emplace_back(p[0], p[1], p[2]);
    }
    mesh.triangles.push_back({3 * facet, 3 * facet + 1, 3 * facet + 2});
  }
  return mesh;
}

bool isWord(std::string_view word, std::string_view keyword) {
  return boost::algorithm::iequals(word, keyword, std::locale::classic());
}

void expect(TokenReader& words, std::string_view keyword) {
  if (isWord(words.next(), keyword)) return;
  throw ConfigError("it is cut off or damaged: '" + std::string(keyword) +
                    "' is missing before byte " + std::to_string(words.position()));
}

void readFacet(TokenReader& words, Mesh& mesh) {
  expect(words, "facet");
  // "normal" and three numbers, which many programs leave out or wrong.
  for (int word = 0; word < 4 && !isWord(words.peek(), "outer"); ++word) words.next();
  expect(words, "outer");
  expect(words, "loop");
  std::vector<std::uint32_t> corners;
  while (isWord(words.peek(), "vertex")) {
    expect(words, "vertex");
    corners.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
    Vector3& p = mesh.vertices.emplace_back();
    for (int i = 0; i < 3; ++i) p[i] = readNumber(words, "a vertex");
  }
  expect(words, "endloop");
  expect(words, "endfacet");
  mesh.addFace(corners.data(), corners.size());
}

/// One "solid name ... endsolid name" after another.
Mesh readAscii(const std::string& content) {
  Mesh mesh;
  for (TokenReader words(content); !words.peek().empty(); words.skipLine()) {
    expect(words, "solid");
    words.skipLine();
    while (isWord(words.peek(), "facet")) readFacet(words, mesh);
    expect(words, "endsolid");
  }
  return mesh;
}

Mesh readStl(const std::string& content) {
  // Many programs begin binary files with "solid" too: a size that fits tells them apart.
  if (statedSize(content) == content.size()) return readBinary(content);
  const bool is_text = content.find('\0') == std::string::npos;
  if (is_text && isWord(TokenReader(content).peek(), "solid")) return readAscii(content);
  throw ConfigError("it is no STL file, or cut off: it has " + std::to_string(content.size()) +
                    " bytes where a binary one of its header would have " +
                    std::to_string(statedSize(content)));
}

Vector3 vertexOf(TokenReader& words) {
  std::vector<double> numbers;
  while (!words.peek().empty()) numbers.push_back(readNumber(words, "a vertex"));
  if (numbers.size() < 3) throw ConfigError("a vertex has fewer than three coordinates");
  const Vector3 p(numbers[0], numbers[1], numbers[2]);
  // A fourth number is the weight; more than four are a colour.
  return numbers.size() == 4 ? Vector3(p / numbers[3]) : p;
}

/// "7", "7/1", "7//3" or "7/1/3": the first counts, from 1 on, or from the last vertex backwards.
std::uint32_t cornerOf(std::string_view word, std::size_t vertices) {
  const auto number = toInteger(word.substr(0, word.find('/')));
  const auto count = static_cast<std::int64_t>(vertices);
  const std::int64_t index = !number || *number == 0 ? -1
                             : *number > 0           ? *number - 1
                                                     : count + *number;
  if (index < 0 || index >= count) {
    throw ConfigError("a face names vertex '" + printable(word) + "' of " + std::to_string(count));
  }
  return static_cast<std::uint32_t>(index);
}

std::vector<std::uint32_t> cornersOf(TokenReader& words, std::size_t vertices) {
  std::vector<std::uint32_t> corners;
  while (!words.peek().empty()) corners.push_back(cornerOf(words.next(), vertices));
  if (corners.empty()) throw ConfigError("a face has no corner");
  return corners;
}

/// Words that no geometry follows are passed over: materials, groups, normals, curves.
void readStatement(const std::string& line, Mesh& mesh) {
  TokenReader words(line);
  const std::string_view keyword = words.next();
  if (keyword == "v") mesh.vertices.push_back(vertexOf(words));
  if (keyword != "f" && keyword != "fo" && keyword != "l") return;
  const std::vector<std::uint32_t> corners = cornersOf(words, mesh.vertices.size());
  if (keyword != "l") return mesh.addFace(corners.data(), corners.size());
  for (std::size_t i = 1; i < corners.size(); ++i) mesh.addFace(&corners[i - 1], 2);
}

Mesh readObj(const std::string& content) {
  if (content.find('\0') != std::string::npos) throw ConfigError("it is no OBJ file: it is binary");
  Mesh mesh;
  std::istringstream lines(content);
  std::string statement;
  for (std::string line; std::getline(lines, line);) {
    line.erase(std::min(line.find('#'), line.size()));
    while (!line.empty() && line.back() == '\r') line.pop_back();
    const bool goes_on = !line.empty() && line.back() == '\\';
    if (goes_on) line.back() = ' ';
    statement += line;
    if (goes_on && !lines.eof()) continue;
    readStatement(statement, mesh);
    statement.clear();
  }
  return mesh;
}

constexpr double kFurthest = 1e3;  // [m]; beyond it is a slip of units
constexpr double kLargestScale = 1e3;

void requireScale(const Vector3& scale) {
  for (const double factor : {scale.x(), scale.y(), scale.z()}) {
    if (std::isnan(factor) || factor == 0.0 || std::abs(factor) > kLargestScale) {
      throw ConfigError("its scale has the factor " + std::to_string(factor) +
                        ", which is 0 or outside [-1000, 1000]");
    }
  }
}

Mesh readFile(const std::string& content, const std::string& uri, bool apply_up_axis) {
  if (content.empty()) throw ConfigError("the file is empty");
  if (content.size() > kMeshBytesMax) throw ConfigError("the file is larger than 256 MB");
  const auto endsWith = [&uri](const char* extension) {
    return boost::algorithm::iends_with(uri, extension, std::locale::classic());
  };
  if (endsWith(".stl")) return readStl(content);
  if (endsWith(".obj")) return readObj(content);
  if (endsWith(".dae")) return readCollada(content, apply_up_axis);
  throw ConfigError("meshes are read from .stl, .dae and .obj files only");
}

/// Of a reader's mesh, whose places may come many times and need not be finite, and whose vertices
/// may be without a triangle: scaled, each vertex once, and every vertex in a triangle.
Mesh finished(const Mesh& raw, const Vector3& scale) {
  if (raw.vertices.empty()) throw ConfigError("it holds no geometry: there is no vertex in it");
  using Place = std::array<double, 3>;
  std::unordered_map<Place, std::uint32_t, boost::hash<Place>> numbers;
  std::vector<std::uint32_t> merged;
  merged.reserve(raw.vertices.size());
  Mesh mesh;
  for (const Vector3& unscaled : raw.vertices) {
    const Vector3 p = unscaled.cwiseProduct(scale);
    if (!(p.cwiseAbs().maxCoeff() <= kFurthest) || !p.allFinite()) {
      throw ConfigError("a coordinate is not finite, or beyond 1000 m");
    }
    const auto next = static_cast<std::uint32_t>(mesh.vertices.size());
    // Adding 0 makes -0 and 0 one place.
    const auto [number, is_new] =
        numbers.emplace(Place{p.x() + 0.0, p.y() + 0.0, p.z() + 0.0}, next);
    if (is_new && next == kMeshVerticesMax) throw ConfigError("it has over 2 million vertices");
    if (is_new) mesh.vertices.push_back(p);
    merged.push_back(number->second);
  }
  std::vector<bool> used(mesh.vertices.size(), false);
  mesh.triangles.reserve(raw.triangles.size());
  for (const Mesh::Triangle& t : raw.triangles) {
    mesh.triangles.push_back({merged[t[0]], merged[t[1]], merged[t[2]]});
    for (const std::uint32_t corner : mesh.triangles.back()) used[corner] = true;
  }
  for (std::uint32_t i = 0; i < used.size(); ++i) {
    if (!used[i]) mesh.triangles.push_back({i, i, i});
  }
  return mesh;
}

}  // namespace

void Mesh::addFace(const std::uint32_t* corners, std::size_t count) {
  if (count == 1) triangles.push_back({corners[0], corners[0], corners[0]});
  if (count == 2) triangles.push_back({corners[0], corners[1], corners[1]});
  for (std::size_t i = 2; i < count; ++i) {
    triangles.push_back({corners[0], corners[i - 1], corners[i]});
  }
}

Mesh readMesh(const std::string& content, const std::string& uri, const MeshScaling& scaling) {
  try {
    requireScale(scaling.scale);
    return finished(readFile(content, uri, scaling.apply_up_axis), scaling.scale);
  } catch (const std::exception& error) {  // also where memory does not suffice
    throw ConfigError(printable(uri) + ": " + error.what());
  }
}

}  // namespace tccm
