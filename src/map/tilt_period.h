#pragma once

#include <algorithm>
#include <array>
#include <optional>

#include "config/parameter_table.h"
#include "tccm_monitor/time.h"

namespace tccm {

/// Measures the period of a tilting sensor from its tilt angle: two strokes, from one turning point
/// to the next of the same kind. A real tilt reverses and repeats steps, so a turning point counts
/// only once the angle has come back from it by the hysteresis.
class TiltPeriod {
 public:
  struct Config {
    double hysteresis_rad = 0.05;

    void describe(ParameterTable& table) {
      table.add("tilt_hysteresis_rad", &hysteresis_rad, "rad", {1e-4, 1.0},
                "the tilt has turned once it has come back by this");
    }
  };

  /// @throws ConfigError
  explicit TiltPeriod(const Config& config) : config_(validated(config)) {}

  /// @param tilt [rad], finite, at rising stamps.
  void add(Time stamp, double tilt);
  /// The next tilt is that of a sensor of which nothing is known.
  void reset() { *this = TiltPeriod(config_); }
  /// The next tilt comes after a gap: the period is measured anew, but what has tilted has to go
  /// on.
  void restart() {
    const std::optional<Duration> patience = this->patience();
    reset();
    patience_before_ = patience;
  }

  /// The longest of the last three periods between two highest and between two lowest points, so
  /// that one step back amid a stroke does not pass for a short period; nothing before the first
  /// full one.
  [[nodiscard]] std::optional<Duration> period() const {
    const auto upper = highest_.period.get(), lower = lowest_.period.get();
    if (!upper || !lower) return upper ? upper : lower;
    return std::max(*upper, *lower);
  }

  /// Whether what tilted before a gap has not swept all of it again since.
  [[nodiscard]] bool awaitsSweep() const { return patience_before_ && !period(); }

  /// Whether a tilt that was measured once stands still: it last turned, or was seen again, longer
  /// ago than its longest recent stroke and a quarter of a period.
  [[nodiscard]] bool standsStill(Time now) const {
    const std::optional<Duration> longest = patience();
    if (!longest || !begin_) return false;
    return now - last_turn_.value_or(*begin_) > *longest;
  }

 private:
  /// The longest of the last three durations.
  class Longest {
   public:
    void add(Duration duration) { last_[count_++ % last_.size()] = duration; }
    [[nodiscard]] std::optional<Duration> get() const {
      if (count_ == 0) return std::nullopt;
      return *std::max_element(last_.data(), last_.data() + std::min(count_, last_.size()));
    }

   private:
    std::array<Duration, 3> last_{};
    std::size_t count_ = 0;
  };
  /// The highest or lowest tilt since the last turning point, which may become one itself.
  struct Extreme {
    int sign;  ///< as direction_ on the way to it
    std::optional<double> tilt = {};
    Time stamp = {};
    std::optional<Time> turned = {};  ///< the last such turning point
    Longest period = {};
  };
  /// How long it may go on without a turn; nothing where it was never measured.
  [[nodiscard]] std::optional<Duration> patience() const {
    const auto whole = period(), stroke = stroke_.get();
    return whole && stroke ? *stroke + *whole / 4 : patience_before_;
  }
  /// Whether the tilt came back from an extreme, and is on its way to the other now.
  bool turns(Extreme& from, Extreme& towards, Time stamp, double tilt);

  Config config_;
  Extreme highest_{1};
  Extreme lowest_{-1};
  int direction_ = 0;          ///< 1 rising, -1 falling, 0 not known yet
  std::optional<Time> begin_;  ///< the first stamp
  std::optional<Time> last_turn_;
  std::optional<Duration> patience_before_;  ///< that of before the gap
  Longest stroke_;
};

inline void TiltPeriod::add(Time stamp, double tilt) {
  if (!begin_) begin_ = stamp;
  for (Extreme* extreme : {&highest_, &lowest_}) {
    const bool is_beyond = !extreme->tilt || extreme->sign * (tilt - *extreme->tilt) >= 0.0;
    if (!is_beyond) continue;
    extreme->tilt = tilt;
    extreme->stamp = stamp;
  }
  if (!turns(highest_, lowest_, stamp, tilt)) turns(lowest_, highest_, stamp, tilt);
}

inline bool TiltPeriod::turns(Extreme& from, Extreme& towards, Time stamp, double tilt) {
  const bool is_back = from.sign * (*from.tilt - tilt) > config_.hysteresis_rad;
  if (direction_ == towards.sign || !is_back) return false;
  // Where the tilt was first seen is no turning point: it may have been halfway.
  if (direction_ == from.sign) {
    if (from.turned) from.period.add(from.stamp - *from.turned);
    if (last_turn_) stroke_.add(from.stamp - *last_turn_);
    from.turned = last_turn_ = from.stamp;
  }
  direction_ = towards.sign;
  towards.tilt = tilt;
  towards.stamp = stamp;
  return true;
}

}  // namespace tccm
