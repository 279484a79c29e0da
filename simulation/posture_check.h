#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "robot/kinematics.h"
#include "simulation/world.h"
#include "tccm_monitor/robot_model.h"

namespace tccm::simulation {

/// Whether the dual-arm robot's arms keep their distance from a scene, the floor apart, from each
/// other and from the body.
class PostureCheck {
 public:
  /// @param world its objects where they finally are. @param clearance_m from the scene, at least.
  PostureCheck(const std::shared_ptr<const RobotModel>& model, const World& world,
               double clearance_m);

  /// @param joints in the order of the model's variables [rad].
  [[nodiscard]] bool passes(const std::vector<double>& joints);
  /// Also where a constant velocity, either way, takes the arms within a time.
  /// @param rates of the joints [rad/s].
  [[nodiscard]] bool passesAround(const std::vector<double>& joints,
                                  const std::vector<double>& rates, double horizon_s);

 private:
  enum class Part { kTrunk, kLeftUpperArm, kLeftForearm, kRightUpperArm, kRightForearm };
  struct BodyShape {
    Shape shape;
    std::vector<Vector3> points;
    double radius;
    Part part;
  };
  struct Obstacle {
    Shape shape;
    Pose T_shape_fixed;
  };

  [[nodiscard]] static Part partOf(const std::string& link);
  [[nodiscard]] bool passesLater(std::vector<double> joints, const std::vector<double>& rates,
                                 double seconds);
  [[nodiscard]] bool nearer(std::size_t i, const Shape& other, const Pose& T_other_fixed,
                            double least) const;
  [[nodiscard]] bool meetsItself(std::size_t i) const;

  Kinematics kinematics_;
  double clearance_m_;
  std::vector<BodyShape> body_;
  std::vector<Obstacle> scene_;
};

}  // namespace tccm::simulation
