/// Feeds arbitrary bytes as a mesh file to readMesh() and the fit.

#include "fuzz/feed.h"
#include "fuzz/mesh_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return tccm::test::feed(data, size, tccm::test::meshDefect);
}
