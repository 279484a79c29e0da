#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "tccm_monitor/shape.h"
#include "tccm_monitor/time.h"

namespace tccm::simulation {

/// How an object comes into the scene.
struct Entrance {
  Time appears;
  /// Where it appears, away from its final place [m, fixed frame]; zero: in its place at once.
  Vector3 offset = Vector3::Zero();
  double speed_mps =
      0.0;  ///< along the straight way to its place; above 0 where offset is not zero

  [[nodiscard]] Time arrives() const;
};

/// How an object leaves the scene: it goes that way, and is gone at its end.
struct Departure {
  Time leaves;
  Vector3 offset;          ///< [m, fixed frame], not zero
  double speed_mps = 0.5;  ///< above 0

  [[nodiscard]] Time gone() const;
};

/// How an object goes to and fro, straight, at one speed, between its place and another.
struct Shuttle {
  Time starts;
  Vector3 offset;          ///< of the other place [m, fixed frame], not zero
  double speed_mps = 0.2;  ///< above 0

  /// From its place at an instant.
  [[nodiscard]] Vector3 offsetAt(Time stamp) const;
};

/// A primitive in the scene; an object of several primitives is several of these with one name.
struct SceneObject {
  std::string name;
  Shape shape;
  Pose T_fixed_shape;      ///< its final place
  Eigen::Vector3f colour;  ///< red, green, blue, 0..1
  std::optional<Entrance> entrance = std::nullopt;
  std::optional<Departure> departure = std::nullopt;  ///< after it has come to its place
  std::optional<Shuttle> shuttle = std::nullopt;      ///< of what neither enters nor leaves so

  /// Nothing before it appears, and once it is gone.
  [[nodiscard]] std::optional<Pose> poseAt(Time stamp) const;
};

using World = std::vector<SceneObject>;

/// Where everything finally is.
[[nodiscard]] Body bodyOf(const World& world);

[[nodiscard]] Pose at(double x, double y, double z);

/// Names that scene() knows: "table", a table top 0.75 m high, 0.45 to 0.95 m ahead, with a mug, a
/// bottle, a box and a can; "shelf", 900 x 300 x 1200 mm, its front 0.95 m ahead, with an open
/// drawer; "empty", the floor alone, which the others have too.
[[nodiscard]] std::vector<std::string> sceneNames();

/// The table of the scene "table" with nothing on it.
[[nodiscard]] World bareTable();

/// Height of its top [m].
constexpr double kTableTop = 0.75;

/// In base_link on the floor. @throws ConfigError for an unknown name.
[[nodiscard]] World scene(const std::string& name);

}  // namespace tccm::simulation
