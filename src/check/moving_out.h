#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "check/pose_check.h"
#include "robot/motion_bound.h"
#include "robot/path_cursor.h"

namespace tccm {

/// Tells a motion that ends a contact from one that goes on into it. For each pair of primitive and
/// obstacle that touch, the distance of the primitive's core (its axis or middle) to the obstacle
/// is followed along the primitive's next 100 mm: it may nowhere become less, and in the end it
/// must be more. Where a core itself is in an obstacle, no way out can be told. What does not touch
/// yet is no concern of it: that lies ahead, and is judged as such.
class MovingOut {
 public:
  static constexpr double kEscape = 0.1;   ///< [m] of a primitive's way that are followed
  static constexpr double kGrowth = 0.03;  ///< [m] that primitives are taken to be larger by
  static constexpr double kNoise = 0.002;  ///< [m] by which a distance may shrink without closing

  explicit MovingOut(const std::shared_ptr<const CheckedRobot>& robot);

  /// @param contacts of the pose at the way's begin, as PoseCheck lists them.
  /// @param must_open false: it is enough that none closes.
  [[nodiscard]] bool opens(const Way& way, const std::vector<Contact>& contacts, bool must_open);

 private:
  /// Of one contact.
  struct Pair {
    std::uint32_t obstacle;
    double first_m, last_m;  ///< distance of the core
  };
  [[nodiscard]] bool beginPairs(const Way& way, const std::vector<Contact>& contacts,
                                std::size_t i);
  /// Follows the pairs of one primitive.
  [[nodiscard]] bool stayOpen(const Way& way, std::size_t i);
  [[nodiscard]] bool closesAny(const Way& way, std::size_t i, const std::vector<double>& positions);
  [[nodiscard]] double coreDistance(const Obstacles& obstacles, std::size_t i,
                                    std::uint32_t obstacle) const;
  void place(const Way& way, std::size_t i, const std::vector<double>& positions);

  std::shared_ptr<const CheckedRobot> robot_;
  std::vector<std::size_t> shapes_;  ///< of the collision body
  std::vector<Shape> cores_;
  std::vector<LinkChain> chains_;
  MotionBound bound_;
  std::size_t contacts_max_;
  PathCursor cursor_;
  Pose T_fixed_shape_ = Pose::Identity();
  double followed_m_ = 0.0;        ///< of its way
  std::vector<Pair> pairs_;        ///< of one primitive
  std::vector<double> positions_;  ///< reused
};

}  // namespace tccm
