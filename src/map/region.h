#pragma once

#include <vector>

#include "tccm_monitor/shape.h"

namespace tccm {

/// All points within padding_m of a primitive, its border included.
struct PaddedShape {
  PlacedShape placed;      ///< its pose is T_fixed_shape
  double padding_m = 0.0;  ///< 0 to 1
};

/// The union of its shapes, in the fixed frame; empty where there are none.
using Region = std::vector<PaddedShape>;

/// The most shapes a region may have.
constexpr std::size_t kRegionShapesMax = 256;

/// @throws ConfigError naming the shape whose size, pose or padding is no good, or that there are
/// too many.
void validate(const Region& region);

/// A shape of a region, ready to be asked about many points.
class RegionPart {
 public:
  /// @param shape valid. @param growth_m comes on top of its padding.
  explicit RegionPart(const PaddedShape& shape, double growth_m = 0.0);

  /// False for what is not finite.
  [[nodiscard]] bool contains(const Vector3& p_fixed) const {
    return bounds_.contains(p_fixed) && distance(shape_, T_shape_fixed_ * p_fixed) <= reach_m_;
  }
  /// Holds the whole part; a little larger than need be.
  [[nodiscard]] const UprightBox& bounds() const { return bounds_; }

 private:
  Shape shape_;
  Pose T_shape_fixed_;
  double reach_m_;
  UprightBox bounds_;
};

}  // namespace tccm
