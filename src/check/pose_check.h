#pragma once

#include <memory>
#include <string>
#include <vector>

#include "check/checked_robot.h"

namespace tccm {

/// Collision, occlusion and clearance of a whole robot at one pose.
class PoseCheck {
 public:
  /// @param old_periods looks that are older than so many tilt periods say nothing.
  PoseCheck(std::shared_ptr<const CheckedRobot> robot, double old_periods);

  /// @param findings reused. Contacts name the model's shapes, links the model's links.
  void check(const CuboidMap& map, const Posture& posture, PoseFindings& findings);
  /// The parts of it, in this order.
  void findContacts(const CuboidMap& map, const Posture& posture, PoseFindings& findings);
  void findOcclusion(const CuboidMap& map, const Posture& posture, PoseFindings& findings);

  /// The distance from each link that is checked for collision to the nearest cuboid, in the order
  /// of their first primitives: of the primitives as they are, without padding. Only cuboids with
  /// enough support count, as for contacts. The reference is valid until the next call.
  /// @param radius_m what is further away is not looked for.
  const std::vector<LinkClearance>& findClearances(const CuboidMap& map, const Posture& posture,
                                                   double radius_m);
  /// The least of all links; infinite where no cuboid lies within the radius. Faster.
  [[nodiscard]] double leastClearance(const CuboidMap& map, const Posture& posture,
                                      double radius_m) const;

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
  /// @param shape of the model.
  [[nodiscard]] std::optional<NearestCuboid> nearest(const CuboidMap& map, const Posture& posture,
                                                     std::size_t shape, double nearer_than_m) const;

  std::shared_ptr<const CheckedRobot> robot_;
  UsedBody collision_body_;
  UsedBody occlusion_body_;
  OcclusionCheck occlusion_;
  std::vector<LinkClearance> clearances_;
  std::vector<std::size_t> clearance_of_shape_;  ///< index into clearances_, by the body's shapes
};

/// Whether the check finds what it is there for: a virtual cuboid is put into the middle of each of
/// the primitives that are to be checked for collision, and has to be found as a contact of its
/// link. A checker that silently does not check is worse than none.
/// @return the links whose cuboid was not found; none where all is well.
[[nodiscard]] std::vector<std::string> selfTest(const CheckedRobot& robot, PoseCheck& check);

}  // namespace tccm
