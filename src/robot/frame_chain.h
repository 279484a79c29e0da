#pragma once

#include <optional>
#include <vector>

#include "tccm_monitor/robot_model.h"
#include "tccm_monitor/time.h"

namespace tccm {

/// The joints from one link down to another.
class FrameChain {
 public:
  /// From the next root above a link of the tree. @param link index into tree.links
  FrameChain(const JointTree& tree, std::size_t link);

  /// Index of the root into the tree's links.
  [[nodiscard]] std::size_t root() const { return root_; }
  /// Whether the link is the root itself.
  [[nodiscard]] bool empty() const { return joints_.empty(); }
  /// Those of the tree's variables that move the link, each once.
  [[nodiscard]] const std::vector<std::size_t>& variables() const { return variables_; }
  /// @param positions of all variables of the tree; those of variables() count.
  /// @return T_root_link
  [[nodiscard]] Pose at(const std::vector<double>& positions) const;

 private:
  std::size_t root_;
  std::vector<RobotJoint> joints_;  ///< from the root on
  std::vector<std::size_t> variables_;
};

/// Where one pose of a link puts the point of it that another pose puts furthest from there.
struct Displacement {
  double distance_m = 0.0;
  Vector3 offset = Vector3::Zero();  ///< in the frame that the poses are in
};

/// Of the points, which are the link's, the one that is furthest off.
[[nodiscard]] Displacement worstDisplacement(const Pose& from, const Pose& to,
                                             const std::vector<Vector3>& points);

/// The corners of a box around each of the link's shapes, without what it holds.
[[nodiscard]] std::vector<Vector3> farPointsOf(const RobotModel& model, std::size_t link);

}  // namespace tccm
