#include "check/self_test.h"

#include <algorithm>

#include "robot/kinematics.h"

namespace tccm {
namespace {

/// One cuboid with enough returns, of a cell's size, around the fixed frame's origin.
CuboidMap mapOfOneCuboid(int points) {
  constexpr double kCell = 0.02;
  Grid::Config config;
  config.cell_size_m = kCell;
  config.size_x_m = config.size_y_m = 0.5;
  config.origin_x_m = config.origin_y_m = -0.25 + 0.5 * kCell;
  config.height_min_m = -1.0;
  config.height_max_m = 1.0;
  CuboidMap map;
  map.grid = Grid(config);
  Cuboid cuboid;
  cuboid.cell = *map.grid.cellOf(Vector3::Zero());
  cuboid.top = map.grid.heightOf(0.5 * kCell);
  cuboid.bottom = map.grid.heightOf(-0.5 * kCell);
  cuboid.points = static_cast<std::uint32_t>(points);
  map.cuboids.push_back(cuboid);
  indexCells(map);
  map.viewpoint = Vector3(0.0, 0.0, 1.0);
  map.complete = true;
  return map;
}

}  // namespace

std::vector<std::string> selfTest(const CheckedRobot& robot, PoseCheck& check) {
  const RobotModel& model = robot.model();
  // Some pose within the limits; the middles of the primitives are known at any.
  std::vector<double> positions;
  for (const JointVariable& variable : model.variables()) {
    const bool limited = variable.lower && variable.upper;
    positions.push_back(limited ? 0.5 * (*variable.lower + *variable.upper) : 0.0);
  }
  const std::vector<Pose> T_fixed_roots(model.roots().size(), Pose::Identity());
  Kinematics at_rest(robot.sharedModel()), moved(robot.sharedModel());
  at_rest.update(positions, T_fixed_roots);
  const CollisionCheck::Config& rule = robot.config().collision;
  const CuboidMap map = mapOfOneCuboid(rule.support_points);
  const auto most = static_cast<std::size_t>(rule.contacts_max);
  std::vector<std::string> missed;
  PoseFindings findings;
  for (const std::size_t shape : robot.collisionBody().shapes) {
    // The robot is moved to the cuboid.
    std::vector<Pose> roots = T_fixed_roots;
    for (Pose& pose : roots) pose.pretranslate(-at_rest.shapePoses()[shape].translation());
    check.findContacts(map, moved.update(positions, roots), findings);
    const auto& contacts = findings.contacts;
    const bool found = contacts.size() == most || std::any_of(contacts.begin(), contacts.end(),
                                                              [shape](const Contact& contact) {
                                                                return contact.shape == shape;
                                                              });
    const std::string& link = model.linkOf(shape);
    if (!found && std::find(missed.begin(), missed.end(), link) == missed.end()) {
      missed.push_back(link);
    }
  }
  return missed;
}

}  // namespace tccm
