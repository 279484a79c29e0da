#pragma once

#include "support/checker_fixture.h"

namespace tccm::test {

/// A region of an exemption, upright.
inline PlacedShape regionAt(double x, double y, double z, const Vector3& half_extents) {
  return {Box{half_extents}, placedAt(x, y, z)};
}

}  // namespace tccm::test
