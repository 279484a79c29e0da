/// Feeds arbitrary bytes as a URDF to RobotModel.

#include "fuzz/feed.h"
#include "fuzz/robot_model_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return tccm::test::feed(data, size, tccm::test::robotModelDefect);
}
