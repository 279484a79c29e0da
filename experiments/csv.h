#pragma once

#include <cstdio>
#include <string>

namespace tccm::simulation {

/// A number with so many decimals, as a CSV file takes it.
[[nodiscard]] inline std::string fixed(double number, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, number);
  return text;
}

}  // namespace tccm::simulation
