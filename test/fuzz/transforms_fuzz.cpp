/// Makes transforms from arbitrary bytes, and has a history of them asked.

#include "fuzz/feed.h"
#include "fuzz/transforms_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return tccm::test::feed(data, size, tccm::test::transformsDefect);
}
