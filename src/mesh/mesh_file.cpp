#include <algorithm>
#include <array>
#include <boost/algorithm/string/predicate.hpp>
#include <boost/functional/hash.hpp>
#include <cmath>
#include <cstdio>
#include <locale>
#include <set>
#include <sstream>
#include <string_view>
#include <unordered_map>

#include "base/printable.h"
#include "mesh/mesh.h"
#include "mesh/text.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

// OBJ, and then what the readers share.

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

/// Whether it is an OBJ file that was written to the end, and of nothing: each of its lines is a
/// comment or a statement of the format's. Other files are none, or cut off before their faces.
bool isEmptyObj(const std::string& content) {
  static const std::set<std::string_view> kKeywords{"o",      "g",      "s",  "vn", "vt",
                                                    "usemtl", "mtllib", "mg", "lod"};
  std::istringstream lines(content);
  bool has_line = false;
  for (std::string line; std::getline(lines, line);) {
    const std::string_view keyword = TokenReader(line).peek();
    if (keyword.empty()) continue;
    if (keyword.front() != '#' && kKeywords.count(keyword) == 0) return false;
    has_line = true;
  }
  return has_line;
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
  if (!mesh.triangles.empty() || isEmptyObj(content)) return mesh;
  throw ConfigError("it is no OBJ file, or cut off: it has " +
                    std::to_string(mesh.vertices.size()) + " vertices and no face");
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

std::string oneDecimal(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
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

/// Which of a reader's vertices are a corner of a face.
std::vector<bool> usedVertices(const Mesh& raw) {
  std::vector<bool> used(raw.vertices.size(), false);
  for (const Mesh::Triangle& t : raw.triangles) {
    for (const std::uint32_t corner : t) used[corner] = true;
  }
  return used;
}

Vector3 scaled(const Vector3& p, const Vector3& scale) {
  const Vector3 result = p.cwiseProduct(scale);
  if (!result.allFinite()) throw ConfigError("a coordinate is not finite, or beyond 1000 m");
  const double furthest = result.cwiseAbs().maxCoeff();
  if (furthest <= kFurthest) return result;
  throw ConfigError(oneDecimal(furthest) +
                    " m is the furthest coordinate, beyond 1000 m (millimetres? scale 0.001 is "
                    "missing)");
}

/// Of a reader's mesh, whose places may come many times and need not be finite, and whose vertices
/// may be without a triangle: scaled, each vertex once, and every vertex in a triangle.
Mesh finished(const Mesh& raw, const Vector3& scale) {
  Mesh mesh;
  mesh.warnings = raw.warnings;
  if (raw.triangles.empty()) {
    mesh.warnings.emplace_back("it is empty: it has no face");
    return mesh;
  }
  const std::vector<bool> used = usedVertices(raw);
  using Place = std::array<double, 3>;
  std::unordered_map<Place, std::uint32_t, boost::hash<Place>> numbers;
  std::vector<std::uint32_t> merged(raw.vertices.size(), 0);
  for (std::size_t i = 0; i < raw.vertices.size(); ++i) {
    if (!used[i]) continue;
    const Vector3 p = scaled(raw.vertices[i], scale);
    const auto next = static_cast<std::uint32_t>(mesh.vertices.size());
    // Adding 0 makes -0 and 0 one place.
    const auto [number, is_new] =
        numbers.emplace(Place{p.x() + 0.0, p.y() + 0.0, p.z() + 0.0}, next);
    if (is_new && next == kMeshVerticesMax) throw ConfigError("it has over 2 million vertices");
    if (is_new) mesh.vertices.push_back(p);
    merged[i] = number->second;
  }
  mesh.triangles.reserve(raw.triangles.size());
  for (const Mesh::Triangle& t : raw.triangles) {
    mesh.triangles.push_back({merged[t[0]], merged[t[1]], merged[t[2]]});
  }
  const auto unused = std::count(used.begin(), used.end(), false);
  if (unused > 0) {
    mesh.warnings.push_back(std::to_string(unused) + " of its " + std::to_string(used.size()) +
                            " vertices are left out: no face uses them");
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
