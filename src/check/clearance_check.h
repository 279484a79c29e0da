#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "check/collision_check.h"
#include "check/verdict.h"
#include "robot/kinematics.h"
#include "robot/link_use.h"

namespace tccm {

struct NearestCuboid;

/// The distance from each link to the nearest cuboid: of the primitives as they are, without
/// padding. Only cuboids with enough support count, as for contacts.
class ClearanceCheck {
 public:
  /// @param radius_m what is further away is not looked for.
  /// @throws ConfigError
  ClearanceCheck(std::shared_ptr<const RobotModel> model, const LinkUse& collision_use,
                 const CollisionCheck::Config& collision, double radius_m);

  /// One entry for each link that is checked for collision, in the order of their first primitives;
  /// the reference is valid until the next call.
  const std::vector<LinkClearance>& find(const CuboidMap& map, const std::vector<double>& positions,
                                         const std::vector<Pose>& T_fixed_roots);
  /// The least of all links; infinite where no cuboid lies within the radius. Faster than find().
  [[nodiscard]] double least(const CuboidMap& map, const std::vector<double>& positions,
                             const std::vector<Pose>& T_fixed_roots);

 private:
  /// The nearest cuboid that is nearer than that.
  [[nodiscard]] std::optional<NearestCuboid> nearest(const CuboidMap& map, const Shape& shape,
                                                     const Pose& T_fixed_shape,
                                                     double nearer_than_m) const;

  std::shared_ptr<const RobotModel> model_;
  std::vector<std::size_t> shapes_;         ///< indices into the model's shapes
  std::vector<std::size_t> slot_of_shape_;  ///< index into result_
  CollisionCheck collision_;
  Kinematics kinematics_;
  double radius_m_;
  std::vector<LinkClearance> result_;
};

}  // namespace tccm
