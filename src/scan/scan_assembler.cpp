#include "tccm_monitor/scan/scan_assembler.h"

#include "tccm_monitor/config_error.h"
#include "tccm_monitor/scan/projection.h"

namespace tccm {

void ScanAssembler::Config::validate() const {
  requireInRange("scan_beams_max", static_cast<double>(scan_beams_max), 1.0, 1e6);
  mixed_pixel.validate();
  body.validate();
}

ScanAssembler::ScanAssembler(const Config& config)
    : config_(config), mixed_pixel_filter_(config.mixed_pixel), body_filter_(config.body) {
  config_.validate();
}

std::string ScanAssembler::assemble(const LaserScan& scan, const PosePath& T_fixed_sensor,
                                    const std::vector<BodySample>& body,
                                    AssembledScan& result) const {
  result.beams.clear();
  std::string defect = defectOf(scan, config_.scan_beams_max);
  if (!defect.empty()) return defect;
  if (!project(scan, T_fixed_sensor, result)) return "the sensor's poses do not cover it";
  mixed_pixel_filter_.apply(result);
  body_filter_.apply(body, result);
  return {};
}

}  // namespace tccm
