#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "check/checked_robot.h"
#include "robot/joint_path.h"

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
  /// @param margin_max_m none is larger.
  WayCheck(std::shared_ptr<const CheckedRobot> robot, double step_m, double margin_max_m);

  [[nodiscard]] const std::vector<std::size_t>& shapes() const { return body_.shapes; }

  /// How fast each of shapes() moves at most along the way, from poses a quarter of it apart, and
  /// how much it grows by for that. Lasts until the next call.
  /// @param per_speed_s metres for each metre a second that the primitive moves at.
  void setMargins(const JointPath& path, double from_s, double to_s,
                  const std::vector<Pose>& T_fixed_roots, double per_speed_s);
  /// Speeds stay known.
  void clearMargins();
  /// Shapes of these contacts are not looked at until the next call.
  void skip(const std::vector<Contact>& contacts);

  /// The first contact from one instant of the path to another, both included.
  /// @param T_fixed_roots one for each of the model's roots; they stand still.
  /// @param look_at_begin false: the pose at from_s is known to be free.
  [[nodiscard]] std::optional<WayContact> firstContact(const CuboidMap& map, const JointPath& path,
                                                       double from_s, double to_s,
                                                       const std::vector<Pose>& T_fixed_roots,
                                                       bool look_at_begin = true);
  /// At how many poses the last firstContact() looked.
  [[nodiscard]] std::size_t poses() const { return poses_; }

 private:
  /// A stretch of the way, and what could not be proven free on the stretch that it is a part of.
  struct Stretch {
    std::vector<std::uint32_t> shapes;  ///< that may touch something in it
    std::vector<double> travel_from, travel_middle, travel_to, travel;
    std::vector<double> positions;
  };
  /// What was found of a shape at one instant of the way.
  struct Known {
    double clearance_m = 0.0;              ///< at least
    std::vector<double> travel;            ///< of the variables until then
    std::optional<std::uint32_t> nearest;  ///< cuboid, then
  };
  struct Way {
    const CuboidMap& map;
    const JointPath& path;
    const std::vector<Pose>& T_fixed_roots;
  };
  struct Found {
    double time_s;
    Contact contact;
  };
  [[nodiscard]] std::optional<Found> search(const Way& way, double from_s, double to_s,
                                            std::size_t depth);
  [[nodiscard]] std::optional<Found> at(const Way& way, double time_s);
  [[nodiscard]] std::optional<Contact> touching(const Way& way, std::uint32_t shape,
                                                const std::vector<double>& travel);
  /// How far a shape is from everything at least, after that travel.
  [[nodiscard]] double knownClearance(std::uint32_t shape, const std::vector<double>& travel);
  /// Whether anything lies within that distance of a shape where it is now. Regions that are exempt
  /// make no difference.
  [[nodiscard]] bool comesNear(const Way& way, std::uint32_t shape,
                               const std::vector<double>& travel, double metres);
  void place(const Way& way, double time_s, std::vector<double>& positions);
  /// How far any of a shape's points is from where it is in the middle, at most.
  [[nodiscard]] double reach(std::uint32_t shape, const std::vector<double>& from,
                             const std::vector<double>& middle, const std::vector<double>& to,
                             std::vector<double>& travel) const;
  void growBodies();

  std::shared_ptr<const CheckedRobot> robot_;
  UsedBody body_;   ///< expanded as asked for
  UsedBody grown_;  ///< and by the margin
  double margin_max_m_;
  std::vector<double> margins_m_;
  std::vector<double> speeds_mps_;
  std::vector<bool> skipped_;
  Kinematics kinematics_;
  MotionBound bound_;
  double reach_max_m_;               ///< half a step
  std::vector<Stretch> stretches_;   ///< by depth
  std::vector<Known> known_;         ///< by shape
  std::vector<double> since_known_;  ///< reused
  std::size_t poses_ = 0;
};

}  // namespace tccm
