#pragma once

#include <string>

namespace tccm {

/// What would drive the XML parser into the ground, in one line; empty where nothing would. The
/// parser behind urdfdom calls itself for each element within an element, and compares each
/// attribute of an element with all others.
[[nodiscard]] std::string xmlDefect(const std::string& text);

}  // namespace tccm
