#pragma once

#include <cstddef>
#include <vector>

#include "check/collision_check.h"
#include "config/parameter_table.h"
#include "tccm_monitor/robot_model.h"
#include "tccm_monitor/verdict.h"

namespace tccm {

/// The exemptions in force: by link and region, timed, named; there is none for everything.
class Exemptions {
 public:
  struct Config {
    double duration_max_s = 60.0;
    int count_max = 32;

    void describe(ParameterTable& table);
  };

  /// @throws ConfigError
  explicit Exemptions(const Config& config) : config_(validated(config)) {}

  /// One of the same owner for the same link is replaced. @param duration_s 0 ends it.
  /// @throws ConfigError naming what is wrong with it; then nothing changes.
  void add(Time now, const Exemption& exemption, double duration_s, const RobotModel& model);
  /// @return whether any ended.
  bool expire(Time now);
  void clear() { list_.clear(); }

  [[nodiscard]] const std::vector<Exemption>& list() const { return list_; }
  /// For each of the shapes the regions that it may touch things in; empty where there is no
  /// exemption at all.
  [[nodiscard]] ExemptRegions regionsOf(const RobotModel& model,
                                        const std::vector<std::size_t>& shapes) const;

 private:
  Config config_;
  std::vector<Exemption> list_;
};

}  // namespace tccm
