#pragma once

#include <string>

#include "scan/cloud_stage.h"

namespace tccm {

/// What the nodelet CloudAssembler is configured with.
struct CloudAssemblerConfig {
  std::string fixed_frame = "base_link";
  CloudStage::Config cloud;
  double transform_gap_max_s = 0.1;
  double transform_sample_s = 0.004;
  double transform_wait_max_s = 0.5;
  double marker_rate_hz = 10.0;

  void describe(ParameterTable& table);
  /// @throws ConfigError
  void validate() const;
};

}  // namespace tccm
