#pragma once

#include <Eigen/Geometry>
#include <string>
#include <variant>
#include <vector>

#include "tccm_monitor/pose.h"

namespace tccm {

class ParameterTable;

/// Centred on its frame's origin. Metres, as are all lengths here.
struct Box {
  Vector3 half_extents;
};

/// Along z, centred, with flat ends.
struct Cylinder {
  double radius;
  double half_length;
};

/// Along z, centred; half_length is the straight part's, the round ends come on top.
struct Capsule {
  double radius;
  double half_length;
};

struct Sphere {
  double radius;
};

/// A solid, closed convex primitive in its own frame.
using Shape = std::variant<Box, Cylinder, Capsule, Sphere>;

/// A primitive placed in another frame, such as a link's.
struct PlacedShape {
  Shape shape;
  Pose pose = Pose::Identity();  ///< T_frame_shape
};

/// How meshes are covered by primitives.
struct PrimitiveFitConfig {
  int primitives_max = 4;  ///< for one mesh, at most 16
  /// A further primitive has to take this share away of the primitives' volume times the cube root
  /// of their overhang: it is worth its cost where it leaves less air, or air that reaches less
  /// far.
  double split_gain = 0.1;
  /// Primitives are larger by this, so that rounding leaves nothing outside.
  double margin_m = 1e-5;

  void describe(ParameterTable& table);
  void validate() const;  ///< margin_m, which is no parameter
};

using UprightBox = Eigen::AlignedBox3d;

/// How a primitive is made larger before it is checked: sizes times scale, plus padding_m on every
/// side (the paper's expansion ratio, section VI.B, and metres beside it).
struct Expansion {
  double scale = 1.0;      ///< at least 1
  double padding_m = 0.0;  ///< at least 0
};

/// The shape's sizes times scale, plus padding; contains every point within padding_m of the scaled
/// shape for sphere and capsule; box and cylinder grow along their own axes, so they contain that
/// too.
[[nodiscard]] Shape expanded(const Shape& shape, const Expansion& expansion);

[[nodiscard]] double volume(const Shape& shape);

/// Radius of the smallest sphere around the frame's origin that contains the shape.
[[nodiscard]] double boundingRadius(const Shape& shape);

/// The smallest upright box around the shape, exact up to rounding.
[[nodiscard]] UprightBox bounds(const Shape& shape, const Pose& T_fixed_shape);

/// Distance from a point in the shape's frame to the shape; 0 inside.
[[nodiscard]] double distance(const Shape& shape, const Vector3& p_shape);

/// "box", "cylinder", "capsule" or "sphere".
[[nodiscard]] std::string name(const Shape& shape);

/// @throws ConfigError naming owner unless every size is finite and above 0 (a capsule's straight
/// part may be 0).
void validate(const Shape& shape, const std::string& owner);

/// Shapes placed in one frame at one instant; shapes and poses have the same length.
struct Body {
  std::vector<Shape> shapes;
  std::vector<Pose> poses;  ///< T_fixed_shape
  /// How near a point counts as the shape's own; for the self filter alone.
  std::vector<double> paddings_m = {};
};

/// A moving body at one instant.
struct BodySample {
  Time stamp;
  Body body;
};

}  // namespace tccm
