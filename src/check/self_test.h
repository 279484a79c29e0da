#pragma once

#include <string>
#include <vector>

#include "check/pose_check.h"

namespace tccm {

/// Whether the check finds what it is there for: a virtual cuboid is put into the middle of each of
/// the primitives that are to be checked for collision, and has to be found as a contact of its
/// link. A checker that silently does not check is worse than none.
/// @return the links whose cuboid was not found; none where all is well.
[[nodiscard]] std::vector<std::string> selfTest(const CheckedRobot& robot, PoseCheck& check);

}  // namespace tccm
