#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "tccm_monitor/time.h"

namespace tccm {

using Vector3 = Eigen::Vector3d;
/// A rigid transform. T_a_b takes coordinates in frame b to coordinates in frame a.
using Pose = Eigen::Isometry3d;

/// The way from one pose to another: linear in the translation, spherical in the rotation, as
/// Eigen's slerp(), but what all places of the way have in common is computed once.
class Interpolation {
 public:
  Interpolation(const Pose& from, const Pose& to);
  /// @param u 0 gives from, 1 gives to.
  [[nodiscard]] Pose at(double u) const;

 private:
  Eigen::Quaterniond q_from_;
  Eigen::Quaterniond q_to_;  ///< in the hemisphere of q_from_
  double angle_;             ///< between the two quaternions; 0 where it hardly is one
  double per_sine_;          ///< 1 over the sine of the angle
  Vector3 p_from_;
  Vector3 p_to_;
};

/// How far a point within that radius of a frame's origin moves at most from one pose of the frame
/// to another, on the shortest way [m].
[[nodiscard]] double displacement(const Pose& from, const Pose& to, double radius_m);

/// False where a number is NaN or infinite, the rotation is none, or it lies beyond 1000 km.
[[nodiscard]] bool isRigid(const Pose& pose);

/// The poses of one moving frame at rising instants, interpolated in between, never beyond.
class PosePath {
 public:
  /// @return false, and nothing is added, unless stamp is later than the last one's and the pose is
  /// rigid.
  bool add(Time stamp, const Pose& pose);
  void clear();
  [[nodiscard]] bool covers(Time first, Time last) const;
  /// Nothing outside the instants that were added. Cheapest when asked for rising instants.
  [[nodiscard]] std::optional<Pose> at(Time stamp) const;

 private:
  std::vector<Time> stamps_;
  std::vector<Pose> poses_;
  mutable std::size_t hint_ = 0;
  mutable std::optional<Interpolation> from_hint_;  ///< to the pose after that
};

}  // namespace tccm
