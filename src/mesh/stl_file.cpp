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

/// One "solid name ... endsolid name" after another.
class AsciiReader {
 public:
  explicit AsciiReader(const std::string& content) : words_(content) {}

  Mesh read() {
    while (!words_.peek().empty()) {
      expect("solid");
      words_.skipLine();
      while (isWord(words_.peek(), "facet")) readFacet();
      expect("endsolid");
      words_.skipLine();
    }
    return std::move(mesh_);
  }

 private:
  void expect(std::string_view keyword) {
    if (!isWord(words_.next(), keyword)) {
      throw ConfigError("it is cut off or damaged: '" + std::string(keyword) +
                        "' is missing before byte " + std::to_string(words_.position()));
    }
  }

  void readFacet() {
    expect("facet");
    // "normal" and three numbers, which many programs leave out or wrong.
    for (int word = 0; word < 4 && !isWord(words_.peek(), "outer"); ++word) words_.next();
    expect("outer");
    expect("loop");
    std::vector<std::uint32_t> corners;
    while (isWord(words_.peek(), "vertex")) {
      expect("vertex");
      const double x = readNumber(words_, "a vertex");
      const double y = readNumber(words_, "a vertex");
      const double z = readNumber(words_, "a vertex");
      corners.push_back(static_cast<std::uint32_t>(mesh_.vertices.size()));
      mesh_.vertices.emplace_back(x, y, z);
    }
    expect("endloop");
    expect("endfacet");
    addFace(corners, mesh_);
  }

  TokenReader words_;
  Mesh mesh_;
};

}  // namespace

Mesh readStl(const std::string& content) {
  // Many programs begin binary files with "solid" too: a size that fits tells them apart.
  if (statedSize(content) == content.size()) return readBinary(content);
  const bool is_text = content.find('\0') == std::string::npos;
  if (is_text && isWord(TokenReader(content).peek(), "solid")) return AsciiReader(content).read();
  throw ConfigError("it is no STL file, or cut off: it has " + std::to_string(content.size()) +
                    " bytes where a binary one of its header would have " +
                    std::to_string(statedSize(content)));
}

}  // namespace tccm
