#pragma once

#include <map>
#include <string>
#include <vector>

#include "tccm_monitor/shape.h"

namespace tccm {

/// The primitives of each link, in the link's frame.
using LinkPrimitives = std::map<std::string, std::vector<PlacedShape>>;

/// Reads primitives that stand in place of links' own shapes:
///
///     links:
///       LINK:
///         - {shape: box, size: [x, y, z], xyz: [x, y, z], rpy: [roll, pitch, yaw]}
///         - {shape: cylinder, radius: r, length: l}
///         - {shape: capsule, radius: r, length: l}
///         - {shape: sphere, radius: r}
///
/// in metres and radians, rpy as in a URDF: about the link's fixed x, y and z in turn. xyz and rpy
/// are 0 where they are left out. Cylinders and capsules lie along z; a capsule's length is that of
/// its straight part.
/// @param owner names the file in errors.
/// @throws ConfigError naming owner, link and element, and the line where there is one: also where
/// a key is unknown, missing or there twice, and where a link has no primitive.
[[nodiscard]] LinkPrimitives readPrimitives(const std::string& yaml, const std::string& owner);

/// The YAML that readPrimitives() reads, one line a primitive, links by name, below comment's
/// lines. Sizes are rounded up and poses to the nearest at 9 decimals; sizes that were read and are
/// written again stay as they are.
/// @throws ConfigError naming the link where a primitive is none.
[[nodiscard]] std::string writePrimitives(const LinkPrimitives& primitives,
                                          const std::string& comment);

}  // namespace tccm
