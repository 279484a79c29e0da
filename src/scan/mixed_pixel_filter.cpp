#include "scan/mixed_pixel_filter.h"

#include "tccm_monitor/config_error.h"

namespace tccm {

void MixedPixelFilter::Config::describe(ParameterTable& table) {
  table.add("mixed_pixel_separation_m", &separation_m, "m", {0.0, 10.0},
            "a point further than this from both its neighbours in the scan is a mixed pixel; 0: "
            "no filter");
}

MixedPixelFilter::MixedPixelFilter(const Config& config) : config_(validated(config)) {}

void MixedPixelFilter::apply(AssembledScan& scan) const {
  if (config_.separation_m == 0.0) return;
  bool near_previous = false;
  for (std::size_t i = 0; i < scan.beams.size(); ++i) {
    Beam& beam = scan.beams[i];
    // A neighbour that was just found to be a mixed pixel still measured a point: the test is
    // symmetric, and does not depend on the order of the beams.
    const bool near_next =
        i + 1 < scan.beams.size() && beam.measured() && scan.beams[i + 1].measured() &&
        (scan.beams[i + 1].p_fixed - beam.p_fixed).norm() <= config_.separation_m;
    if (beam.kind == BeamKind::kReturn && !near_previous && !near_next) {
      beam.kind = BeamKind::kMixedPixel;
    }
    near_previous = near_next;
  }
}

}  // namespace tccm
