#pragma once

#include <algorithm>
#include <string>

namespace tccm {

/// A text for people that may quote what others wrote, names from messages and files: control
/// characters become spaces, and what is too long for a line is cut.
[[nodiscard]] inline std::string oneLine(std::string text) {
  constexpr std::size_t kLongest = 1000;
  if (text.size() > kLongest) text.replace(kLongest, std::string::npos, "...");
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20U || c == 0x7fU; }, ' ');
  return text;
}

}  // namespace tccm
