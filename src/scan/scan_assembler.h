#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "config/parameter_table.h"
#include "scan/assembled_scan.h"
#include "tccm_monitor/shape.h"

namespace tccm {

/// Removes points whose nearest neighbours in the scan are separated from them: pseudo points that
/// a beam split between two surfaces leaves in between (paper, section VI.A, Fig. 12 left).
struct MixedPixelFilter {
  double separation_m = 0.06;

  void describe(ParameterTable& table);
  /// Turns a return into kMixedPixel where neither the beam before nor the one after measured a
  /// point within separation_m of it. A neighbour that measured nothing counts as separated.
  void apply(AssembledScan& scan) const;
};

/// Removes what the sensor saw of the robot itself: points in or near the body, and the false
/// points that a beam grazing the body's edge leaves behind it (paper, section VI.A, Fig. 12
/// right).
struct BodyFilter {
  double range_tolerance_m = 0.05;  ///< noise moves a point along its beam alone
  double grazing_m = 0.01;
  double shadow_depth_m = 0.3;  ///< unlimited depth costs a tenth of the scene

  void describe(ParameterTable& table);
  /// Turns returns into kSelf, where they lie within a shape's padding, or on a beam through it and
  /// within the range tolerance, or kShadow. Each beam is compared with the sample nearest to it in
  /// time. A primitive that contains the sensor (a laser's housing) casts no shadow.
  /// @param samples at rising instants; empty leaves the scan as it is.
  void apply(const std::vector<BodySample>& samples, AssembledScan& scan) const;

 private:
  class Reach;
  /// @param self_counts of the shape that it is taken for grows by one.
  [[nodiscard]] BeamKind classify(const Beam& beam, const Body& body, Reach& reach,
                                  std::vector<std::size_t>& self_counts) const;
};

/// From a scan's ranges to filtered points in the fixed frame: projection beam by beam, range
/// limits, mixed-pixel filter, self filter (paper, Fig. 11 (2) and (3)).
struct ScanAssembler {
  std::size_t scan_beams_max = 4096;
  /// A scan with more says nothing about free space: it must not pass for one that saw nothing.
  double scan_unknown_fraction_max = 0.9;
  MixedPixelFilter mixed_pixel;
  BodyFilter body;

  void describe(ParameterTable& table);
  /// @param T_fixed_sensor the sensor's poses, covering the scan from first to last beam.
  /// @param samples of the body over the same time; empty where no robot is to be filtered.
  /// @param result reused; left without beams on failure.
  /// @return empty, or why the scan must be dropped: malformed, no_transform or blind.
  [[nodiscard]] std::string assemble(const LaserScan& scan, const PosePath& T_fixed_sensor,
                                     const std::vector<BodySample>& samples,
                                     AssembledScan& result) const;
};

}  // namespace tccm
