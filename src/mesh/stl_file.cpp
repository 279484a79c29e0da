#include <array>
#include <boost/algorithm/string/predicate.hpp>
#include <cmath>
#include <cstring>
#include <locale>

#include "mesh/mesh.h"
#include "mesh/text.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

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

bool has(std::string_view text, std::string_view word) {
  return boost::algorithm::icontains(text, word, std::locale::classic());
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

std::string bytesBehind(std::size_t bytes) {
  return std::to_string(bytes) + (bytes == 1 ? " byte" : " bytes") +
         " behind its last facet passed over";
}

/// One "solid name ... endsolid name" after another. What follows and is none is passed over, where
/// no facet can be in it.
Mesh readAscii(const std::string& content) {
  Mesh mesh;
  TokenReader words(content);
  for (bool is_first = true; !words.peek().empty(); is_first = false) {
    if (!is_first && !isWord(words.peek(), "solid")) {
      const std::string_view rest = std::string_view(content).substr(words.position());
      if (has(rest, "vertex")) {
        throw ConfigError("it is damaged: more facets follow behind its end");
      }
      mesh.warnings.push_back(bytesBehind(rest.size()));
      break;
    }
    expect(words, "solid");
    words.skipLine();
    while (isWord(words.peek(), "facet")) readFacet(words, mesh);
    expect(words, "endsolid");
    words.skipLine();
  }
  return mesh;
}

/// Whether the bytes from a position on may be a facet: its corners are places of a robot's size,
/// and not all one.
bool mayBeFacet(const std::string& content, std::size_t position) {
  constexpr float kNearest = 1e-6F, kFurthest = 1e6F;  // as they stand in the file
  if (content.size() - position < kFacetBytes) return false;
  const auto numbers = valueAt<std::array<float, 9>>(content, position + kNormalBytes);
  for (const float number : numbers) {
    const float size = std::abs(number);
    if (!(size == 0.0F || (size >= kNearest && size <= kFurthest))) return false;
  }
  const auto isFirst = [&](std::size_t corner) {
    return numbers[corner] == numbers[0] && numbers[corner + 1] == numbers[1] &&
           numbers[corner + 2] == numbers[2];
  };
  return !(isFirst(3) && isFirst(6));
}

/// @pre the file is as long as it states, or longer.
Mesh readWholeBinary(const std::string& content) {
  const std::size_t end = statedSize(content);
  Mesh mesh = readBinary(content);
  if (content.size() == end) return mesh;
  if (mesh.triangles.empty() || mayBeFacet(content, end)) {
    throw ConfigError("its header counts " + std::to_string(mesh.triangles.size()) +
                      " facets, and more seem to follow: the count is wrong");
  }
  mesh.warnings.push_back(bytesBehind(content.size() - end));
  return mesh;
}

/// Whether it begins as text; an ASCII file may end with other bytes.
bool isText(const std::string& content) {
  const std::string_view text = std::string_view(content).substr(0, content.find('\0'));
  return isWord(TokenReader(content).peek(), "solid") && has(text, "endsolid");
}

}  // namespace

Mesh readStl(const std::string& content) {
  // Many programs begin binary files with "solid" too: a size that fits tells them apart.
  const std::size_t stated = statedSize(content);
  if (stated > 0 && stated == content.size()) return readBinary(content);
  if (isText(content)) return readAscii(content);
  if (stated > 0 && stated < content.size()) return readWholeBinary(content);
  throw ConfigError("it is no STL file, or cut off: it has " + std::to_string(content.size()) +
                    " bytes where a binary one of its header would have " + std::to_string(stated));
}

}  // namespace tccm
