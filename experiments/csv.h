#pragma once

#include <cstdio>
#include <optional>
#include <string>
#include <type_traits>

namespace tccm::simulation {

/// A number with so many decimals.
[[nodiscard]] inline std::string fixed(double number, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, number);
  return text;
}
/// Empty where there is none.
[[nodiscard]] inline std::string fixed(const std::optional<double>& number, int decimals) {
  return number ? fixed(*number, decimals) : "";
}

[[nodiscard]] inline std::string csvCell(const std::string& text) { return text; }
/// A truth is 1 or 0. Of numbers that are not whole, fixed() says how many decimals.
template <typename Whole, typename = std::enable_if_t<std::is_integral_v<Whole>>>
[[nodiscard]] std::string csvCell(Whole number) {
  return std::to_string(number);
}

/// Some of a line's cells, as a cell of csvRow().
template <typename First, typename... Others>
[[nodiscard]] std::string csvCells(const First& first, const Others&... others) {
  std::string text = csvCell(first);
  ((text += ',' + csvCell(others)), ...);
  return text;
}

/// A line of a CSV file.
template <typename... Cells>
[[nodiscard]] std::string csvRow(const Cells&... cells) {
  return csvCells(cells...) + '\n';
}

}  // namespace tccm::simulation
