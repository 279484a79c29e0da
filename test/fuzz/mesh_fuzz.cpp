/// Feeds arbitrary bytes as a mesh file to readMesh() and the fit.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <string>

#include "fuzz/mesh_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string input(reinterpret_cast<const char*>(data), size);
  const std::string defect = tccm::test::meshDefect(input);
  if (!defect.empty()) {
    std::cerr << "broken promise: " << defect << '\n';
    std::abort();
  }
  return 0;
}
