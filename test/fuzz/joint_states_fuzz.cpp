/// Makes joint states from arbitrary bytes, and has a checker judge the robot by them.

#include "fuzz/feed.h"
#include "fuzz/joint_states_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return tccm::test::feed(data, size, tccm::test::jointStatesDefect);
}
