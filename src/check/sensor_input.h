#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "config/parameter_table.h"
#include "tccm_monitor/cuboid_map.h"
#include "tccm_monitor/verdict.h"

namespace tccm {

/// The newest of what one sensor brings: its map and what becomes of its scans; and what of it is
/// missing, late or unknown.
class SensorInput {
 public:
  struct Config {
    std::string name;  ///< for what is told to people; empty where there is one sensor alone
    bool required = true;

    void describe(ParameterTable& table);
  };
  struct Limits {
    double scan_timeout_periods = 3.0;
    double map_age_max_s = 0.5;
    double self_filter_fraction_max = 0.9;
    double future_max_s = 0.1;

    void describe(ParameterTable& table);
  };
  /// What a sensor's state is judged by.
  struct Question {
    Time now;
    Time started;  ///< the first check
    const Limits& limits;
    bool joints_known;  ///< scans do not wait for them
  };

  explicit SensorInput(Config config) : config_(std::move(config)) {}

  void addScanReport(Time now, const ScanReport& report);
  void setMap(Time now, std::shared_ptr<const CuboidMap> map);
  void reset();

  [[nodiscard]] const std::string& name() const { return config_.name; }
  [[nodiscard]] bool required() const { return config_.required; }
  [[nodiscard]] const std::shared_ptr<const CuboidMap>& map() const { return map_; }
  /// Appends what is missing, late, unknown or cannot be; nothing where all is well.
  void appendCauses(const Question& question, std::vector<Cause>& causes) const;

 private:
  [[nodiscard]] Cause mapCause(const Question& question) const;
  /// No new map for too long: why.
  [[nodiscard]] Cause silenceCause(const Question& question) const;
  [[nodiscard]] Duration silenceMax(const Limits& limits) const;
  [[nodiscard]] bool scansCome(const Question& question) const;
  void append(const Cause& cause, std::vector<Cause>& causes) const;
  void measurePeriod();

  Config config_;
  std::shared_ptr<const CuboidMap> map_;
  Time map_arrival_;
  std::array<double, 9> gaps_s_ = {};  ///< between the last maps, in no order
  std::size_t gaps_ = 0;               ///< that there were
  std::optional<double> scan_period_s_;
  std::optional<Time> report_arrival_;  ///< the last that a scan came in
  std::optional<Time> assembled_;       ///< when the last scan was
  ScanReport last_report_;              ///< of the last scan that was assembled or dropped
  std::optional<Time> frame_changed_;   ///< when a scan of another frame came last
  std::string frame_change_;            ///< between which frames
  std::string self_link_;               ///< the link that most returns are taken for
};

}  // namespace tccm
