#include "scan/scan_assembler.h"

#include "scan/projection.h"
#include "tccm_monitor/config_error.h"

namespace tccm {

namespace {

double unknownFraction(const AssembledScan& scan) {
  const BeamCounts counts = scan.counts();
  const std::size_t unknown = counts[static_cast<std::size_t>(BeamKind::kUnknown)] +
                              counts[static_cast<std::size_t>(BeamKind::kTooClose)];
  return static_cast<double>(unknown) / static_cast<double>(scan.beams.size());
}

}  // namespace

void ScanAssembler::Config::describe(ParameterTable& table) {
  table.add("scan_beams_max", &scan_beams_max, "beams", {1.0, 1e6}, "a scan with more is dropped");
  table.add("scan_unknown_fraction_max", &scan_unknown_fraction_max, "", {0.0, 1.0},
            "a scan with a larger share of beams that are NaN or too close is dropped: the sensor "
            "is blind");
  mixed_pixel.describe(table);
  body.describe(table);
}

ScanAssembler::ScanAssembler(const Config& config)
    : config_(validated(config)),
      mixed_pixel_filter_(config.mixed_pixel),
      body_filter_(config.body) {}

std::string ScanAssembler::assemble(const LaserScan& scan, const PosePath& T_fixed_sensor,
                                    const std::vector<BodySample>& body,
                                    AssembledScan& result) const {
  result.beams.clear();
  if (!defectOf(scan, config_.scan_beams_max).empty()) return "malformed";
  if (!project(scan, T_fixed_sensor, result)) return "no_transform";
  if (unknownFraction(result) > config_.scan_unknown_fraction_max) {
    result.beams.clear();
    return "blind";
  }
  mixed_pixel_filter_.apply(result);
  body_filter_.apply(body, result);
  return {};
}

}  // namespace tccm
