#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

namespace tccm {

/// How far a link goes on that brakes.
struct BrakingWay {
  /// Of the speed times stop_duration_s: ros_controllers' JointTrajectoryController halts on the
  /// quintic spline that goes from a speed to the opposite one in twice that time, up to its peak.
  static constexpr double kStopShare = 0.625;

  double deceleration_mps2 = 2.0;
  double stop_duration_s = 0.0;  ///< that halting takes at least

  /// In which it would go as far at its speed.
  [[nodiscard]] double time(double speed_mps) const {
    return std::max(0.5 * speed_mps / deceleration_mps2, kStopShare * stop_duration_s);
  }
  /// How fast the share of its speed falls that it still has [1/s].
  [[nodiscard]] double fall(double speed_mps) const {
    const double slowly = deceleration_mps2 / speed_mps;
    if (!(stop_duration_s > 0.0)) return slowly;
    return std::min(slowly, 0.5 / (kStopShare * stop_duration_s));
  }
  /// The speed that uses up a way in a time and by braking after it; 0 where there is no way.
  [[nodiscard]] double speedFor(double way_m, double time_s) const {
    if (!(way_m > 0.0)) return 0.0;
    const double a = deceleration_mps2;
    const double slow = a * (std::sqrt(time_s * time_s + 2.0 * way_m / a) - time_s);
    if (!(stop_duration_s > 0.0)) return slow;
    return std::min(slow, way_m / (time_s + kStopShare * stop_duration_s));
  }
};

/// What a contact ahead asks for, by its time and the speed of the link that touches. Sooner or
/// faster never asks for less.
struct Halting {
  double horizon_s, stop_time_s, slow_scale_min;  ///< as ContactJudge::Config has them
  double delay_s;                                 ///< after which a verdict has an effect
  BrakingWay way;

  /// For how long a way has to be looked along: until the horizon, and as far as reaction and
  /// braking take.
  [[nodiscard]] double lookTime(double speed_mps) const {
    return std::max(horizon_s, delay_s + way.time(speed_mps));
  }
  /// A contact that comes sooner cannot be waited for.
  [[nodiscard]] double haltTime(double speed_mps) const {
    return stop_time_s + delay_s + way.time(speed_mps);
  }
  /// Of the speed, for a contact that can be waited for.
  [[nodiscard]] double scale(double time_s, double speed_mps) const {
    const double halt_s = haltTime(speed_mps), span_s = horizon_s - halt_s;
    const double share = span_s > 0.0 ? (time_s - halt_s) / span_s : 0.0;
    return std::clamp(share, slow_scale_min, 1.0);
  }
  /// Later contacts ask for a larger scale than that.
  [[nodiscard]] double latest(double scale, double speed_mps) const {
    const double halt_s = haltTime(speed_mps);
    return halt_s + scale * std::max(0.0, horizon_s - halt_s);
  }
  /// At which the robot halts within what it goes in that time at full speed; at most 1.
  [[nodiscard]] double scaleWithin(double time_s, double speed_mps) const {
    const BrakingWay steady{way.deceleration_mps2, 0.0};
    const double scale = std::min(1.0, steady.speedFor(time_s * speed_mps, delay_s) / speed_mps);
    if (!(way.stop_duration_s > 0.0)) return scale;
    return std::min(scale, time_s / (delay_s + BrakingWay::kStopShare * way.stop_duration_s));
  }
};

}  // namespace tccm
