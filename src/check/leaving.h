#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "check/moving_out.h"
#include "check/obstacles.h"
#include "tccm_monitor/shape.h"

namespace tccm {

/// What one primitive touches at the present pose and is about to leave: that is not ahead, as
/// MovingOut tells whether it opens. Over as much of the way as MovingOut follows it is all that
/// touches now. After that it is what still touches at the end of that, for as long as the
/// primitive's core comes no nearer to it than there. What was left, or is gone further into, is
/// ahead as anything else. No obstacle's part in it depends on another.
class Leaving {
 public:
  /// @param contacts_max allocates for so many; more are never given.
  explicit Leaving(std::size_t contacts_max);

  /// @param touched obstacles, in rising order.
  void begin(const std::vector<std::uint32_t>& touched);
  /// With the primitive as far as MovingOut follows it.
  void passEscape(const Obstacles& obstacles, const Shape& solid, const Shape& core,
                  const Pose& T_fixed_shape);
  /// From now on, with the primitive beyond that.
  /// @return how far it may move at least until any of it is ahead [m].
  double update(const Obstacles& obstacles, const Shape& core, const Pose& T_fixed_shape);

  /// In rising order.
  [[nodiscard]] const std::vector<std::uint32_t>& obstacles() const { return obstacles_; }
  /// Exact distances that update() takes, at most.
  [[nodiscard]] std::size_t followed() const { return followed_.size(); }

 private:
  struct Followed {
    std::uint32_t obstacle;
    double nearest_m;  ///< of the core: it is ahead where that is nearer
  };
  std::vector<Followed> followed_;
  std::vector<std::uint32_t> obstacles_;
};

}  // namespace tccm
