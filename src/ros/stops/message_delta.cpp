#include "ros/stops/message_delta.h"

#include <algorithm>
#include <cstring>

namespace tccm {
namespace {

constexpr std::size_t kBlock = 32;

}  // namespace

void toChange(const std::vector<std::uint8_t>& before, const std::vector<std::uint8_t>& message,
              tccm_monitor::CuboidMapChange& change) {
  change.length = static_cast<std::uint32_t>(message.size());
  change.begins.clear();
  change.lengths.clear();
  change.bytes.clear();
  for (std::size_t at = 0; at < message.size(); at += kBlock) {
    const std::size_t size = std::min(kBlock, message.size() - at);
    const bool same =
        at + size <= before.size() && std::memcmp(&before[at], &message[at], size) == 0;
    if (same) continue;
    const bool goes_on =
        !change.begins.empty() && change.begins.back() + change.lengths.back() == at;
    if (goes_on) {
      change.lengths.back() += static_cast<std::uint32_t>(size);
    } else {
      change.begins.push_back(static_cast<std::uint32_t>(at));
      change.lengths.push_back(static_cast<std::uint32_t>(size));
    }
    const auto first = message.begin() + static_cast<std::ptrdiff_t>(at);
    change.bytes.insert(change.bytes.end(), first, first + static_cast<std::ptrdiff_t>(size));
  }
}

std::string applyChange(const tccm_monitor::CuboidMapChange& change,
                        std::vector<std::uint8_t>& message) {
  if (change.begins.size() != change.lengths.size()) return "its lists differ in length";
  message.resize(change.length);
  std::size_t taken = 0;
  for (std::size_t i = 0; i < change.begins.size(); ++i) {
    const std::size_t begin = change.begins[i], length = change.lengths[i];
    if (begin > message.size() || length > message.size() - begin ||
        length > change.bytes.size() - taken) {
      return "a run lies outside of the message";
    }
    std::copy_n(change.bytes.begin() + static_cast<std::ptrdiff_t>(taken), length,
                message.begin() + static_cast<std::ptrdiff_t>(begin));
    taken += length;
  }
  return {};
}

}  // namespace tccm
