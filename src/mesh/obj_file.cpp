#include <sstream>

#include "mesh/mesh_formats.h"
#include "mesh/text.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

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

void addLines(const std::vector<std::uint32_t>& corners, Mesh& mesh) {
  for (std::size_t i = 1; i < corners.size(); ++i) addFace({corners[i - 1], corners[i]}, mesh);
}

/// Words that no geometry follows are passed over: materials, groups, normals, curves.
void readStatement(const std::string& line, Mesh& mesh) {
  TokenReader words(line);
  const std::string_view keyword = words.next();
  if (keyword == "v") {
    mesh.vertices.push_back(vertexOf(words));
  } else if (keyword == "f" || keyword == "fo") {
    addFace(cornersOf(words, mesh.vertices.size()), mesh);
  } else if (keyword == "l") {
    addLines(cornersOf(words, mesh.vertices.size()), mesh);
  }
}

}  // namespace

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

}  // namespace tccm
