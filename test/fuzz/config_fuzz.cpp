/// Feeds arbitrary bytes as a configuration file to readMonitorConfig().

#include "fuzz/config_input.h"
#include "fuzz/feed.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return tccm::test::feed(data, size, tccm::test::configDefect);
}
