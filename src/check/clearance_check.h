#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "check/checked_robot.h"

namespace tccm {

struct NearestCuboid;

/// The distance from each link to the nearest cuboid: of the primitives as they are, without
/// padding. Only cuboids with enough support count, as for contacts.
class ClearanceCheck {
 public:
  /// @param radius_m what is further away is not looked for.
  ClearanceCheck(std::shared_ptr<const CheckedRobot> robot, double radius_m);

  /// One entry for each link that is checked for collision, in the order of their first primitives;
  /// the reference is valid until the next call.
  const std::vector<LinkClearance>& find(const CuboidMap& map, const Posture& posture);
  /// The least of all links; infinite where no cuboid lies within the radius. Faster than find().
  [[nodiscard]] double least(const CuboidMap& map, const Posture& posture) const;

 private:
  /// The nearest cuboid that is nearer than that. @param shape of the model.
  [[nodiscard]] std::optional<NearestCuboid> nearest(const CuboidMap& map, const Posture& posture,
                                                     std::size_t shape, double nearer_than_m) const;

  std::shared_ptr<const CheckedRobot> robot_;
  std::vector<std::size_t> slot_of_shape_;  ///< index into result_
  double radius_m_;
  std::vector<LinkClearance> result_;
};

}  // namespace tccm
