#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tccm_monitor/check/pose_check.h"
#include "tccm_monitor/robot/joint_path.h"

namespace tccm {

/// Tells a motion that ends a contact from one that goes on into it. For each pair of primitive and
/// cuboid that touch, the distance of the primitive's core (its axis or middle) to the cuboid is
/// followed along the way: none may become less, and at the end each must be more. A primitive that
/// did not touch must not begin to, and none may come nearer to anything than it was. Where a core
/// itself is in a cuboid, no way out can be told.
class MovingOut {
 public:
  /// @throws ConfigError
  MovingOut(std::shared_ptr<const RobotModel> model, const PoseCheck::Config& config);

  void exempt(const ExemptRegions& regions) { collision_.exempt(regions); }
  /// @param contacts of the pose at the way's begin.
  /// @param must_open false: it is enough that nothing closes.
  [[nodiscard]] bool opens(const CuboidMap& map, const std::vector<Contact>& contacts,
                           const JointPath& way, double until_s,
                           const std::vector<Pose>& T_fixed_roots, bool must_open);

 private:
  /// Of one contact.
  struct Pair {
    std::size_t shape;  ///< index into used_
    std::uint32_t cuboid;
    double first_m, last_m;  ///< distance of the core
  };
  [[nodiscard]] double coreDistance(const CuboidMap& map, std::size_t shape,
                                    std::uint32_t cuboid) const;
  void place(const JointPath& way, double time_s, const std::vector<Pose>& T_fixed_roots);
  [[nodiscard]] bool closesAny(const CuboidMap& map);

  std::shared_ptr<const RobotModel> model_;
  UsedShapes used_;
  Body body_;
  std::vector<Shape> cores_;
  Kinematics kinematics_;
  CollisionCheck collision_;
  std::size_t contacts_max_;
  std::vector<double> positions_;
  std::vector<Pair> pairs_;
  std::vector<double> least_m_;  ///< of each shape in contact at the begin, infinite for others
};

}  // namespace tccm
