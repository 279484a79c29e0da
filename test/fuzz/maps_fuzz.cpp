/// Makes maps from arbitrary bytes, and has a checker judge a robot before them.

#include "fuzz/feed.h"
#include "fuzz/maps_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return tccm::test::feed(data, size, tccm::test::mapsDefect);
}
