/// Feeds arbitrary bytes as a file of primitives to readPrimitives().

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <string>

#include "fuzz/primitives_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string input(reinterpret_cast<const char*>(data), size);
  const std::string defect = tccm::test::primitivesDefect(input);
  if (!defect.empty()) {
    std::cerr << "broken promise: " << defect << '\n';
    std::abort();
  }
  return 0;
}
