#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace tccm {

/// Without the slashes that tf1 put in front of frame names. Valid as long as the name.
[[nodiscard]] inline std::string_view bareName(std::string_view frame) {
  return frame.substr(std::min(frame.find_first_not_of('/'), frame.size()));
}
/// The same, as a name of its own.
[[nodiscard]] inline std::string withoutSlash(const std::string& frame) {
  return std::string(bareName(frame));
}

}  // namespace tccm
