#pragma once

#include <algorithm>

#include "config/parameter_table.h"

namespace tccm {

/// How late a robot obeys and how it comes to rest: one for all who reckon with it.
struct Braking {
  double deceleration_mps2 = 2.0;
  double reaction_time_s = 0.02;
  double margin_max_m = 0.1;
  double latency_s = 0.0;  ///< of verdicts, as measured; no parameter

  void describe(ParameterTable& table);

  /// After which a verdict on joint states of that age has an effect.
  [[nodiscard]] double delay(double joints_age_s) const {
    return reaction_time_s + std::max(0.0, latency_s + joints_age_s);
  }
};

}  // namespace tccm
