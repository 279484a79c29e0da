#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "check/pose_check.h"
#include "robot/joint_path.h"
#include "robot/motion_bound.h"

namespace tccm {

/// Finds the first contact of a robot along a way through joint space: not at a few poses, but at
/// so many that no primitive moves further than a step from one to the next. Stretches over which
/// nothing can touch are proven free at once: whatever a primitive passes lies within its pose in
/// the middle, grown by how far it moves (adaptive bisection after Schwarzer, Saha, Latombe:
/// Adaptive dynamic collision checking, IEEE T-RO 2005). A contact that is passed over is no deeper
/// than half a step.
class WayCheck {
 public:
  /// @param step_m no primitive moves further between two poses that are looked at.
  WayCheck(std::shared_ptr<const CheckedRobot> robot, double step_m);

  /// The first contact from one instant of the way to another, both included.
  /// @param look_at_begin false: the pose at from_s is known to be free.
  [[nodiscard]] std::optional<WayContact> firstContact(const Way& way, double from_s, double to_s,
                                                       bool look_at_begin = true);
  /// Contacts that do not count from now on, until the next call. Shapes are numbered as the
  /// model's.
  void leave(const std::vector<Contact>& contacts);
  /// At how many poses the last firstContact() looked.
  [[nodiscard]] std::size_t poses() const { return poses_; }
  /// How much may be done from now on until a way counts as too long to be judged, in the unit of
  /// CollisionCheck::work().
  void allow(std::size_t work);
  /// Whether more would have been needed since: then what firstContact() did not find may be there.
  [[nodiscard]] bool isTooLong() const { return is_too_long_; }

 private:
  /// What was found of a shape at one instant of the way.
  struct Known {
    double clearance_m = 0.0;              ///< at least
    std::vector<double> travel;            ///< of the variables until then
    std::optional<std::uint32_t> nearest;  ///< obstacle, then
  };
  struct Found {
    double time_s;
    Contact contact;
  };
  [[nodiscard]] std::optional<Found> search(const Way& way, double from_s, double to_s,
                                            std::size_t depth);
  [[nodiscard]] std::optional<Found> at(const Way& way, double time_s);
  /// Whether no more may be done. Notes it.
  [[nodiscard]] bool isExhausted();
  /// Puts the robot where it is at an instant of the way.
  void place(const Way& way, double time_s);

  // Of a shape of the robot as it was placed last:

  [[nodiscard]] std::optional<Contact> touching(const Way& way, std::uint32_t shape);
  /// The first cuboid that a solid there touches and that counts.
  /// @param T_fixed_links where regions are that move with links; without it they do not count.
  [[nodiscard]] std::optional<std::uint32_t> first(const Way& way, const Shape& solid,
                                                   std::uint32_t shape,
                                                   const std::vector<Pose>* T_fixed_links) const;
  /// How far it is from everything at least.
  [[nodiscard]] double knownClearance(std::uint32_t shape);
  /// Whether anything lies within that distance. Regions that are exempt make no difference.
  [[nodiscard]] bool comesNear(const Way& way, std::uint32_t shape, double metres);

  std::shared_ptr<const CheckedRobot> robot_;
  UsedBody body_;
  Kinematics kinematics_;
  MotionBound bound_;
  double reach_max_m_;  ///< half a step
  /// Shapes that may touch something in a stretch of the way, by the number of halvings that made
  /// it: those that could not be proven free on the stretch that it is a part of.
  std::vector<std::vector<std::uint32_t>> near_;
  std::vector<Known> known_;                      ///< by shape
  std::vector<std::vector<std::uint32_t>> left_;  ///< the same: cuboids that do not count
  bool leaves_any_ = false;
  std::size_t poses_ = 0;
  std::size_t work_ = 0;      ///< without that of the collision check
  std::size_t work_end_ = 0;  ///< of both; see allow()
  bool is_too_long_ = false;
  std::vector<double> positions_, travel_;  ///< of the variables as the robot was placed last
  std::vector<double> travel_from_, travel_to_, reach_, since_known_;  ///< reused
};

}  // namespace tccm
