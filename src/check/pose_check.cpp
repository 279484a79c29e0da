#include "check/pose_check.h"

#include <algorithm>
#include <limits>

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

PoseCheck::PoseCheck(std::shared_ptr<const CheckedRobot> robot, double old_periods)
    : robot_(std::move(robot)),
      collision_body_(robot_->collisionBody()),
      occlusion_body_(robot_->occlusionBody()),
      occlusion_(robot_->config().occlusion, occlusion_body_.links, old_periods) {
  for (const std::uint32_t link : collision_body_.links) {
    clearance_of_shape_.push_back(entryOf(link, clearances_));
  }
}

void PoseCheck::check(const CuboidMap& map, const Posture& posture, PoseFindings& findings) {
  findContacts(map, posture, findings);
  findOcclusion(map, posture, findings);
}

void PoseCheck::findContacts(const CuboidMap& map, const Posture& posture, PoseFindings& findings) {
  collision_body_.place(posture);
  robot_->collision().find(map, collision_body_.body, findings.contacts);
  for (Contact& contact : findings.contacts) {
    contact.shape = static_cast<std::uint32_t>(collision_body_.shapes[contact.shape]);
  }
  findings.collision = !findings.contacts.empty();
}

void PoseCheck::findOcclusion(const CuboidMap& map, const Posture& posture,
                              PoseFindings& findings) {
  findings.links.clear();
  findings.occluding_cuboids.clear();
  findings.occlusion = false;
  if (!robot_->config().check_occlusion) return;
  occlusion_body_.place(posture);
  occlusion_.find(map, occlusion_body_.body, findings);
}

std::optional<NearestCuboid> PoseCheck::nearest(const CuboidMap& map, const Posture& posture,
                                                std::size_t shape, double nearer_than_m) const {
  return robot_->collision().nearest(map, robot_->model().shapes()[shape].shape,
                                     posture.T_fixed_shapes[shape], nearer_than_m);
}

const std::vector<LinkClearance>& PoseCheck::findClearances(const CuboidMap& map,
                                                            const Posture& posture,
                                                            double radius_m) {
  for (LinkClearance& entry : clearances_) entry = {entry.link};
  for (std::size_t i = 0; i < clearance_of_shape_.size(); ++i) {
    LinkClearance& entry = clearances_[clearance_of_shape_[i]];
    const double nearer_than_m = std::min(radius_m, entry.distance_m);
    const auto found = nearest(map, posture, collision_body_.shapes[i], nearer_than_m);
    if (found) entry = {entry.link, found->distance_m, found->cuboid};
  }
  return clearances_;
}

double PoseCheck::leastClearance(const CuboidMap& map, const Posture& posture,
                                 double radius_m) const {
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t shape : collision_body_.shapes) {
    const auto found = nearest(map, posture, shape, std::min(radius_m, least));
    if (found) least = found->distance_m;
    if (least == 0.0) break;
  }
  return least;
}

std::string PoseCheck::mostHiddenLink(const PoseFindings& findings) const {
  const LinkVisibility* most = nullptr;
  for (const LinkVisibility& link : findings.links) {
    if (!occlusion_.isOccluded(link)) continue;
    if (!most || link.occluded_fraction > most->occluded_fraction) most = &link;
  }
  return most ? robot_->model().links()[most->link] : std::string();
}

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
