#pragma once

#include <algorithm>
#include <string>

namespace tccm {

/// Without the slashes that tf1 put in front of frame names.
[[nodiscard]] inline std::string withoutSlash(const std::string& frame) {
  return frame.substr(std::min(frame.find_first_not_of('/'), frame.size()));
}

}  // namespace tccm
