#pragma once

#include <cstddef>
#include <string>

namespace tccm {

/// Text from a file or a URI, made fit for an error's one line: control characters become spaces,
/// and what is too long is cut.
[[nodiscard]] inline std::string printable(std::string text, std::size_t longest = 300) {
  if (text.size() > longest) text = text.substr(0, longest) + "...";
  for (char& c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20U || byte == 0x7fU) c = ' ';
  }
  return text;
}

}  // namespace tccm
