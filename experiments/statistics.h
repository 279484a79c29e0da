#pragma once

#include <cstddef>
#include <vector>

namespace tccm::simulation {

[[nodiscard]] inline double share(std::size_t part, std::size_t whole, double of_nothing = 0.0) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : of_nothing;
}

/// @param sorted ascending. @param share 0: the least, 0.5: the median, 1: the greatest.
/// @return 0 of nothing.
[[nodiscard]] inline double quantile(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return 0.0;
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

}  // namespace tccm::simulation
