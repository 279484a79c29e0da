#include <array>
#include <boost/algorithm/string/predicate.hpp>
#include <cstring>
#include <locale>

#include "mesh/mesh_formats.h"
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
  addFace(corners, mesh);
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

}  // namespace

Mesh readStl(const std::string& content) {
  // Many programs begin binary files with "solid" too: a size that fits tells them apart.
  if (statedSize(content) == content.size()) return readBinary(content);
  const bool is_text = content.find('\0') == std::string::npos;
  if (is_text && isWord(TokenReader(content).peek(), "solid")) return readAscii(content);
  throw ConfigError("it is no STL file, or cut off: it has " + std::to_string(content.size()) +
                    " bytes where a binary one of its header would have " +
                    std::to_string(statedSize(content)));
}

}  // namespace tccm
