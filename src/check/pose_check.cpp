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

void forgetOcclusion(PoseFindings& findings) {
  findings.links.clear();
  findings.occluding_cuboids.clear();
  findings.occlusion = false;
}

}  // namespace

UsedBody::UsedBody(const RobotModel& model, const LinkUse& use, const LinkUse::Keys& keys) {
  const UsedShapes used = model.shapesFor(use, keys);
  shapes = used.shapes;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const LinkShape& bare = model.shapes()[shapes[i]];
    links.push_back(static_cast<std::uint32_t>(bare.link));
    body.shapes.push_back(expanded(bare.shape, used.expansions[i]));
  }
  body.poses.resize(shapes.size(), Pose::Identity());
}

std::vector<double> UsedBody::radii(double growth_m) const {
  std::vector<double> radii;
  for (const Shape& shape : body.shapes) {
    radii.push_back(boundingRadius(expanded(shape, {1.0, growth_m})));
  }
  return radii;
}

void CheckedRobot::Config::describe(ParameterTable& table) {
  collision_use.describe(table, kCollisionKeys, Tunable::kYes);
  collision.describe(table);
  table.add("check_occlusion", &check_occlusion,
            "whether hidden links stop the robot; not switched off while it moves", Tunable::kYes);
  occlusion_use.describe(table, kOcclusionKeys);
  occlusion.describe(table);
}

void CheckedRobot::Config::validate() const {
  collision_use.validate(kCollisionKeys);
  occlusion_use.validate(kOcclusionKeys);
}

CheckedRobot::CheckedRobot(std::shared_ptr<const RobotModel> of_model, const Config& new_config)
    : model(std::move(of_model)),
      config(validated(new_config)),
      collision_body(*model, config.collision_use, kCollisionKeys),
      occlusion_body(*model, config.occlusion_use, kOcclusionKeys),
      collision(config.collision) {}

PoseCheck::PoseCheck(std::shared_ptr<const CheckedRobot> robot, double old_periods)
    : robot_(std::move(robot)),
      kinematics_(robot_->model),
      collision_body_(robot_->collision_body),
      occlusion_body_(robot_->occlusion_body),
      occlusion_(robot_->config.occlusion, occlusion_body_.links, old_periods) {
  for (const std::uint32_t link : collision_body_.links) {
    clearance_of_shape_.push_back(entryOf(link, clearances_));
  }
}

const Posture& PoseCheck::place(const std::vector<double>& positions,
                                const std::vector<Pose>& T_fixed_roots) {
  const Posture& posture = kinematics_.update(positions, T_fixed_roots);
  collision_body_.place(posture);
  occlusion_body_.place(posture);
  return posture;
}

void PoseCheck::check(const Surroundings& around, PoseFindings& findings) {
  findContacts(around, findings);
  findOcclusion(around, findings);
}

void PoseCheck::nameShapes(std::vector<Contact>& contacts) const {
  for (Contact& contact : contacts) {
    contact.shape = static_cast<std::uint32_t>(collision_body_.shapes[contact.shape]);
  }
}

void PoseCheck::findContacts(const Surroundings& around, PoseFindings& findings) const {
  robot_->collision.find(around.map, collision_body_.body, findings.contacts,
                         &kinematics_.linkPoses());
  nameShapes(findings.contacts);
  findings.collision = !findings.contacts.empty();
  findings.keep_out.clear();
  if (!around.keep_out) return;
  robot_->collision.find(*around.keep_out, collision_body_.body, findings.keep_out);
  nameShapes(findings.keep_out);
}

void PoseCheck::findOcclusion(const Surroundings& around, PoseFindings& findings) {
  if (robot_->config.check_occlusion) {
    occlusion_.find(around, occlusion_body_.body, findings);
  } else {
    forgetOcclusion(findings);
  }
}

void PoseCheck::findOcclusion(const Surroundings& around, PoseFindings& findings,
                              const PoseCheck& ahead, PoseFindings& ahead_findings) {
  if (robot_->config.check_occlusion) {
    occlusion_.find(around, occlusion_body_.body, findings, &ahead.occlusion_body_.body,
                    &ahead_findings);
  } else {
    for (PoseFindings* each : {&findings, &ahead_findings}) forgetOcclusion(*each);
  }
}

LinkClearance PoseCheck::nearest(const Surroundings& around, std::size_t i,
                                 double nearer_than_m) const {
  const Shape& bare = robot_->model->shapes()[collision_body_.shapes[i]].shape;
  const Pose& pose = collision_body_.body.poses[i];
  const auto index = static_cast<std::uint32_t>(i);
  LinkClearance nearest{collision_body_.links[i]};
  const auto look = [&](const Obstacles& obstacles) {
    const auto found = robot_->collision.nearest(obstacles, bare, pose, index,
                                                 std::min(nearer_than_m, nearest.distance_m));
    if (!found) return;
    nearest.distance_m = found->distance_m;
    nearest.cuboid = found->obstacle;
    nearest.is_region = obstacles.keepOut() != nullptr;
  };
  look(around.map);
  if (around.keep_out) look(*around.keep_out);
  return nearest;
}

const std::vector<LinkClearance>& PoseCheck::findClearances(const Surroundings& around,
                                                            double radius_m) {
  for (LinkClearance& entry : clearances_) entry = {entry.link};
  for (std::size_t i = 0; i < clearance_of_shape_.size(); ++i) {
    LinkClearance& entry = clearances_[clearance_of_shape_[i]];
    const LinkClearance found = nearest(around, i, std::min(radius_m, entry.distance_m));
    if (found.distance_m < entry.distance_m) entry = found;
  }
  return clearances_;
}

double PoseCheck::leastClearance(const Surroundings& around, double radius_m) const {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < collision_body_.shapes.size() && least > 0.0; ++i) {
    least = std::min(least, nearest(around, i, std::min(radius_m, least)).distance_m);
  }
  return least;
}

std::string PoseCheck::mostHiddenLink(const PoseFindings& findings) const {
  const LinkVisibility* most = nullptr;
  for (const LinkVisibility& link : findings.links) {
    if (!occlusion_.isOccluded(link)) continue;
    if (!most || link.occluded_fraction > most->occluded_fraction) most = &link;
  }
  return most ? robot_->model->links()[most->link] : std::string();
}

std::vector<std::string> selfTest(const CheckedRobot& robot, PoseCheck& check) {
  const RobotModel& model = *robot.model;
  // Some pose within the limits; the middles of the primitives are known at any.
  std::vector<double> positions;
  for (const JointVariable& variable : model.variables()) {
    const bool limited = variable.lower && variable.upper;
    positions.push_back(limited ? 0.5 * (*variable.lower + *variable.upper) : 0.0);
  }
  const std::vector<Pose> T_fixed_roots(model.roots().size(), Pose::Identity());
  const std::vector<Pose> at_rest = check.place(positions, T_fixed_roots).T_fixed_shapes;
  const CollisionCheck::Config& rule = robot.config.collision;
  const CuboidMap map = mapOfOneCuboid(rule.support_points);
  const auto most = static_cast<std::size_t>(rule.contacts_max);
  std::vector<std::string> missed;
  PoseFindings findings;
  for (const std::size_t shape : robot.collision_body.shapes) {
    // The robot is moved to the cuboid.
    std::vector<Pose> roots = T_fixed_roots;
    for (Pose& pose : roots) pose.pretranslate(-at_rest[shape].translation());
    check.place(positions, roots);
    check.findContacts(map, findings);
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
