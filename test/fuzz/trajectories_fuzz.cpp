/// Makes trajectories from arbitrary bytes, and has a checker asked and told about them.

#include "fuzz/feed.h"
#include "fuzz/trajectories_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return tccm::test::feed(data, size, tccm::test::trajectoriesDefect);
}
