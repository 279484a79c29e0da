#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

namespace tccm {

/// What a contact ahead asks for, by its time and the speed of the link that touches. Sooner or
/// faster never asks for less.
struct Halting {
  double horizon_s, stop_time_s, slow_scale_min;  ///< as ContactJudge::Config has them
  double delay_s;                                 ///< after which a verdict has an effect
  double deceleration_mps2;

  /// For how long a way has to be looked along: until the horizon, and as far as reaction and
  /// braking take.
  [[nodiscard]] double lookTime(double speed_mps) const {
    return std::max(horizon_s, delay_s + 0.5 * speed_mps / deceleration_mps2);
  }
  /// A contact that comes sooner cannot be waited for.
  [[nodiscard]] double haltTime(double speed_mps) const {
    return stop_time_s + delay_s + 0.5 * speed_mps / deceleration_mps2;
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
    const double a = deceleration_mps2;
    const double allowed =
        a * (std::sqrt(delay_s * delay_s + 2.0 * time_s * speed_mps / a) - delay_s);
    return std::min(1.0, allowed / speed_mps);
  }
};

}  // namespace tccm
