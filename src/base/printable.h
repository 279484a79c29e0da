#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

namespace tccm {

constexpr std::size_t kQuoteMax = 300;  ///< characters of a name or a word
constexpr std::size_t kLineMax = 1000;  ///< of a whole message

/// Text that others wrote, in files, messages or URIs, made fit for one line: control characters
/// become spaces, and what is too long is cut.
[[nodiscard]] inline std::string printable(std::string_view text, std::size_t longest = kQuoteMax) {
  std::string line(text.substr(0, longest));
  if (text.size() > longest) line += "...";
  std::replace_if(
      line.begin(), line.end(), [](unsigned char c) { return c < 0x20U || c == 0x7fU; }, ' ');
  return line;
}

}  // namespace tccm
