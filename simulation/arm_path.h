#pragma once

#include <memory>
#include <string>
#include <vector>

#include "robot/kinematics.h"
#include "tccm_monitor/robot_model.h"

namespace tccm::simulation {

/// A smooth way through joint space, measured by how far the faster of the two palms travels.
class ArmPath {
 public:
  /// @param knots at least two joint positions, in the order of the model's variables, whose palms
  /// differ from knot to knot; [rad].
  ArmPath(const std::shared_ptr<const RobotModel>& model, std::vector<std::vector<double>> knots);

  [[nodiscard]] double length() const { return arc_.back(); }  ///< [m]
  /// @param s [m] along the path, clamped to it.
  [[nodiscard]] std::vector<double> positions(double s) const;
  /// Change of each joint's position for each metre along the path [rad/m].
  [[nodiscard]] std::vector<double> slopes(double s) const;

 private:
  struct Segment {
    std::size_t first;  ///< knot
    double length;      ///< [m]
    double u;           ///< 0..1 along it
  };
  [[nodiscard]] Segment segmentAt(double s) const;

  std::vector<std::vector<double>> knots_;
  std::vector<std::vector<double>> tangents_;  ///< [rad/m] at each knot
  std::vector<double> arc_;                    ///< [m] at each knot
};

/// Names that armPath() knows: "reach", the right hand stretches 0.46 m forward, 0.95 to 0.92 m
/// above the floor, over a table, and "wave", both forearms swing across the front.
[[nodiscard]] std::vector<std::string> motionNames();

/// A path of the dual-arm robot. @throws ConfigError for an unknown name.
[[nodiscard]] ArmPath armPath(const std::shared_ptr<const RobotModel>& model,
                              const std::string& name);

/// The palm's link with its fingers ahead and a little down, its flat side down.
[[nodiscard]] Pose reachingPalm(const Vector3& position);

/// A path of the dual-arm robot's right hand: its palm goes straight from one place to the next, as
/// reachingPalm() has it.
/// @param places of the palm's link [m]. @throws std::runtime_error where the arm cannot reach.
[[nodiscard]] ArmPath reachVia(const std::shared_ptr<const RobotModel>& model,
                               const std::vector<Vector3>& places);

/// Joint positions that bring a link to a pose, by damped least squares over some of the joints.
struct InverseProblem {
  std::size_t link;                    ///< index into the model's links
  Pose T_root_link;                    ///< where it is to be
  std::vector<std::size_t> variables;  ///< those that may move
};

/// @param seed joint positions to start from. @throws std::runtime_error where the pose is not
/// reached to 0.1 mm and 0.1 mrad, within the limits of the joints.
[[nodiscard]] std::vector<double> solve(const std::shared_ptr<const RobotModel>& model,
                                        const InverseProblem& problem, std::vector<double> seed);

}  // namespace tccm::simulation
