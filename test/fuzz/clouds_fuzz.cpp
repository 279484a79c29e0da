/// Makes clouds from arbitrary bytes, and has a map made of them.

#include "fuzz/clouds_input.h"
#include "fuzz/feed.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return tccm::test::feed(data, size, tccm::test::cloudsDefect);
}
