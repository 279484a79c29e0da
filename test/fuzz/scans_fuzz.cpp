/// Makes scans from arbitrary bytes, and has a map made of them.

#include "fuzz/feed.h"
#include "fuzz/scans_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return tccm::test::feed(data, size, tccm::test::scansDefect);
}
