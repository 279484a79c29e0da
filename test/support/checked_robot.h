#pragma once

#include <memory>
#include <vector>

#include "check/pose_check.h"

namespace tccm::test {

/// A robot as the checks take it.
inline std::shared_ptr<CheckedRobot> checked(const std::shared_ptr<const RobotModel>& model,
                                             const CheckedRobot::Config& config = {}) {
  return std::make_shared<CheckedRobot>(model, config);
}

/// Checked for collision, padded by so much.
inline std::shared_ptr<CheckedRobot> checked(const std::shared_ptr<const RobotModel>& model,
                                             const LinkUse& use,
                                             const CollisionCheck::Config& collision) {
  CheckedRobot::Config config;
  config.collision_use = use;
  config.collision = collision;
  return checked(model, config);
}

/// As lists, for tests.
inline std::vector<Contact> contactsOf(const CollisionCheck& check, const CuboidMap& map,
                                       const Body& body) {
  std::vector<Contact> contacts;
  check.find(map, body, contacts);
  return contacts;
}

}  // namespace tccm::test
