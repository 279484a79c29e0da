/// Feeds arbitrary bytes as a file of primitives to readPrimitives().

#include "fuzz/feed.h"
#include "fuzz/primitives_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return tccm::test::feed(data, size, tccm::test::primitivesDefect);
}
