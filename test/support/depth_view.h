#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "geometry/ray.h"
#include "robot/kinematics.h"
#include "scan/cloud_stage.h"
#include "simulation/robot/dual_arm.h"
#include "support/table_scene.h"

namespace tccm::test {

/// The dual-arm robot at a table and before a wall, as a depth camera or a lidar sees it.
class DepthView {
 public:
  explicit DepthView(double shoulder = -0.75)
      : model_(simulation::dualArm()), positions_(armsAhead(*model_, shoulder)) {
    Kinematics kinematics(model_);
    shapes_ = kinematics.update(positions_, {Pose::Identity()}).T_fixed_shapes;
    // A camera beside and above the head, z ahead and x to the right, that looks at the forearms.
    const Vector3 eye = simulation::laserOrigin(model_, 0.0) + Vector3(-0.1, 0.3, 0.25);
    const Vector3 z = (middleAhead() - eye).normalized();
    const Vector3 x = z.cross(Vector3::UnitZ()).normalized();
    T_fixed_camera_.linear() << x, z.cross(x), z;
    T_fixed_camera_.translation() = eye;
  }

  [[nodiscard]] const std::shared_ptr<const RobotModel>& model() const { return model_; }
  /// Of the model's variables.
  [[nodiscard]] const std::vector<double>& positions() const { return positions_; }
  [[nodiscard]] const Pose& sensorPose() const { return T_fixed_camera_; }
  [[nodiscard]] PosePath sensorPath() const { return still(T_fixed_camera_); }
  [[nodiscard]] std::vector<PosePath> rootPaths() const { return {still(Pose::Identity())}; }
  /// Joint states around what is measured at 10 s.
  void tellJoints(CloudStage& stage) const {
    std::vector<std::string> names;
    for (const JointVariable& variable : model_->variables()) names.push_back(variable.name);
    for (double t = 9.5; t < 10.5; t += 0.01) {
      const Time stamp(fromSeconds(t));
      stage.addJoints(stamp, stamp, names, positions_, {});
    }
  }

  /// Where a ray from the sensor ends; nothing beyond 8 m. @param on_robot whether the robot's.
  [[nodiscard]] std::optional<double> rangeAlong(const Vector3& d_sensor, bool& on_robot) const {
    const Ray ray{T_fixed_camera_.translation(), T_fixed_camera_.linear() * d_sensor.normalized()};
    double range = std::numeric_limits<double>::infinity();
    for (const auto& [shape, pose] : {PlacedShape{Box{{0.4, 0.9, 0.02}}, at(0.95, 0.0, 0.55)},
                                      PlacedShape{Box{{0.05, 0.1, 0.15}}, at(0.9, 0.3, 0.72)},
                                      PlacedShape{Box{{0.1, 5.0, 3.0}}, at(3.0, 0.0, 1.0)},
                                      PlacedShape{Box{{5.0, 5.0, 0.1}}, at(3.0, 0.0, -0.1)}}) {
      const auto met = intersect(shape, transformed(ray, pose.inverse()));
      if (met) range = std::min(range, met->enter);
    }
    on_robot = false;
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
      const Ray in_shape = transformed(ray, shapes_[i].inverse());
      const Shape& shape = model_->shapes()[i].shape;
      if (distance(shape, in_shape.origin) == 0.0) continue;  // the head that carries it
      const auto met = intersect(shape, in_shape);
      if (!met || met->enter >= range) continue;
      range = met->enter;
      on_robot = true;
    }
    if (!(range < 8.0)) return std::nullopt;
    return range;
  }

  struct Seen {
    Cloud cloud;
    std::size_t robot_points = 0;
  };
  /// Of 640 x 480 pixels, with a Kinect's noise.
  [[nodiscard]] Seen camera(unsigned seed, const RangeNoise& noise = {}) const {
    return view(640, 480, seed, noise, [](std::size_t row, std::size_t column) {
      return Vector3((static_cast<double>(column) - 319.5) / 550.0,
                     (static_cast<double>(row) - 239.5) / 550.0, 1.0);
    });
  }
  /// Of 1024 columns in a turn and 64 rows within 45 degrees; each column has a time of its own.
  [[nodiscard]] Seen lidar(unsigned seed) const {
    Seen seen = view(1024, 64, seed, {0.01, 0.0}, [](std::size_t row, std::size_t column) {
      const double azimuth = 2.0 * M_PI * static_cast<double>(column) / 1024.0;
      const double down = M_PI / 4.0 * (static_cast<double>(row) / 63.0 - 0.5);
      return Vector3(std::cos(down) * std::sin(azimuth), std::sin(down),
                     std::cos(down) * std::cos(azimuth));
    });
    for (std::size_t i = 0; i < seen.cloud.points.size(); ++i) {
      seen.cloud.offsets_s.push_back(0.1F / 1024.0F * static_cast<float>(i % 1024));
    }
    seen.cloud.last_offset_s = static_cast<double>(seen.cloud.offsets_s.back());
    return seen;
  }

 private:
  [[nodiscard]] Vector3 middleAhead() const {
    Vector3 sum = Vector3::Zero();
    double count = 0.0;
    for (const Pose& pose : shapes_) {
      if (pose.translation().x() < 0.2) continue;
      sum += pose.translation();
      count += 1.0;
    }
    return sum / count;
  }
  static Pose at(double x, double y, double z) {
    Pose pose = Pose::Identity();
    pose.translation() = Vector3(x, y, z);
    return pose;
  }
  static PosePath still(const Pose& pose) {
    PosePath path;
    path.add(Time(fromSeconds(9.5)), pose);
    path.add(Time(fromSeconds(10.5)), pose);
    return path;
  }
  template <typename Direction>
  [[nodiscard]] Seen view(std::size_t width, std::size_t height, unsigned seed,
                          const RangeNoise& noise, const Direction& direction) const {
    Seen seen;
    seen.cloud.stamp = Time(fromSeconds(10.0));
    seen.cloud.width = width;
    seen.cloud.height = height;
    std::mt19937 engine(seed);
    std::normal_distribution<double> normal;
    for (std::size_t row = 0; row < height; ++row) {
      for (std::size_t column = 0; column < width; ++column) {
        bool on_robot = false;
        const Vector3 d = direction(row, column).normalized();
        const auto range = rangeAlong(d, on_robot);
        seen.robot_points += on_robot ? 1 : 0;
        const double off =
            range ? static_cast<double>(noise.at(static_cast<float>(*range))) * normal(engine)
                  : std::nan("");
        seen.cloud.points.push_back(((range.value_or(0.0) + off) * d).cast<float>());
      }
    }
    return seen;
  }

  std::shared_ptr<const RobotModel> model_;
  std::vector<double> positions_;
  std::vector<Pose> shapes_;
  Pose T_fixed_camera_ = Pose::Identity();
};

}  // namespace tccm::test
