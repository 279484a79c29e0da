#pragma once

#include <Eigen/Geometry>
#include <array>
#include <random>
#include <vector>

#include "tccm_monitor/shape.h"

namespace tccm::test {

/// Seeded geometry for property tests.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  /// Both ends included.
  int integer(int low, int high) { return std::uniform_int_distribution<int>(low, high)(engine_); }
  bool chance(double probability) { return uniform(0.0, 1.0) < probability; }

  Vector3 point(double reach) {
    return {uniform(-reach, reach), uniform(-reach, reach), uniform(-reach, reach)};
  }
  Vector3 pointIn(const UprightBox& box) {
    return {uniform(box.min().x(), box.max().x()), uniform(box.min().y(), box.max().y()),
            uniform(box.min().z(), box.max().z())};
  }
  /// Points of a plane, a line or a single place (2, 1, 0 dimensions), wherever it lies.
  std::vector<Vector3> flatCloud(int dimensions, int points, double scale) {
    const Pose T_fixed_cloud = pose(1.0);
    std::vector<Vector3> cloud;
    for (int i = 0; i < points; ++i) {
      Vector3 p = scale * point(1.0);
      p.tail(3 - dimensions).setZero();
      cloud.push_back(T_fixed_cloud * p);
    }
    return cloud;
  }
  Vector3 direction() {
    std::normal_distribution<double> normal;
    Vector3 v(normal(engine_), normal(engine_), normal(engine_));
    return v.normalized();
  }
  Eigen::Matrix3d rotation() {
    return Eigen::AngleAxisd(uniform(-3.1, 3.1), direction()).toRotationMatrix();
  }
  /// One of the 24 rotations that take axes to axes.
  Eigen::Matrix3d axisRotation() {
    const int first = integer(0, 2);
    const int second = (first + integer(1, 2)) % 3;
    Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
    axes(first, 0) = chance(0.5) ? 1.0 : -1.0;
    axes(second, 1) = chance(0.5) ? 1.0 : -1.0;
    axes.col(2) = axes.col(0).cross(axes.col(1));
    return axes;
  }
  /// A third of each: any; about z after a rotation from axes to axes; from axes to axes.
  Eigen::Matrix3d mixedRotation() {
    const int kind = integer(0, 2);
    if (kind == 0) return rotation();
    if (kind == 1) return axisRotation();
    return Eigen::AngleAxisd(uniform(-3.1, 3.1), Vector3::UnitZ()).toRotationMatrix() *
           axisRotation();
  }
  Pose pose(double reach) {
    Pose pose = Pose::Identity();
    pose.linear() = rotation();
    pose.translation() = point(reach);
    return pose;
  }

  /// Sizes of robot parts: 5 mm to 0.3 m, a third of them thin.
  double size() { return chance(0.33) ? uniform(0.005, 0.02) : uniform(0.02, 0.3); }
  Shape box() { return Box{{0.5 * size(), 0.5 * size(), 0.5 * size()}}; }
  Shape cylinder() { return Cylinder{0.5 * size(), 0.5 * size()}; }
  Shape capsule() { return Capsule{0.5 * size(), chance(0.05) ? 0.0 : 0.5 * size()}; }
  Shape sphere() { return Sphere{0.5 * size()}; }
  /// In the order of Shape's alternatives.
  Shape shape(std::size_t kind) {
    return kind == 0 ? box() : kind == 1 ? cylinder() : kind == 2 ? capsule() : sphere();
  }

 private:
  std::mt19937 engine_;
};

constexpr std::size_t kShapeKinds = std::variant_size_v<Shape>;

}  // namespace tccm::test
