#pragma once

#include <gtest/gtest.h>

#include "tccm_monitor/pose.h"

namespace tccm::test {

/// Fails with both points and their distance. @param tolerance [m]
inline ::testing::AssertionResult isNearly(const Vector3& actual, const Vector3& expected,
                                           double tolerance) {
  const double apart = (actual - expected).norm();
  if (apart <= tolerance) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << actual.transpose() << " is " << apart << " away from "
                                       << expected.transpose() << ", allowed " << tolerance;
}

/// Compares origins [m] and every element of the rotations by the same tolerance.
inline ::testing::AssertionResult isNearly(const Pose& actual, const Pose& expected,
                                           double tolerance) {
  const double apart = (actual.matrix() - expected.matrix()).cwiseAbs().maxCoeff();
  if (apart <= tolerance) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "\n"
                                       << actual.matrix() << "\ndiffers by " << apart << " from\n"
                                       << expected.matrix() << "\nallowed " << tolerance;
}

}  // namespace tccm::test
