#include "cloud_assembler_config.h"

#include "tccm_monitor/config_error.h"

namespace tccm {

void CloudAssemblerConfig::describe(ParameterTable& table) {
  table.add("fixed_frame", &fixed_frame, "frame of `cloud_scan` and map, z up");
  cloud.describe(table);
  table.add("transform_gap_max_s", &transform_gap_max_s, "s", {0.001, 10.0},
            "transforms are not interpolated across a longer gap");
  table.add("transform_sample_s", &transform_sample_s, "s", {1e-4, 1.0},
            "how often the sensor's pose is looked up within a cloud");
  table.add("transform_wait_max_s", &transform_wait_max_s, "s", {0.001, 10.0},
            "a cloud that waits longer for transforms or joint states is dropped");
  table.add("marker_rate_hz", &marker_rate_hz, "Hz", {0.1, 100.0}, "of `self_filter_markers`");
}

void CloudAssemblerConfig::validate() const {
  if (fixed_frame.find_first_not_of('/') == std::string::npos) {
    throw ConfigError("fixed_frame: '" + fixed_frame + "' is no frame's name");
  }
  cloud.validate();
}

}  // namespace tccm
