#pragma once

#include <vector>

#include "config/parameter_table.h"
#include "geometry/ray.h"
#include "scan/assembled_scan.h"
#include "tccm_monitor/shape.h"

namespace tccm {

/// Removes what the sensor saw of the robot itself: points in or near the body, and the false
/// points that a beam grazing the body's edge leaves behind it (paper, section VI.A, Fig. 12
/// right).
class BodyFilter {
 public:
  struct Config {
    /// Points on beams that meet the padded body count as its own so far before and behind it:
    /// noise moves a point along its beam alone. Five times the range noise.
    double range_tolerance_m = 0.05;
    /// A beam that passes the body nearer than this grazes it. Every millimetre hides real
    /// obstacles beside the hand.
    double grazing_m = 0.01;
    /// How far behind the grazed edge points count as false. Unlimited depth costs a tenth of the
    /// scene.
    double shadow_depth_m = 0.3;

    void describe(ParameterTable& table);
  };

  /// @throws ConfigError
  explicit BodyFilter(const Config& config);

  /// Turns returns into kSelf, where they lie within a shape's padding, or on a beam through it and
  /// within the range tolerance, or kShadow. Each beam is compared with the sample nearest to it in
  /// time. A primitive that contains the sensor (a laser's housing) casts no shadow.
  /// @param samples at rising instants; empty leaves the scan as it is.
  void apply(const std::vector<BodySample>& samples, AssembledScan& scan) const;

 private:
  [[nodiscard]] BeamKind classify(const Beam& beam, const Body& body) const;

  Config config_;
};

}  // namespace tccm
