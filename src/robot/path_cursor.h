#pragma once

#include <cstddef>
#include <vector>

#include "robot/joint_path.h"

namespace tccm {

/// Goes along a path by the metres that a primitive may have moved: the sum of what
/// its joints travel times their lever arms. So far along it is at the same place however fast the
/// path is gone.
class PathCursor {
 public:
  /// @param variables how many the paths have: nothing is allocated later.
  explicit PathCursor(std::size_t variables) : positions_(variables) {}

  /// To the path's begin. Both last as long as the cursor is used.
  /// @param arms one for each variable [m for each unit]. @pre the path is not empty
  void start(const JointPath& path, const double* arms);
  /// @return false beyond the path's end. Cheapest where it does not go back.
  [[nodiscard]] bool moveTo(double metres);

  /// When the path comes to the place; the begin of a pause.
  [[nodiscard]] double time() const { return time_s_; }
  [[nodiscard]] const std::vector<double>& positions() const { return positions_; }
  /// Whether the path moves the primitive by more than that in no time, here or passed since the
  /// last place.
  [[nodiscard]] bool hasJumped(double metres) const { return jump_m_ > metres; }
  /// From the path's begin to an instant of it.
  [[nodiscard]] double metresUntil(double time_s) const;

 private:
  [[nodiscard]] double metresAt(std::size_t point) const;
  void noteJump();

  const JointPath* path_ = nullptr;
  const double* arms_ = nullptr;
  std::size_t point_ = 0;  ///< before the place
  double before_m_ = 0.0;  ///< of that point
  double after_m_ = 0.0;   ///< of the next
  double time_s_ = 0.0;
  double jump_m_ = 0.0;
  std::vector<double> positions_;
};

}  // namespace tccm
