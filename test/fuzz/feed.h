#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <string>

namespace tccm::test {

/// What each fuzz target does with what libFuzzer gives it. @param defect says which promise is
/// broken on an input, or nothing.
inline int feed(const std::uint8_t* data, std::size_t size,
                std::string (*defect)(const std::string&)) {
  const std::string broken = defect(std::string(reinterpret_cast<const char*>(data), size));
  if (!broken.empty()) {
    std::cerr << "broken promise: " << broken << '\n';
    std::abort();
  }
  return 0;
}

}  // namespace tccm::test
