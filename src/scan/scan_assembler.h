#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "config/parameter_table.h"
#include "scan/assembled_scan.h"
#include "scan/body_filter.h"
#include "scan/mixed_pixel_filter.h"

namespace tccm {

/// From a scan's ranges to filtered points in the fixed frame: projection beam by beam, range
/// limits, mixed-pixel filter, self filter (paper, Fig. 11 (2) and (3)).
class ScanAssembler {
 public:
  struct Config {
    std::size_t scan_beams_max = 4096;
    /// A scan of which more beams are unknown or too close than this says nothing about free space:
    /// the sensor is blind, and the scan must not pass for one that saw nothing.
    double scan_unknown_fraction_max = 0.9;
    MixedPixelFilter::Config mixed_pixel;
    BodyFilter::Config body;

    void describe(ParameterTable& table);
  };

  /// @throws ConfigError
  explicit ScanAssembler(const Config& config);

  /// @param T_fixed_sensor the sensor's poses, covering the scan from first to last beam.
  /// @param body samples over the same time; empty where no robot is to be filtered.
  /// @param result reused; left without beams on failure.
  /// @return empty, or why the scan must be dropped: malformed, no_transform or blind.
  [[nodiscard]] std::string assemble(const LaserScan& scan, const PosePath& T_fixed_sensor,
                                     const std::vector<BodySample>& body,
                                     AssembledScan& result) const;

 private:
  Config config_;
  MixedPixelFilter mixed_pixel_filter_;
  BodyFilter body_filter_;
};

}  // namespace tccm
