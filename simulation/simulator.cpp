#include "simulation/simulator.h"

#include <algorithm>
#include <cmath>

#include "robot/link_use.h"
#include "simulation/robot/dual_arm.h"
#include "simulation/wander.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

constexpr Duration kStep = std::chrono::milliseconds(1);
constexpr Duration kRobotPeriod = std::chrono::milliseconds(10);
constexpr double kSpacing = 0.01;    // [m] between the points that clearances are measured from
constexpr double kBringWay = 0.4;    // [m] that an obstacle is brought in from aside
constexpr double kRoomToHit = 0.04;  // [m] of path that must be left beyond the gap
constexpr double kLastRoom = 0.002;  // [m] of path on which an obstacle that is late may appear
constexpr double kOnItsWay = 0.05;   // [m/s] ahead, of a commanded hand

const std::vector<std::string> kHandLinks = {"right_wrist_roll_link", "right_palm_link",
                                             "right_*_finger_link"};

ArmPath pathOf(const Simulator::Config& config, const std::shared_ptr<const RobotModel>& model,
               const World& world) {
  if (config.path) return *config.path;
  if (config.motion == kCommanded) return armPath(model, "reach");
  if (config.motion != kWander) return armPath(model, config.motion);
  return wanderPath(model, world,
                    {config.seed, config.wander_length_m, config.controller.speed_mps,
                     config.wander_clearance_m});
}

World worldOf(const Simulator::Config& config) {
  World world = scene(config.scene);
  world.insert(world.end(), config.objects.begin(), config.objects.end());
  return world;
}

std::vector<std::size_t> handShapes(const RobotModel& model) {
  LinkUse hand;
  hand.links = kHandLinks;
  return model.shapesFor(hand, kCollisionKeys).shapes;
}

}  // namespace

std::vector<std::string> simulatedMotions() {
  std::vector<std::string> names = motionNames();
  names.emplace_back(kWander);
  return names;
}

void Simulator::Config::validate() const {
  controller.validate();
  commanded.validate();
  head.validate();
  scanner.validate();
  clouds.validate();
  if (sensors.empty()) throw ConfigError("sensors: name one at least");
  requireInRange("appear_s", appear_s, 0.0, 1e6);
  requireInRange("appear_from_m", appear_from_m, 0.0, 1e3);
  requireInRange("appear_speed_share", appear_speed_share, 0.001, 0.99);
  stance.validate();
  requireInRange("gap_m", gap_m, 0.01, 0.25);
  requireInRange("obstacle_speed_mps", obstacle_speed_mps, 0.0, 10.0);
  body_error.validate();
  requireInRange("wander_length_m", wander_length_m, 1.0, 1000.0);
  requireInRange("wander_clearance_m", wander_clearance_m, 0.0, 0.2);
  if (reaches_from_rad && !(obstacle_speed_mps > 0.0)) {
    throw ConfigError(
        "obstacle_speed_mps: must be above 0 where the obstacle reaches for the hand");
  }
  if (motion == kCommanded && obstacle != ObstacleKind::kNone && obstacle_speed_mps > 0.0) {
    throw ConfigError("obstacle_speed_mps: must be 0 where the arms are commanded");
  }
  if (scanner.scanDuration() >= fromSeconds(scanner.period_s)) {
    throw ConfigError("period_s: a turn must last longer than its beams");
  }
}

bool Simulator::Config::has(SensorKind kind) const {
  return std::find(sensors.begin(), sensors.end(), kind) != sensors.end();
}

Simulator::Simulator(const Config& config)
    : config_((config.validate(), config)),
      model_(dualArm()),
      true_shapes_(trueShapes(model_->shapes(), config.body_error, config.seed)),
      kinematics_(model_),
      world_(worldOf(config)),
      path_(pathOf(config, model_, world_)),
      controller_(config.controller, path_.length()),
      head_(config.head, config.start),
      scanner_(config.scanner, config.seed),
      clouds_(config.clouds, config.sensors, *model_, config.start, config.seed),
      now_(config.start),
      scan_start_(config.start),
      hand_shapes_(handShapes(*model_)),
      tilt_(variableIndex(*model_, "laser_tilt_joint")),
      head_yaw_(variableIndex(*model_, "head_yaw_joint")),
      sensor_(linkIndex(*model_, "laser_link")),
      palm_(linkIndex(*model_, "right_palm_link")) {
  if (config.motion == kCommanded) {
    commanded_.emplace(config.commanded, model_, path_.positions(0.0), now_);
  } else {
    requireRoomForObstacle();
    controller_.step(now_, stop_);
  }
  kinematics_.update(joints(), {Pose::Identity()});
  sampled_hand_ = handAfter(0.0).shapes;
  snapshots_.push_back(snapshot());
}

void Simulator::setStop(bool stop) {
  if (stop && !stop_) truth_.stop_asserted = now_;
  stop_ = stop;
}

std::string Simulator::command(const ArmCommand& command) {
  std::string defect = commanded_->command(command);
  if (defect.empty() && command.points.empty()) truth_.stop_asserted = now_;
  return defect;
}

StepOutput Simulator::step() {
  now_ += kStep;
  head_.step(now_);
  moveArms();
  maybeAddObstacle();
  const std::vector<double> positions = joints();
  kinematics_.update(positions, {Pose::Identity()});

  StepOutput output;
  if (config_.has(SensorKind::kLaser)) {
    if (now_ + kStep > scan_start_) snapshots_.push_back(snapshot());
    output.scan = maybeFinishScan();
  }
  if (clouds_.isDue(now_)) {
    output.clouds = clouds_.step(snapshot(), kinematics_.linkPoses());
    for (const auto* cloud : {&output.clouds.camera, &output.clouds.lidar}) {
      if (*cloud) noteFirstBeam(**cloud);
    }
  }
  if ((now_ - config_.start) % kRobotPeriod == Duration::zero()) {
    output.robot = RobotSample{now_, positions, jointVelocities(), kinematics_.linkPoses()};
    recordTruth();
  }
  return output;
}

void Simulator::moveArms() {
  const bool moved = armsMove();
  if (commanded_) {
    commanded_->step(now_);
    noteStops();
  } else {
    controller_.step(now_, stop_);
  }
  if (armsBrake() && moved && !armsMove()) truth_.halted = now_;
}

/// Of arms that have controllers.
void Simulator::noteStops() {
  for (const ControlledArm& arm : commanded_->controlled()) {
    const std::optional<Time> since = arm.controller().stoppingSince();
    if (since && (!truth_.stop_asserted || *truth_.stop_asserted < *since)) {
      truth_.stop_asserted = since;
    }
  }
}

bool Simulator::armsMove() const {
  return commanded_ ? commanded_->moves() : controller_.speed() != 0.0;
}

bool Simulator::armsBrake() const {
  return commanded_ ? commanded_->holds() : controller_.braking();
}

std::vector<double> Simulator::joints() const {
  std::vector<double> joints =
      commanded_ ? commanded_->positions() : path_.positions(controller_.distance());
  joints[tilt_] = head_.tilt();
  joints[head_yaw_] = head_.yaw();
  return joints;
}

std::vector<double> Simulator::jointVelocities() const {
  std::vector<double> velocities;
  if (commanded_) {
    velocities = commanded_->velocities();
  } else {
    velocities = path_.slopes(controller_.distance());
    for (double& velocity : velocities) velocity *= controller_.speed();
  }
  velocities[tilt_] = head_.tiltVelocity();
  velocities[head_yaw_] = head_.yawVelocity();
  return velocities;
}

Vector3 Simulator::palmAt(const std::vector<double>& joints) const {
  Kinematics kinematics(model_);
  kinematics.update(joints, {Pose::Identity()});
  return kinematics.linkPoses()[palm_].translation();
}

/// [m/s]
Vector3 Simulator::commandedPalmVelocity() const {
  if (!commanded_->moves()) return Vector3::Zero();
  constexpr double kAhead = 1e-3;  // [s]
  std::vector<double> later = commanded_->positions();
  for (std::size_t i = 0; i < later.size(); ++i) later[i] += kAhead * commanded_->velocities()[i];
  return (palmAt(later) - palmAt(commanded_->positions())) / kAhead;
}

double Simulator::handSpeed() const {
  return commanded_ ? commandedPalmVelocity().norm() : controller_.speed();
}

/// Where the hand is once it has gone on by `way` [m]; a commanded one goes nobody knows where.
HandState Simulator::handAfter(double way) const {
  if (commanded_) return handAt(commanded_->positions(), commandedPalmVelocity().normalized());
  constexpr double kAhead = 1e-3;  // [m] over which the heading is taken
  const double distance = controller_.distance() + way;
  const double from = std::min(distance, path_.length() - kAhead);
  const Vector3 heading =
      (palmAt(path_.positions(from + kAhead)) - palmAt(path_.positions(from))).normalized();
  return handAt(path_.positions(distance), heading);
}

HandState Simulator::handAt(const std::vector<double>& joints, const Vector3& heading) const {
  Kinematics kinematics(model_);
  kinematics.update(joints, {Pose::Identity()});
  Body body;
  for (const std::size_t shape : hand_shapes_) {
    body.shapes.push_back(model_->shapes()[shape].shape);
    body.poses.push_back(kinematics.shapePoses()[shape]);
  }
  return {SampledBody(body, kSpacing), kinematics.linkPoses()[palm_].translation(), heading};
}

Snapshot Simulator::snapshot() const {
  Snapshot result;
  result.stamp = now_;
  result.T_fixed_sensor = kinematics_.linkPoses()[sensor_];
  for (std::size_t i = 0; i < model_->shapes().size(); ++i) {
    result.targets.shapes.push_back(true_shapes_[i].shape);
    result.targets.poses.push_back(kinematics_.shapePoses()[i] * true_shapes_[i].pose);
    result.labels.push_back(i);
  }
  for (std::size_t i = 0; i < world_.size(); ++i) {
    const std::optional<Pose> pose = world_[i].poseAt(now_);
    if (!pose) continue;
    result.targets.shapes.push_back(world_[i].shape);
    result.targets.poses.push_back(*pose);
    result.labels.push_back(kFirstObject + i);
  }
  return result;
}

/// How far the hand goes on while the obstacle is brought in [m].
double Simulator::handTravel() const {
  const double speed = config_.obstacle_speed_mps;
  return speed > 0.0 ? config_.controller.speed_mps * kBringWay / speed : 0.0;
}

/// Path that must be left when the obstacle appears [m].
double Simulator::roomForObstacle() const {
  const bool collides = config_.purpose == ObstaclePurpose::kCollision;
  if (config_.reaches_from_rad) return handTravel();
  return handTravel() + (collides ? config_.gap_m + kRoomToHit : 0.0);
}

void Simulator::requireRoomForObstacle() const {
  if (config_.obstacle == ObstacleKind::kNone) return;
  const double speed = config_.controller.speed_mps;
  const double until_full_speed = speed * speed / (2.0 * config_.controller.acceleration_mps2);
  if (until_full_speed + roomForObstacle() < path_.length()) return;
  throw ConfigError("speed_mps, gap_m, obstacle_speed_mps: a hand at " + std::to_string(speed) +
                    " m/s has no room for the obstacle on its path of " +
                    std::to_string(path_.length()) + " m");
}

void Simulator::maybeAddObstacle() {
  if (config_.obstacle == ObstacleKind::kNone || first_obstacle_) return;
  if (now_ < config_.start + fromSeconds(config_.appear_s)) return;
  if (handIsOnItsWay()) addObstacle(handTravel());
}

bool Simulator::handIsOnItsWay() const {
  if (commanded_) return !commanded_->holds() && commandedPalmVelocity().x() > kOnItsWay;
  const double full_speed = config_.appear_speed_share * config_.controller.speed_mps;
  const double last_m = path_.length() - roomForObstacle();
  const double place_m = controller_.distance();
  return controller_.outbound() && !controller_.braking() && controller_.speed() >= full_speed &&
         place_m >= std::min(config_.appear_from_m, last_m - kLastRoom) && place_m <= last_m;
}

/// In the place that it comes to.
World Simulator::obstacleBefore(const HandState& hand) const {
  if (config_.reaches_from_rad) {
    Pose T_fixed_obstacle(Eigen::Translation3d(hand.centre));
    T_fixed_obstacle.rotate(Eigen::AngleAxisd(
        std::atan2(hand.heading.y(), hand.heading.x()) + *config_.reaches_from_rad,
        Vector3::UnitZ()));
    return obstacleAt(config_.obstacle, T_fixed_obstacle);
  }
  if (config_.purpose == ObstaclePurpose::kCollision) {
    return obstacleAhead(config_.obstacle, hand, config_.gap_m, config_.stance);
  }
  const Vector3 sensor = kinematics_.linkPoses()[sensor_].translation();
  return obstacleBetween(config_.obstacle, sensor, hand.centre, config_.stance);
}

/// From the right, unless it reaches for the palm.
Vector3 Simulator::comesFrom(const HandState& hand) const {
  const Vector3 level(hand.heading.x(), hand.heading.y(), 0.0);
  if (!config_.reaches_from_rad) return hand.heading.cross(Vector3::UnitZ()).normalized();
  return Eigen::AngleAxisd(*config_.reaches_from_rad, Vector3::UnitZ()) * level.normalized();
}

void Simulator::addObstacle(double hand_travel_m) {
  const HandState hand = handAfter(hand_travel_m);
  World obstacle = obstacleBefore(hand);
  Entrance entrance{now_};
  if (config_.obstacle_speed_mps > 0.0) {
    entrance.offset = kBringWay * comesFrom(hand);
    entrance.speed_mps = config_.obstacle_speed_mps;
  }
  for (SceneObject& part : obstacle) part.entrance = entrance;
  addObstacle(obstacle);
  truth_.in_place = entrance.arrives();
}

void Simulator::addObstacle(const World& obstacle) {
  first_obstacle_ = world_.size();
  world_.insert(world_.end(), obstacle.begin(), obstacle.end());
  sampled_obstacle_ = SampledBody(bodyOf(obstacle), kSpacing);
  truth_.appeared = truth_.in_place = now_;
}

void Simulator::put(const World& objects) {
  if (first_obstacle_) {
    world_.erase(world_.begin() + static_cast<std::ptrdiff_t>(*first_obstacle_), world_.end());
    first_obstacle_.reset();
  }
  if (!objects.empty()) addObstacle(objects);
}

std::optional<SimulatedScan> Simulator::maybeFinishScan() {
  if (now_ < scan_start_ + config_.scanner.scanDuration()) return std::nullopt;
  SimulatedScan scan = scanner_.measure(scan_start_, snapshots_);
  noteFirstBeam(scan);
  scan_start_ += fromSeconds(config_.scanner.period_s);
  const auto needed = std::find_if(snapshots_.begin(), snapshots_.end(), [this](const Snapshot& s) {
    return s.stamp + kStep > scan_start_;
  });
  snapshots_.erase(snapshots_.begin(), needed);
  return scan;
}

void Simulator::noteFirstBeam(const SimulatedScan& scan) {
  if (!wantsFirstBeam()) return;
  for (std::size_t i = 0; i < scan.truth.size(); ++i) {
    const BeamTruth& beam = scan.truth[i];
    if (!beam.label || *beam.label < kFirstObject + *first_obstacle_ || beam.mixed) continue;
    if (!std::isfinite(scan.scan.ranges[i])) continue;
    truth_.first_beam = scan.scan.beamTime(i);
    return;
  }
}

void Simulator::noteFirstBeam(const SimulatedCloud& cloud) {
  if (!wantsFirstBeam()) return;
  const Cloud& measured = cloud.cloud;
  for (std::size_t i = 0; i < cloud.truth.size(); ++i) {
    const PointTruth& truth = cloud.truth[i];
    if (!truth.found() || truth.label < kFirstObject + *first_obstacle_ || truth.mixed()) continue;
    if (!isMeasured(measured.points[i])) continue;
    const double offset_s =
        measured.offsets_s.empty() ? 0.0 : static_cast<double>(measured.offsets_s[i]);
    const Time stamp = measured.stamp + fromSeconds(offset_s);
    if (!truth_.first_beam || stamp < *truth_.first_beam) truth_.first_beam = stamp;
  }
}

void Simulator::recordTruth() {
  const auto& poses = kinematics_.shapePoses();
  std::vector<Pose> hand_poses;
  for (const std::size_t shape : hand_shapes_) hand_poses.push_back(poses[shape]);
  sampled_hand_->moveTo(hand_poses);
  HandSample sample{now_, kinematics_.linkPoses()[palm_].translation(), handSpeed(), std::nullopt,
                    armsBrake()};
  if (first_obstacle_) {
    std::vector<Pose> obstacle_poses;
    for (std::size_t i = *first_obstacle_; i < world_.size(); ++i) {
      obstacle_poses.push_back(*world_[i].poseAt(now_));
    }
    sampled_obstacle_->moveTo(obstacle_poses);
    sample.obstacle_m = clearance(*sampled_hand_, *sampled_obstacle_);
    truth_.obstacle_min_m = std::min(truth_.obstacle_min_m.value_or(1e9), *sample.obstacle_m);
  }
  if (!config_.keeps_hand_samples) truth_.hand.clear();
  truth_.hand.push_back(sample);
}

}  // namespace tccm::simulation
