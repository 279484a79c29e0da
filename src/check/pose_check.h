#pragma once

#include <memory>
#include <string>
#include <vector>

#include "check/checked_robot.h"

namespace tccm {

/// Collision and occlusion of a whole robot at one pose.
class PoseCheck {
 public:
  /// @param old_periods looks that are older than so many tilt periods say nothing.
  PoseCheck(std::shared_ptr<const CheckedRobot> robot, double old_periods);

  /// @param findings reused. Contacts name the model's shapes, links the model's links.
  void check(const CuboidMap& map, const Posture& posture, PoseFindings& findings);
  /// The parts of it, in this order.
  void findContacts(const CuboidMap& map, const Posture& posture, PoseFindings& findings);
  void findOcclusion(const CuboidMap& map, const Posture& posture, PoseFindings& findings);

  [[nodiscard]] const OcclusionCheck& occlusion() const { return occlusion_; }
  /// The primitives as checked for collision, and as drawn for occlusion, at the last pose; the
  /// latter not placed where occlusion is not checked.
  [[nodiscard]] const UsedBody& collisionBody() const { return collision_body_; }
  [[nodiscard]] const UsedBody& occlusionBody() const { return occlusion_body_; }
  [[nodiscard]] bool isOccluded(const LinkVisibility& link) const {
    return occlusion_.isOccluded(link);
  }
  /// The name of the link that is occluded most; empty where none is occluded.
  [[nodiscard]] std::string mostHiddenLink(const PoseFindings& findings) const;

 private:
  std::shared_ptr<const CheckedRobot> robot_;
  UsedBody collision_body_;
  UsedBody occlusion_body_;
  OcclusionCheck occlusion_;
};

}  // namespace tccm
