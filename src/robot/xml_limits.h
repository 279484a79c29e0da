#pragma once

#include <string>

namespace tccm {

/// What would drive the XML parser into the ground, in one line; empty where nothing would. The
/// parser behind urdfdom calls itself for each element within an element, compares each attribute
/// of an element with all others, and reads beyond a text that ends within a character; urdfdom
/// takes values that it cannot read for format strings, and releases a link's children by
/// recursion.
[[nodiscard]] std::string xmlDefect(const std::string& text);

}  // namespace tccm
