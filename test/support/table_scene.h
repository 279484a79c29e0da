#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "simulation/robot/dual_arm.h"
#include "support/cuboid_scene.h"
#include "support/look_around.h"

namespace tccm::test {

/// A table top 0.75 m high that reaches from 0.4 to 1.1 m ahead of the dual-arm robot, with four
/// objects on it, as the sensor on the robot's head would map it: about 2,000 cuboids at 20 mm.
inline CuboidMap tableMap() {
  CuboidMap map = emptyMap();
  const auto block = [&map](double x, double y, double bottom, double size_xy, double top) {
    addBlock(map, {Vector3(x, y, bottom), Vector3(x + size_xy, y + size_xy, top)}, 3);
  };
  addBlock(map, {Vector3(0.4, -0.5, 0.73), Vector3(1.1, 0.5, 0.75)}, 3);
  block(0.75, -0.1, 0.751, 0.16, 0.98);
  block(0.95, 0.25, 0.751, 0.16, 0.90);
  block(0.60, -0.06, 0.751, 0.10, 0.83);
  block(0.90, -0.40, 0.751, 0.20, 1.05);
  map.viewpoint = Vector3(0.09, 0.0, 1.535);
  lookAround(map);
  return map;
}

/// Both arms of the dual-arm robot bent ahead by that much at the shoulders [rad], the hands level;
/// at -0.7 they are some 30 mm of free air above the table, their padding taken off.
inline std::vector<double> armsAhead(const RobotModel& model, double shoulder) {
  std::vector<double> positions(model.variables().size(), 0.0);
  for (const std::string side : {"left_", "right_"}) {
    positions[simulation::variableIndex(model, side + "shoulder_pitch_joint")] = shoulder;
    positions[simulation::variableIndex(model, side + "elbow_joint")] = -1.55 - shoulder;
  }
  return positions;
}

}  // namespace tccm::test
