#include "map/region.h"

#include <string>

#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr double kPaddingMax = 1.0;       // [m]
constexpr double kBoundsRounding = 1e-6;  // [m]

UprightBox boundsOf(const PlacedShape& placed, double reach_m) {
  const UprightBox tight = bounds(placed.shape, placed.pose);
  const Vector3 reach = Vector3::Constant(reach_m + kBoundsRounding);
  return {tight.min() - reach, tight.max() + reach};
}

}  // namespace

void validate(const Region& region) {
  requireInRange("shapes of the region", static_cast<double>(region.size()), 0.0,
                 static_cast<double>(kRegionShapesMax));
  for (std::size_t i = 0; i < region.size(); ++i) {
    const std::string owner = "shape " + std::to_string(i) + " of the region";
    validate(region[i].placed.shape, owner);
    if (!isRigid(region[i].placed.pose)) throw ConfigError(owner + ": its pose is not rigid");
    requireInRange(owner + ": padding_m", region[i].padding_m, 0.0, kPaddingMax);
  }
}

RegionPart::RegionPart(const PaddedShape& shape, double growth_m)
    : shape_(shape.placed.shape),
      T_shape_fixed_(shape.placed.pose.inverse()),
      reach_m_(shape.padding_m + growth_m),
      bounds_(boundsOf(shape.placed, reach_m_)) {}

}  // namespace tccm
