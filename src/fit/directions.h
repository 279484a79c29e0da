#pragma once

#include <Eigen/Core>
#include <vector>

#include "tccm_monitor/pose.h"

namespace tccm {

using Matrix3X = Eigen::Matrix3Xd;

/// Unit vectors spread evenly over the half sphere z >= 0, the same at every call.
[[nodiscard]] std::vector<Vector3> hemisphereDirections(int count);

/// The points' principal axes, the longest first; any right-handed axes where they are not unique.
[[nodiscard]] Eigen::Matrix3d principalAxes(const std::vector<Vector3>& points);

/// A rotation whose third column is the unit vector z.
[[nodiscard]] Eigen::Matrix3d axesAbout(const Vector3& z);

/// Adds direction unless one of directions points the same or the opposite way.
/// @param least_angle [rad]
void addIfDifferent(std::vector<Vector3>& directions, const Vector3& direction, double least_angle);

/// Thins points out to those that are the farthest along one of many fixed directions, so that
/// their hull is nearly that of all.
class ExtremePoints {
 public:
  /// @param directions at most twice as many points are left
  explicit ExtremePoints(int directions);

  [[nodiscard]] std::vector<Vector3> of(const std::vector<Vector3>& points) const;

 private:
  Eigen::Matrix<double, Eigen::Dynamic, 3> directions_;  // a row each, of one half sphere
};

}  // namespace tccm
