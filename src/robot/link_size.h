#pragma once

#include <string>
#include <vector>

#include "tccm_monitor/shape.h"

namespace tccm {

/// The longest side of the box around a shape, along the shape's own axes [m].
[[nodiscard]] double longestSide(const Shape& shape);

/// A mesh and what its link says of how large it may be.
struct MeshSize {
  double longest_m = 0.0;  ///< the longest side of the upright box around it, scaled
  /// Of the link's other geometry, and how far its joints are apart [m].
  std::vector<double> others_m;
};

/// @param what the mesh or primitive, as "its mesh package://r/arm.stl".
/// @return why it cannot be meant, in one line with the likely cause; empty where it can.
[[nodiscard]] std::string sizeDefect(double longest_m, double size_max_m, const std::string& what,
                                     bool is_mesh);

/// Whether nothing but other geometry could tell that the mesh's unit is wrong.
[[nodiscard]] bool isOfDoubtfulSize(double longest_m, double size_max_m);

/// Whether they are long enough to tell anything.
[[nodiscard]] bool saysEnough(const MeshSize& mesh);

/// The same of a mesh that is a thousand times, or a thousandth, of what its link's other geometry
/// and joints suggest.
[[nodiscard]] std::string unitDefect(const MeshSize& mesh, double size_max_m,
                                     const std::string& what);

}  // namespace tccm
