#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "tccm_monitor/robot_model.h"

namespace tccm {

/// How one joint gets from a trajectory's point to the next, as ros_controllers'
/// JointTrajectoryController takes it: straight where one of them has no velocities, else a cubic
/// spline, and a quintic one where both have accelerations.
class JointSpline {
 public:
  struct State {
    double position, velocity, acceleration;  ///< [rad or m], per second, per second squared
  };

  /// @param joint its place in the points. @pre b is later than a
  JointSpline(const JointTrajectory::Point& a, const JointTrajectory::Point& b, std::size_t joint) {
    const auto at = [joint](const std::vector<double>& values) {
      return values.empty() ? 0.0 : values[joint];
    };
    const State from{a.positions[joint], at(a.velocities), at(a.accelerations)};
    const State to{b.positions[joint], at(b.velocities), at(b.accelerations)};
    const double T = b.time_s - a.time_s, d = to.position - from.position;
    c_[0] = from.position;
    if (a.velocities.empty() || b.velocities.empty()) {
      c_[1] = d / T;
    } else if (a.accelerations.empty() || b.accelerations.empty()) {
      makeCubic(from, to, T);
    } else {
      makeQuintic(from, to, T);
    }
  }

  /// @param t [s] since the first of the points.
  [[nodiscard]] double position(double t) const {
    return c_[0] + t * (c_[1] + t * (c_[2] + t * (c_[3] + t * (c_[4] + t * c_[5]))));
  }
  [[nodiscard]] State at(double t) const {
    return {position(t),
            c_[1] + t * (2.0 * c_[2] + t * (3.0 * c_[3] + t * (4.0 * c_[4] + t * 5.0 * c_[5]))),
            2.0 * c_[2] + t * (6.0 * c_[3] + t * (12.0 * c_[4] + t * 20.0 * c_[5]))};
  }
  /// No second derivative on [0, T] is larger: that of its Bernstein coefficients.
  [[nodiscard]] double curvatureMax(double T) const {
    const double a = 2.0 * c_[2], b = 6.0 * c_[3] * T;
    const double d = 12.0 * c_[4] * T * T, e = 20.0 * c_[5] * T * T * T;
    return std::max({std::abs(a), std::abs(a + b / 3.0), std::abs(a + (2.0 * b + d) / 3.0),
                     std::abs(a + b + d + e)});
  }

 private:
  void makeCubic(const State& a, const State& b, double T) {
    const double d = b.position - a.position;
    c_[1] = a.velocity;
    c_[2] = (3.0 * d - (2.0 * a.velocity + b.velocity) * T) / (T * T);
    c_[3] = (-2.0 * d + (a.velocity + b.velocity) * T) / (T * T * T);
  }
  void makeQuintic(const State& a, const State& b, double T) {
    const double d = b.position - a.position, T2 = T * T, T3 = T2 * T;
    c_[1] = a.velocity;
    c_[2] = 0.5 * a.acceleration;
    c_[3] = (20.0 * d - (8.0 * b.velocity + 12.0 * a.velocity) * T -
             (3.0 * a.acceleration - b.acceleration) * T2) /
            (2.0 * T3);
    c_[4] = (-30.0 * d + (14.0 * b.velocity + 16.0 * a.velocity) * T +
             (3.0 * a.acceleration - 2.0 * b.acceleration) * T2) /
            (2.0 * T3 * T);
    c_[5] =
        (12.0 * d - 6.0 * (b.velocity + a.velocity) * T + (b.acceleration - a.acceleration) * T2) /
        (2.0 * T3 * T2);
  }

  std::array<double, 6> c_{};  ///< the polynomial's coefficients, from the lowest power
};

}  // namespace tccm
