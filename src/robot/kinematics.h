#pragma once

#include <memory>
#include <vector>

#include "tccm_monitor/robot_model.h"

namespace tccm {

/// A robot at one pose: computed once, and handed on to whoever asks.
struct Posture {
  std::vector<double> positions;     ///< [rad] or [m], one for each of the model's variables
  std::vector<Pose> T_fixed_roots;   ///< one for each of the model's roots
  std::vector<Pose> T_fixed_links;   ///< one for each of the model's links
  std::vector<Pose> T_fixed_shapes;  ///< one for each of the model's shapes
};

/// How a joint stands. Its turn is computed only when that changes.
class JointStand {
 public:
  /// @return whether it stands otherwise than before, to the bit.
  bool moveTo(double position, const Vector3& axis, bool turns);
  /// Takes a frame along. @param axis as in moveTo()
  void apply(const Vector3& axis, Pose& T_fixed_joint) const;

 private:
  double position_ = 0.0;
  Eigen::Matrix3d turn_ = Eigen::Matrix3d::Identity();
  bool turns_ = false;
  bool is_known_ = false;
};

/// Forward kinematics of the whole tree. Keeps its result between calls, so each thread needs its
/// own. What has not moved since the last call is not computed anew.
class Kinematics {
 public:
  explicit Kinematics(std::shared_ptr<const RobotModel> model);

  /// @param positions [rad] or [m], one for each of the model's variables, in their order.
  /// @param T_fixed_roots one for each of the model's roots, in their order.
  /// The result is valid until the next call.
  const Posture& update(const std::vector<double>& positions,
                        const std::vector<Pose>& T_fixed_roots);

  [[nodiscard]] const Posture& posture() const { return posture_; }
  [[nodiscard]] const std::vector<Pose>& linkPoses() const { return posture_.T_fixed_links; }
  [[nodiscard]] const std::vector<Pose>& shapePoses() const { return posture_.T_fixed_shapes; }

 private:
  std::shared_ptr<const RobotModel> model_;
  Posture posture_;
  std::vector<JointStand> stands_;  ///< of each of the model's joints
  std::vector<char> has_moved_;     ///< by link: in the last update()
  bool is_placed_ = false;
};

/// Forward kinematics of one link alone, for whoever asks of few links at many poses. As
/// Kinematics it keeps what does not move.
class LinkChain {
 public:
  LinkChain(const RobotModel& model, std::size_t link);

  /// Where the link is. @param positions and T_fixed_roots as Kinematics takes them.
  [[nodiscard]] Pose place(const std::vector<double>& positions,
                           const std::vector<Pose>& T_fixed_roots);
  /// How many joints move it.
  [[nodiscard]] std::size_t joints() const { return steps_.size(); }

 private:
  /// A joint that moves, with the fixed ones before it.
  struct Step {
    Pose T_parent_joint;
    Vector3 axis;
    bool turns;
    std::size_t variable;
    double multiplier, offset;
    JointStand stand = {};
    Pose T_fixed_joint = Pose::Identity();  ///< as it stands
  };
  std::size_t root_ = 0;  ///< index into the model's roots
  Pose T_fixed_root_ = Pose::Identity();
  std::vector<Step> steps_;
  Pose T_last_link_ = Pose::Identity();
};

}  // namespace tccm
