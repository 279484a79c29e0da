#pragma once

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

    void describe(ParameterTable& table);
  };

  /// @throws ConfigError
  explicit TiltPeriod(const Config& config);

  /// @param tilt [rad], finite, at rising stamps.
  void add(Time stamp, double tilt);
  void reset();

  /// The longest of the last three periods between two highest and between two lowest points, so
  /// that one step back amid a stroke does not pass for a short period; nothing before the first
  /// full one.
  [[nodiscard]] std::optional<Duration> period() const;

  /// Whether the tilt goes on: it last turned not longer ago than its longest recent stroke and a
  /// quarter of a period. False before the first full period.
  [[nodiscard]] bool isAlive(Time now) const;

 private:
  /// The longest of the last three durations.
  class Longest {
   public:
    void add(Duration duration);
    [[nodiscard]] std::optional<Duration> get() const;

   private:
    std::array<Duration, 3> last_{};
    std::size_t count_ = 0;
  };
  struct TurningPoints {
    std::optional<Time> last;
    Longest period;
  };
  void turn(Time stamp, TurningPoints& points);

  Config config_;
  std::optional<double> highest_;  ///< since the last turning point
  std::optional<double> lowest_;
  Time highest_stamp_;
  Time lowest_stamp_;
  int direction_ = 0;  ///< 1 rising, -1 falling, 0 not known yet
  TurningPoints upper_;
  TurningPoints lower_;
  std::optional<Time> last_turn_;
  Longest stroke_;
};

}  // namespace tccm
