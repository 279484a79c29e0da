/// Makes messages from arbitrary bytes, and has them read.

#include "fuzz/feed.h"
#include "fuzz/messages_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return tccm::test::feed(data, size, tccm::test::messagesDefect);
}
