#pragma once

#include <functional>
#include <string>

namespace tccm {

/// The bytes of what a URI, such as package://robot/meshes/arm.stl, stands for.
/// Throws ConfigError "uri: why" where it cannot be had.
using ReadResource = std::function<std::string(const std::string& uri)>;

}  // namespace tccm
