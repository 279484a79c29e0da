#include "experiments/stopping_trial.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "experiments/draw.h"
#include "experiments/exact_clearance.h"
#include "geometry/overlap.h"
#include "simulation/robot/dual_arm.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

constexpr double kSpacing = 0.01;    // [m] between the points that clearances are measured from
constexpr double kAlong = 0.01;      // [m] of the path between the places that the arm comes to
constexpr double kGrazing = 0.001;   // [m] of it: a contact at the arm's side may be as short
constexpr double kExactly = 0.0001;  // [m] to which the place of the contact is found
constexpr double kStep_s = 0.001;    // of the simulator, which brakes from step to step
constexpr double kSupport = 0.03;    // [m] of height within which returns support each other
constexpr std::size_t kSupporting = 3;
constexpr double kSettled = 5.0;      // [s] until the map is whole
constexpr double kLongest = 60.0;     // [s] of a trial
constexpr double kAfterwards = 10.0;  // [s] from the obstacle on
constexpr int kRest = 30;             // robot samples
constexpr double kCrawls = 0.002;     // [m/s]

/// Straight ahead; slantwise, with room for an obstacle to be brought in meanwhile; and where the
/// laser looks at the whole hand, for one whose speed follows from its looks.
ArmPath pathOf(const StoppingTrial::Config& config,
               const std::shared_ptr<const RobotModel>& model) {
  if (config.obeys_scale) {
    return reachVia(model, {Vector3(0.46, -0.5, 0.95), Vector3(0.66, 0.0, 0.92)});
  }
  if (config.obstacle_speed_mps == 0.0) return armPath(model, "reach");
  return reachVia(model, {Vector3(0.28, -0.61, 0.95), Vector3(0.6, 0.1, 0.92)});
}

/// Of a hand that reaches, what may come near to something ahead.
std::vector<std::string> reachingLinks() {
  return {"right_elbow_link", "right_wrist_*_link", "right_palm_link", "right_*_finger_link"};
}

}  // namespace

const char* name(StoppingTrial::Cause cause) {
  constexpr std::array kNames = {"not_looked_at", "looked_at_too_late", "supported_too_late",
                                 "avoidable"};
  return kNames[static_cast<std::size_t>(cause)];
}

void StoppingTrial::Config::validate() const {
  controller.validate();
  scanner.validate();
  requireInRange("tilt_period_s", tilt_period_s, 0.1, 60.0);
  requireInRange("obstacle_speed_mps", obstacle_speed_mps, 0.0, 10.0);
  if (reaches_from_rad) {
    const auto& [from, to] = *reaches_from_rad;
    requireInRange("reaches_from_rad", from, -M_PI, M_PI);
    requireInRange("reaches_from_rad", to, from, M_PI);
  }
  requireInRange("gap_min_m", gap_min_m, 0.01, 0.25);
  requireInRange("gap_max_m", gap_max_m, gap_min_m, 0.25);
  requireInRange("aside_max_m", aside_max_m, 0.0, 0.1);
  requireInRange("turn_max_rad", turn_max_rad, 0.0, M_PI);
  requireInRange("body_error_m", body_error_m, 0.0, 0.05);
  if (obstacle == ObstacleKind::kNone) throw ConfigError("obstacle: none stops nobody");
}

StoppingTrial::StoppingTrial(const Config& config, std::shared_ptr<const RobotModel> model,
                             std::uint64_t seed)
    : config_((config.validate(), config)),
      model_(model),
      path_(pathOf(config_, model)),
      kinematics_(model),
      grid_(config.monitor.sensors.front().mapper.map.grid),
      simulation_(simulatorConfig(seed), config_.monitor, model),
      arm_(std::move(model), reachingLinks(), kSpacing),
      start_(simulation_.simulator().now()) {
  const auto obedience = config_.obeys_scale ? MonitoredSimulation::Obedience::kStopAndScale
                                             : MonitoredSimulation::Obedience::kStopAlone;
  if (config_.guardian != nullptr) {
    simulation_.obey(*config_.guardian, obedience);
  } else {
    simulation_.obey(obedience);
  }
  simulation_.onScan([this](const SimulatedScan& scan) { noteScan(scan); });
  simulation_.onCloud([this](const MappedCloud& cloud) { noteCloud(cloud); });
  simulation_.onPermission(
      [this](bool permitted, const std::string& reason) { notePermission(permitted, reason); });
}

Simulator::Config StoppingTrial::simulatorConfig(std::uint64_t seed) {
  Draw draw(seed);
  Simulator::Config config;
  config.start = config_.start;
  config.scene = "empty";
  config.objects = bareTable();
  config.path = path_;
  config.controller = config_.controller;
  config_.sensors.applyTo(config);
  config.scanner = config_.scanner;
  config.head.tilt.period_s = config_.tilt_period_s;
  config.head.tilt.phase_rad = draw.between(0.0, 2.0 * M_PI);
  config.seed = seed;
  config.obstacle = config_.obstacle;
  config.obstacle_speed_mps = config_.obstacle_speed_mps;
  // The arm may move from the same phase of the tilt on each time; it pauses before it comes again.
  config.appear_s = kSettled;
  config.controller.dwell_s = draw.between(0.0, config_.tilt_period_s);
  config.appear_from_m = draw.between(0.0, path_.length());
  config.appear_speed_share = config_.appear_speed_share;
  config.gap_m = draw.between(config_.gap_min_m, config_.gap_max_m);
  config.stance.aside_m = draw.between(-config_.aside_max_m, config_.aside_max_m);
  config.stance.turn_rad = draw.between(-config_.turn_max_rad, config_.turn_max_rad);
  config.body_error.size_m = config_.body_error_m;
  if (config_.reaches_from_rad) {
    const auto& [from, to] = *config_.reaches_from_rad;
    config.reaches_from_rad = draw.between(from, to);
    result_.reaches_from_rad = config.reaches_from_rad;
  }
  result_.seed = seed;
  result_.tilt_phase = config.head.tilt.phase_rad / (2.0 * M_PI);  // at the start, as yet
  result_.gap_m = config.gap_m;
  result_.aside_m = config.stance.aside_m;
  result_.turn_rad = config.stance.turn_rad;
  return config;
}

StoppingTrial::Result StoppingTrial::run() {
  std::optional<Outcome> outcome;
  while (!outcome) {
    const bool is_sample = simulation_.step();
    if (!appeared_ && simulation_.simulator().truth().appeared) noteObstacle();
    if (appeared_ && is_sample) noteProcessing();
    if (is_sample) outcome = outcomeSoFar();
  }
  result_.outcome = *outcome;
  if (appeared_) result_.left_m = exactClearance(armNow(), obstacleNow());
  if (*outcome == Outcome::kTouched) {
    result_.avoidable_from_beam = brakesInTime(way_beam_);
    result_.avoidable_from_support = brakesInTime(support_);
    result_.cause = causeOfContact();
  }
  result_.simulated_s = toSeconds(simulation_.simulator().now() - start_);
  return result_;
}

void StoppingTrial::noteObstacle() {
  const Simulator& simulator = simulation_.simulator();
  appeared_ = simulator.truth().appeared;
  const World& world = simulator.world();
  first_obstacle_ = static_cast<std::size_t>(
      std::find_if(world.begin(), world.end(),
                   [](const SceneObject& object) { return object.name == kObstacleName; }) -
      world.begin());
  obstacle_ = bodyOf({world.begin() + static_cast<std::ptrdiff_t>(first_obstacle_), world.end()});
  const double turns = toSeconds(*appeared_ - start_) / config_.tilt_period_s + result_.tilt_phase;
  result_.tilt_phase = turns - std::floor(turns);
  const double from_m = simulator.controller().distance();
  findContact(from_m);
  const Expansion padding = config_.monitor.checker.pose.collision_use.expansion;
  const double last_m = std::min(contact_m_, path_.length());
  for (double way = from_m; way < last_m + kAlong; way += kAlong) {
    ahead_.push_back(armAt(std::min(way, last_m)));
    for (Shape& shape : ahead_.back().shapes) shape = expanded(shape, padding);
  }
}

/// Where the arm would first touch the obstacle in its place, did it not stop.
void StoppingTrial::findContact(double from_m) {
  contact_m_ = std::numeric_limits<double>::infinity();
  const auto touches = [this](double way) { return exactlyTouch(armAt(way), obstacle_); };
  double far = from_m;
  while (far < path_.length() && !touches(far)) far += kGrazing;
  if (far >= path_.length()) return;
  double near = std::max(from_m, far - kGrazing);
  while (far - near > kExactly) {
    const double middle = 0.5 * (near + far);
    (touches(middle) ? far : near) = middle;
  }
  contact_m_ = near;
}

Body StoppingTrial::armAt(double way_m) {
  kinematics_.update(path_.positions(way_m), {Pose::Identity()});
  arm_.moveTo(kinematics_.linkPoses());
  return arm_.body().body();
}

/// Whether the arm, padded, comes to touch the cuboid that a return makes.
bool StoppingTrial::isInTheWay(const Grid::Place& place) const {
  const Height thickness = grid_.heightOf(config_.monitor.sensors.front().mapper.map.thickness_m);
  const UprightBox cuboid = grid_.box(place.cell, place.height - thickness, place.height);
  return std::any_of(ahead_.begin(), ahead_.end(), [&](const Body& arm) {
    for (std::size_t i = 0; i < arm.shapes.size(); ++i) {
      if (overlaps(arm.shapes[i], arm.poses[i], cuboid)) return true;
    }
    return false;
  });
}

bool StoppingTrial::hasSupport(const Evidence& evidence) const {
  const auto columns = static_cast<int>(grid_.cellsX());
  const auto at = [columns](CellIndex cell) {
    return std::pair(static_cast<int>(cell) % columns, static_cast<int>(cell) / columns);
  };
  const auto place = at(evidence.place.cell);
  const auto supporting = std::count_if(evidence_.begin(), evidence_.end(), [&](const auto& other) {
    const auto [other_x, other_y] = at(other.place.cell);
    return std::abs(other_x - place.first) <= 1 && std::abs(other_y - place.second) <= 1 &&
           std::abs(other.place.height - evidence.place.height) <= grid_.heightOf(kSupport);
  });
  return static_cast<std::size_t>(supporting) >= kSupporting;
}

/// Of each scan once.
void StoppingTrial::noteProcessing() {
  if (timed_scans_ == scans_) return;
  timed_scans_ = scans_;
  result_.processing_us.push_back(simulation_.processingMicroseconds());
}

void StoppingTrial::noteScan(const SimulatedScan& scan) {
  ++scans_;
  if (!appeared_) return;
  noteFirstBeam();
  if (!support_) noteEvidence(scan);
}

void StoppingTrial::noteCloud(const MappedCloud& cloud) {
  ++scans_;
  if (!appeared_) return;
  noteFirstBeam();
  if (!support_) noteEvidence(cloud);
}

void StoppingTrial::noteFirstBeam() {
  const auto& beam = simulation_.simulator().truth().first_beam;
  if (beam) result_.beam_s = sinceAppeared(*beam);
}

bool StoppingTrial::showsObstacle(const BeamTruth& beam) const {
  return beam.label && *beam.label >= Simulator::kFirstObject + first_obstacle_ && !beam.mixed;
}

void StoppingTrial::noteEvidence(const SimulatedScan& scan) {
  const AssembledScan& assembled =
      simulation_.monitor().assembled(*config_.sensors.indexOf(SensorKind::kLaser));
  for (std::size_t i = 0; i < assembled.beams.size(); ++i) {
    const Beam& beam = assembled.beams[i];
    if (!showsObstacle(scan.truth[i]) || !beam.measured()) continue;
    const auto place = grid_.place(beam.p_fixed);
    if (!place || !isInTheWay(*place)) continue;
    if (!way_beam_) {
      way_beam_ = judgedNow();
      result_.way_beam_s = sinceAppeared(beam.stamp);
    }
    if (beam.kind == BeamKind::kReturn) evidence_.push_back({*place, scans_});
  }
  const bool supported = std::any_of(evidence_.begin(), evidence_.end(),
                                     [this](const Evidence& e) { return hasSupport(e); });
  if (supported) noteSupport();
}

/// A camera gives thousands of points on a place: the first that is supported is enough.
void StoppingTrial::noteEvidence(const MappedCloud& mapped) {
  const Cloud& cloud = mapped.cloud.cloud;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const PointTruth& truth = mapped.cloud.truth[i];
    if (!truth.found() || truth.label < Simulator::kFirstObject) continue;
    if (!showsObstacle(truth.beam()) || !isMeasured(cloud.points[i])) continue;
    const auto place = grid_.place(mapped.p_fixed[i]);
    if (!place || !isInTheWayAsBefore(*place)) continue;
    if (!way_beam_) {
      way_beam_ = judgedNow();
      const double offset_s =
          cloud.offsets_s.empty() ? 0.0 : static_cast<double>(cloud.offsets_s[i]);
      result_.way_beam_s = sinceAppeared(cloud.stamp + fromSeconds(offset_s));
    }
    if (mapped.kinds[i] != BeamKind::kReturn) continue;
    evidence_.push_back({*place, scans_});
    if (hasSupport(evidence_.back())) return noteSupport();
  }
}

void StoppingTrial::noteSupport() {
  support_ = judgedNow();
  result_.support_s = sinceAppeared(support_->stamp);
}

/// Neighbouring points share a place.
bool StoppingTrial::isInTheWayAsBefore(const Grid::Place& place) {
  const auto [found, is_new] = in_the_way_.try_emplace({place.cell, place.height}, false);
  if (is_new) found->second = isInTheWay(place);
  return found->second;
}

void StoppingTrial::notePermission(bool permitted, const std::string& reason) {
  const bool was_permitted = std::exchange(permitted_, permitted);
  if (!appeared_) return;
  const Judged now = judgedNow();
  const double left_s = (contact_m_ - now.way_m) / std::max(now.speed_mps, 1e-6);
  if (!due_ && left_s <= config_.monitor.checker.way.stop_time_s) {
    due_ = now;
    result_.due_s = sinceAppeared(now.stamp);
  }
  if (!was_permitted || permitted_ || result_.stop_s) return;
  result_.stop_s = sinceAppeared(now.stamp);
  result_.reason = reason;
  if (!support_) return;
  const int from = due_ ? std::max(support_->scan, due_->scan) : now.scan;
  result_.delay_scans = std::max(0, now.scan - from);
}

StoppingTrial::Judged StoppingTrial::judgedNow() const {
  const PathController& controller = simulation_.simulator().controller();
  return {simulation_.simulator().now(), controller.distance(), controller.speed(), scans_};
}

StoppingTrial::Cause StoppingTrial::causeOfContact() const {
  if (result_.avoidable_from_support) return Cause::kAvoidable;
  if (result_.avoidable_from_beam) return Cause::kSupportedTooLate;
  return way_beam_ ? Cause::kLookedAtTooLate : Cause::kNotLookedAt;
}

bool StoppingTrial::brakesInTime(const std::optional<Judged>& from) const {
  if (!from) return false;
  const double v = from->speed_mps;
  const double way = v * (config_.controller.latency_s + kStep_s) +
                     v * v / (2.0 * config_.controller.acceleration_mps2);
  return from->way_m + way < contact_m_;
}

const Body& StoppingTrial::armNow() {
  arm_.moveTo(simulation_.robot()->link_poses);
  return arm_.body().body();
}

Body StoppingTrial::obstacleNow() const {
  const World& world = simulation_.simulator().world();
  Body obstacle;
  for (std::size_t i = first_obstacle_; i < world.size(); ++i) {
    obstacle.shapes.push_back(world[i].shape);
    obstacle.poses.push_back(*world[i].poseAt(simulation_.simulator().now()));
  }
  return obstacle;
}

std::optional<Outcome> StoppingTrial::outcomeSoFar() {
  const Simulator& simulator = simulation_.simulator();
  if (!appeared_) {
    const bool late = simulator.now() - start_ > fromSeconds(kLongest);
    return late ? std::optional(Outcome::kNotStarted) : std::nullopt;
  }
  const auto& hand = simulator.truth().hand.back();
  if (exactlyTouch(armNow(), obstacleNow())) {  // the whole arm, not the hand alone
    result_.contact_s = sinceAppeared(simulator.now());
    result_.contact_speed_mps = std::abs(simulator.controller().speed());
    return Outcome::kTouched;
  }
  const bool arrived = simulator.truth().in_place <= simulator.now();
  // An arm that obeys the scale may come to rest with a permission of no speed to speak of.
  const bool rests = permitted_ ? config_.obeys_scale && hand.speed_mps < kCrawls
                                : simulator.controller().speed() == 0.0;
  at_rest_ = arrived && rests ? at_rest_ + 1 : 0;
  if (at_rest_ == kRest) return Outcome::kStopped;
  if (sinceAppeared(simulator.now()) > kAfterwards) return Outcome::kUndecided;
  return std::nullopt;
}

}  // namespace tccm::simulation
