#pragma once

#include <string>

namespace tccm {

/// Text from a file or a URI, made fit for an error's one line: control characters become spaces,
/// and what is too long is cut.
[[nodiscard]] inline std::string printable(std::string text) {
  constexpr std::size_t kLength = 300;
  if (text.size() > kLength) text = text.substr(0, kLength) + "...";
  for (char& c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20U || byte == 0x7fU) c = ' ';
  }
  return text;
}

}  // namespace tccm
