#pragma once

#include "tccm_monitor/shape.h"

namespace tccm::test {

inline Pose placedAt(double x, double y, double z,
                     const Eigen::Matrix3d& rotation = Eigen::Matrix3d::Identity()) {
  Pose pose = Pose::Identity();
  pose.linear() = rotation;
  pose.translation() = Vector3(x, y, z);
  return pose;
}

/// Of these sizes, around the origin.
inline UprightBox centred(double x, double y, double z) {
  const Vector3 half = 0.5 * Vector3(x, y, z);
  return {-half, half};
}

/// On all sides.
inline UprightBox grown(const UprightBox& box, double by) {
  return {box.min().array() - by, box.max().array() + by};
}

}  // namespace tccm::test
