#pragma once

#include "check/situation.h"

namespace tccm {

/// Judges whether the sensor sees the links that it should see, now and at the end of the way:
/// where it does not, the robot moves blindly (paper, section IV.B).
class OcclusionJudge {
 public:
  struct Config {
    bool stops = true;
    double slow_scale = 0.3;

    void describe(ParameterTable& table);
  };

  /// @param moving_out_scale while a hidden link comes out. @throws ConfigError
  OcclusionJudge(std::shared_ptr<const CheckedRobot> robot, const Config& config,
                 double moving_out_scale);

  void judge(const Situation& situation, Causes& causes) const;

 private:
  std::shared_ptr<const CheckedRobot> robot_;
  Config config_;
  double moving_out_scale_;
};

}  // namespace tccm
