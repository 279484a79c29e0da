#pragma once

#include <string>

#include "fit/primitives_file.h"
#include "fuzz/promises.h"

/// What the fuzz target of readPrimitives() and the test of its corpus do with an input.
namespace tccm::test {

/// What readPrimitives() broke of its promises on an input, or nothing.
inline std::string primitivesDefect(const std::string& input) {
  return brokenPromise([&] {
    const LinkPrimitives read = readPrimitives(input, "primitives.yaml");
    for (const auto& [link, primitives] : read) {
      promise(!primitives.empty(), "a link has no primitive");
      for (const PlacedShape& primitive : primitives) {
        promise(isRigid(primitive.pose), "a pose is not rigid");
        validate(primitive.shape, link);
      }
    }
    const std::string written = writePrimitives(read, "");
    promise(
        written.size() > (1U << 20U) || readPrimitives(written, "written").size() == read.size(),
        "what was written is not what was read");
  });
}

}  // namespace tccm::test
