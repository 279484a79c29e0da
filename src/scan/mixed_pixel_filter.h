#pragma once

#include "config/parameter_table.h"
#include "scan/assembled_scan.h"

namespace tccm {

/// Removes points whose nearest neighbours in the scan are separated from them: pseudo points that
/// a beam split between two surfaces leaves in between (paper, section VI.A, Fig. 12 left).
class MixedPixelFilter {
 public:
  struct Config {
    double separation_m = 0.06;  ///< 0 switches the filter off

    void describe(ParameterTable& table);
  };

  /// @throws ConfigError
  explicit MixedPixelFilter(const Config& config);

  /// Turns a return into kMixedPixel where neither the beam before nor the one after measured a
  /// point within separation_m of it. A neighbour that measured nothing counts as separated.
  void apply(AssembledScan& scan) const;

 private:
  Config config_;
};

}  // namespace tccm
