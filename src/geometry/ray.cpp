#include "geometry/ray.h"

#include <algorithm>

#include "geometry/line_span.h"

namespace tccm {

Ray transformed(const Ray& ray, const Pose& T_target_source) {
  return {T_target_source * ray.origin, T_target_source.linear() * ray.direction};
}

std::optional<RaySpan> intersect(const Shape& shape, const Ray& ray) {
  const LineSpan span =
      std::visit([&ray](const auto& solid) { return lineSpan(solid, ray); }, shape);
  if (span.empty() || span.leave < 0.0) return std::nullopt;
  return RaySpan{std::max(0.0, span.enter), span.leave};
}

}  // namespace tccm
