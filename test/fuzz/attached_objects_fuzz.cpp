/// Makes attached objects from arbitrary bytes, and has a robot take them and let go of them.

#include "fuzz/attached_objects_input.h"
#include "fuzz/feed.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return tccm::test::feed(data, size, tccm::test::attachedObjectsDefect);
}
