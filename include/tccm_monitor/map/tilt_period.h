#pragma once

#include <optional>

#include "tccm_monitor/time.h"

namespace tccm {

/// Measures the period of a tilting sensor from its tilt angle: two strokes, from one turning point
/// to the next of the same kind. A real tilt reverses and repeats steps, so a turning point counts
/// only once the angle has come back from it by the hysteresis.
class TiltPeriod {
 public:
  struct Config {
    double hysteresis_rad = 0.05;

    /// @throws ConfigError
    void validate() const;
  };

  /// @throws ConfigError
  explicit TiltPeriod(const Config& config);

  /// @param tilt [rad], finite, at rising stamps.
  void add(Time stamp, double tilt);
  void reset();

  /// The longer of the last period between two highest and that between two lowest points; nothing
  /// before the first full one.
  [[nodiscard]] std::optional<Duration> period() const;

 private:
  struct TurningPoints {
    std::optional<Time> last;
    std::optional<Duration> period;
    void add(Time stamp);
  };

  Config config_;
  std::optional<double> highest_;  ///< since the last turning point
  std::optional<double> lowest_;
  Time highest_stamp_;
  Time lowest_stamp_;
  int direction_ = 0;  ///< 1 rising, -1 falling, 0 not known yet
  TurningPoints upper_;
  TurningPoints lower_;
};

}  // namespace tccm
