#pragma once

#include <vector>

#include "mesh/mesh.h"

namespace tccm {

/// The convex hull of points; its vertices are some of them, as given.
struct ConvexHull {
  Mesh surface;            ///< no triangles where the points are flat, collinear or one
  double volume_m3 = 0.0;  ///< 0 where there are no triangles
};

/// The hull by Qhull, exact up to about 1e-14 of the points' extent. Points within 1e-9 of their
/// extent from a plane count as flat; a flat hull's vertices are all the different points.
/// Finite points only; none give an empty hull.
[[nodiscard]] ConvexHull convexHull(const std::vector<Vector3>& points);

}  // namespace tccm
