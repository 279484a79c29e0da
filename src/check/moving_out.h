#pragma once

#include <memory>
#include <string>
#include <vector>

#include "check/checked_robot.h"
#include "robot/joint_path.h"

namespace tccm {

/// Tells a motion that ends a contact from one that goes on into it. For each pair of primitive and
/// cuboid that touch, the distance of the primitive's core (its axis or middle) to the cuboid is
/// followed along the way: none may become less, and at the end each must be more. A primitive that
/// did not touch must not begin to, and none may come nearer to anything than it was. Where a core
/// itself is in a cuboid, no way out can be told. Looked at are so many poses that no primitive
/// moves further than 10 mm from one to the next.
class MovingOut {
 public:
  explicit MovingOut(std::shared_ptr<const CheckedRobot> robot);

  /// When a primitive may have moved that far along the way; its end where none does.
  [[nodiscard]] double timeOf(const JointPath& way, double metres);
  /// @param contacts of the pose at the way's begin.
  /// @param must_open false: it is enough that nothing closes.
  [[nodiscard]] bool opens(const CuboidMap& map, const std::vector<Contact>& contacts,
                           const JointPath& way, double until_s,
                           const std::vector<Pose>& T_fixed_roots, bool must_open);

 private:
  /// Of one contact.
  struct Pair {
    std::size_t shape;  ///< index into the body's shapes
    std::uint32_t cuboid;
    double first_m, last_m;  ///< distance of the core
  };
  [[nodiscard]] double coreDistance(const CuboidMap& map, std::size_t shape,
                                    std::uint32_t cuboid) const;
  void place(const JointPath& way, double time_s, const std::vector<Pose>& T_fixed_roots);
  [[nodiscard]] bool closesAny(const CuboidMap& map);
  [[nodiscard]] bool closesBetween(const CuboidMap& map, const JointPath& way, double from_s,
                                   double to_s, const std::vector<Pose>& T_fixed_roots);
  /// How far any primitive moves at most.
  [[nodiscard]] double furthest(const JointPath& way, double from_s, double to_s);

  std::shared_ptr<const CheckedRobot> robot_;
  UsedBody body_;
  std::vector<Shape> cores_;
  Kinematics kinematics_;
  MotionBound bound_;
  std::size_t contacts_max_;
  std::vector<Contact> contacts_;  ///< at the pose looked at
  std::size_t poses_ = 0;
  std::vector<double> positions_;
  std::vector<double> travel_from_, travel_;
  std::vector<Pair> pairs_;
  std::vector<double> least_m_;  ///< of each shape in contact at the begin, infinite for others
};

}  // namespace tccm
