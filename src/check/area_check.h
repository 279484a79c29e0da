#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "check/pose_check.h"
#include "tccm_monitor/verdict.h"

namespace tccm {

/// Whether the map says anything of where the robot is. A robot that has left the map's area
/// altogether meets nothing there, whatever stands in its way.
class AreaCheck {
 public:
  explicit AreaCheck(std::shared_ptr<const CheckedRobot> robot);

  /// OUTSIDE_AREA where nothing that moves of what is checked for collision is inside the map's
  /// area, not even in part; else CLEAR. Moves: over a joint; where the roots move, or no joint
  /// moves anything, all of it.
  /// @param fixed_frame for what is told to people.
  [[nodiscard]] Cause judge(const Grid& grid, const Posture& posture, bool roots_move,
                            const std::string& fixed_frame) const;

 private:
  std::shared_ptr<const CheckedRobot> robot_;
  std::vector<std::size_t> moved_;  ///< over a joint; indices into the model's shapes
};

}  // namespace tccm
