#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "check/collision_check.h"
#include "geometry/shape.h"
#include "robot/robot_model.h"
#include "tccm_monitor/time.h"

namespace tccm {

/// For a while a link may touch what lies in a region: to grasp, to dock.
struct Exemption {
  std::string owner;
  std::string link;    ///< name, or a pattern that means one link
  PlacedShape region;  ///< in the fixed frame
  Time until;
};

/// The exemptions in force: by link and region, timed, named; there is none for everything.
class Exemptions {
 public:
  struct Config {
    double duration_max_s = 60.0;
    int count_max = 32;

    /// @throws ConfigError
    void validate() const;
  };

  /// @throws ConfigError
  explicit Exemptions(const Config& config) : config_((config.validate(), config)) {}

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
