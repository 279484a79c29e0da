#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "config/parameter_table.h"
#include "scan/cloud.h"
#include "scan/range_noise.h"
#include "tccm_monitor/laser_scan.h"

namespace tccm {

/// What is known of each point of a cloud on its way through the filters.
struct CloudState {
  std::vector<float> ranges;    ///< [m]; 0: none was measured, or none that is believed
  std::vector<BeamKind> kinds;  ///< kReturn until a filter takes it
};

/// Removes points in the air between two surfaces, which sensors make where one pixel or beam sees
/// both, from organised clouds.
struct FlyingPixelFilter {
  static constexpr std::size_t kReach = 2;  ///< rows above and below that tell of one

  double separation_m = 0.02;
  double slope_max = 6.0;

  void describe(ParameterTable& table);
  /// Turns a return into kMixedPixel where its two neighbours in the row, or those in the column,
  /// lie one before and one behind it, or where none of the four lies near it, or one alone that is
  /// a flying pixel itself or has no other near it. Near is within the separation and six times the
  /// noise, or on a surface no steeper than slope_max.
  void apply(const Cloud& cloud, const RangeNoise& noise, CloudState& state) const;
  /// In one row, of which kReach rows have their ranges; the others' kinds do not matter.
  void applyToRow(const Cloud& cloud, const RangeNoise& noise, std::size_t row,
                  CloudState& state) const;
};

/// Takes every other row and column where the points of an organised cloud lie close together: what
/// comes after costs a quarter, and a cell of the map has points enough.
struct Thinning {
  double spacing_m = 0.01;

  void describe(ParameterTable& table);
  /// Turns a return into kThinned where it lies in a row or column that is not taken, nearer than
  /// points of both have the spacing. @param step_rad the angle between neighbours; 0: not known.
  void applyToRow(const Cloud& cloud, float step_rad, std::size_t row, CloudState& state) const;
};

/// Removes points that few others lie near, from clouds that are not organised. Points are counted
/// by voxels: to ask a tree for each point's neighbours, as PCL's RadiusOutlierRemoval does, costs
/// a hundred times as much (docs/performance.md).
class SupportFilter {
 public:
  struct Config {
    double voxel_m = 0.1;
    std::size_t points_min = 3;

    void describe(ParameterTable& table);
  };

  explicit SupportFilter(const Config& config) : config_(config) {}

  /// Turns a return into kMixedPixel where in its voxel and the 26 around it there are fewer
  /// measured points than wanted, itself included.
  void apply(const Cloud& cloud, CloudState& state);

 private:
  struct Voxel {
    std::uint64_t key = 0;  ///< 0: empty
    std::uint32_t points = 0;
  };
  [[nodiscard]] std::uint64_t keyOf(const Eigen::Vector3f& point) const;
  [[nodiscard]] Voxel& find(std::uint64_t key);
  Voxel& insert(std::uint64_t key);
  void grow();
  [[nodiscard]] bool isSupported(std::uint64_t key);

  Config config_;
  std::vector<Voxel> voxels_;  ///< a hash table of a power of two, half full at most
  std::size_t mask_ = 0;
  std::size_t occupied_ = 0;
};

}  // namespace tccm
