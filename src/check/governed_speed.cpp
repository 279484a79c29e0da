#include "check/governed_speed.h"

#include <cmath>

#include "base/line_of.h"
#include "geometry/distance.h"

namespace tccm {
namespace {

constexpr double kSoon = 0.01;             // [s] over which points' velocities are taken
constexpr double kAtRest = 0.01;           // [m/s]
constexpr double kCommandForgotten = 0.5;  // [1/s] of an estimate, when a robot goes slower
constexpr double kJointsLate = 0.04;       // [s] that joint states tell of a brake later
constexpr double kDelayForgotten = 0.99;   // kept of the longest delay at each new map
constexpr double kNoLook = 30.0;           // [s] that what is left of the way has to last
constexpr double kLateShare = 0.15;        // of a period that a look may be overdue by
constexpr double kAheadCosine = 0.3;       // of the angle between velocity and place
constexpr double kSameWay = 0.8;           // of a point's speed, by another towards the same place
constexpr double kNearer = 0.01;           // [m] by which another part is first at a place
constexpr std::size_t kPlacesMax = 128;    // of one point

}  // namespace

void ObeyedScale::add(Time now, double scale, double braking, Duration lag) {
  const double braked = last_ ? most_ - braking * toSeconds(now - *last_) : 1.0;
  if (!last_ || now - begun_ > lag) {
    before_ = present_;
    present_ = {scale, scale};
    begun_ = now;
  }
  last_ = now;
  present_ = {std::min(present_.least, scale), std::max(present_.most, scale)};
  most_ = std::max({before_.most, present_.most, braked});
}

void GovernedSpeed::Config::describe(ParameterTable& table) {
  table.add("appear_distance_m", &appear_distance_m, "m", {0.0, 2.0},
            "whatever appears so far ahead of a link, at any moment, is seen and braked for; 0: "
            "the speed is not governed");
  table.add("appear_look_margin_m", &look_margin_m, "m", {0.0, 1.0},
            "a look that ended this much before a place saw it all the same");
  table.add("appear_place_step_m", &place_step_m, "m", {0.001, 0.1},
            "places ahead are noted so far apart");
  table.add("commanded_speed_max_mps", &speed_max_mps, "m/s", {0.01, 20.0},
            "that a link is taken to be commanded at full scale, before it has moved");
}

GovernedSpeed::GovernedSpeed(std::shared_ptr<const RobotModel> model, const Config& config,
                             const std::vector<std::size_t>& shapes)
    : model_(std::move(model)),
      config_(validated(config)),
      kinematics_soon_(model_),
      positions_soon_(model_->variables().size()) {
  if (!active()) return;
  for (const std::size_t shape : shapes) addTracks(shape);
}

/// At the ends of a primitive's axis, or in its middle.
void GovernedSpeed::addTracks(std::size_t shape) {
  const auto add = [&](double height, double radius_m) {
    tracks_.push_back({shape, {0.0, 0.0, height}, radius_m});
    tracks_.back().commanded_mps = config_.speed_max_mps;
    tracks_.back().places.reserve(kPlacesMax);
  };
  const Shape& solid = model_->shapes()[shape].shape;
  const Shape axis = core(solid);
  if (const auto* line = std::get_if<Capsule>(&axis)) {
    const double radius_m = bounds(solid, Pose::Identity()).max().x();
    add(-line->half_length, radius_m);
    add(line->half_length, radius_m);
  } else {
    add(0.0, boundingRadius(solid));
  }
}

void GovernedSpeed::startAnew() {
  last_.reset();
  obeyed_ = {};
  feeds_.clear();
  for (Track& track : tracks_) {
    track.places.clear();
    track.travelled_m = 0.0;
    track.commanded_mps = config_.speed_max_mps;
  }
}

void GovernedSpeed::takeOver(const GovernedSpeed& before) {
  if (before.config_.appear_distance_m != config_.appear_distance_m) return;
  for (Track& track : tracks_) {
    const auto same =
        std::find_if(before.tracks_.begin(), before.tracks_.end(), [&track](const Track& other) {
          return other.shape == track.shape && other.p_shape == track.p_shape;
        });
    if (same == before.tracks_.end()) continue;
    track = *same;
    track.places.reserve(kPlacesMax);
  }
  last_ = before.last_;
  feeds_ = before.feeds_;
  obeyed_ = before.obeyed_;
}

void GovernedSpeed::judge(const Situation& situation, Causes& causes) {
  limit_ = {};
  if (!active()) return;
  noteDelays(situation);
  move(situation);
  for (Track& track : tracks_) {
    forgetSeen(situation.around, track);
    limitBy(track, situation);
  }
  if (limit_.scale >= 1.0) return;
  const std::string& link = model_->links()[limit_.link];
  const std::string text = limit_.next_look_s
                               ? lineOf("%.100s: the place ahead is looked at in %.0f ms",
                                        link.c_str(), 1e3 * *limit_.next_look_s)
                               : lineOf("%.100s: no look at the place ahead is due", link.c_str());
  causes.push_back(Cause::slowing(Reason::kSpeedGoverned, limit_.scale, text, link));
}

void GovernedSpeed::noteDelays(const Situation& situation) {
  feeds_.resize(situation.around.size());
  std::size_t i = 0;
  for (const SensorView& view : situation.around) {
    const CuboidMap* map = view.map;
    Feed& feed = feeds_[i++];
    if (map->serial == feed.serial) continue;
    feed.serial = map->serial;
    feed.delay_s = std::max(kDelayForgotten * feed.delay_s, toSeconds(situation.now - map->stamp));
  }
}

void GovernedSpeed::move(const Situation& situation) {
  const Time now = situation.now;
  const JointSnapshot& joints = situation.joints;
  const double seconds = last_ ? toSeconds(now - *last_) : 0.0;
  double fastest = kAtRest;
  for (const Track& track : tracks_) fastest = std::max(fastest, track.commanded_mps);
  obeyed_.add(now, situation.applied_scale, situation.braking.way().fall(fastest),
              fromSeconds(situation.braking.reaction_time_s + kJointsLate));
  for (std::size_t i = 0; i < positions_soon_.size(); ++i) {
    positions_soon_[i] = joints.positions[i] + kSoon * joints.velocities[i];
  }
  const Posture& posture = situation.check_here.posture();
  kinematics_soon_.update(positions_soon_, posture.T_fixed_roots);
  for (Track& track : tracks_) {
    const Vector3 p_fixed = posture.T_fixed_shapes[track.shape] * track.p_shape;
    const Vector3 soon = kinematics_soon_.shapePoses()[track.shape] * track.p_shape;
    if (last_) track.travelled_m += (p_fixed - track.p_fixed).norm();
    track.p_fixed = p_fixed;
    track.velocity = (soon - p_fixed) / kSoon;
    estimateCommand(track, seconds);
  }
  last_ = now;
  for (Track& track : tracks_) notePlace(track, situation);
}

/// Within what its speed and the scale that it obeys leave room for. What a slower robot was
/// commanded is forgotten slowly: at the turns of its way it brakes by itself.
void GovernedSpeed::estimateCommand(Track& track, double seconds) const {
  const double speed = track.velocity.norm();
  if (speed < kAtRest || obeyed_.most() <= 0.0) return;
  double& commanded = track.commanded_mps;
  if (commanded * obeyed_.least() > speed) {
    commanded *= 1.0 - std::min(1.0, kCommandForgotten * seconds);
  }
  commanded = std::max(commanded, speed / obeyed_.most());
}

void GovernedSpeed::notePlace(Track& track, const Situation& situation) const {
  const double speed = track.velocity.norm();
  if (speed < kAtRest) return;
  const bool is_due = track.places.empty() ||
                      track.travelled_m - track.places.back().travelled_m >= config_.place_step_m;
  if (!is_due) return;
  const double ahead = track.radius_m + config_.appear_distance_m;
  const Vector3 p_fixed = track.p_fixed + ahead / speed * track.velocity;
  if (isBehindAnother(track, p_fixed, situation.check_here.posture())) return;
  if (track.places.size() == kPlacesMax) track.places.erase(track.places.begin());
  track.places.push_back({p_fixed, track.travelled_m, situation.now});
}

/// Where a part of the robot that goes the same way is nearer to the place: it would be there
/// first, and has places of its own. A hand goes ahead of its wrist.
bool GovernedSpeed::isBehindAnother(const Track& track, const Vector3& p_fixed,
                                    const Posture& posture) const {
  const double speed = track.velocity.norm();
  return std::any_of(tracks_.begin(), tracks_.end(), [&](const Track& other) {
    if (other.shape == track.shape) return false;
    const Vector3 way = p_fixed - other.p_fixed;
    if (way.dot(other.velocity) < kSameWay * speed * way.norm()) return false;
    const Pose& T_fixed_other = posture.T_fixed_shapes[other.shape];
    const Shape& shape = model_->shapes()[other.shape].shape;
    return distance(shape, T_fixed_other.inverse() * p_fixed) < config_.appear_distance_m - kNearer;
  });
}

/// A surface between the robot and the place is met before the place is, and is in the map: then
/// that has to be looked at, not the place behind it.
double GovernedSpeed::marginAt(const LookImage& looks, const Vector3& p_fixed) const {
  const bool is_behind =
      looks.at(p_fixed, config_.look_margin_m).kind == LookImage::Sight::Kind::kBehind;
  return is_behind ? config_.appear_distance_m : config_.look_margin_m;
}

/// Places that a scan has seen since, and those that the point has left behind.
void GovernedSpeed::forgetSeen(const Surroundings& around, Track& track) const {
  const double far = 2.0 * (track.radius_m + config_.appear_distance_m);
  const auto isOver = [&](const Place& place) {
    if ((place.p_fixed - track.p_fixed).norm() > far) return true;
    return std::any_of(around.begin(), around.end(), [&](const SensorView& view) {
      const LookImage& looks = view.map->looks;
      return looks.passedSince(place.since, place.p_fixed, marginAt(looks, place.p_fixed));
    });
  };
  auto& places = track.places;
  places.erase(std::remove_if(places.begin(), places.end(), isOver), places.end());
}

void GovernedSpeed::limitBy(const Track& track, const Situation& situation) {
  const double speed = track.velocity.norm();
  for (const Place& place : track.places) {
    const Vector3 to_place = place.p_fixed - track.p_fixed;
    // What it moves away from or past is not ahead.
    if (speed >= kAtRest && to_place.dot(track.velocity) < kAheadCosine * to_place.norm() * speed) {
      continue;
    }
    // It may have appeared just before the next place was noted.
    const double rest_m =
        config_.appear_distance_m - config_.place_step_m - (track.travelled_m - place.travelled_m);
    const NextLook next = nextLook(place, situation);
    const Braking& braking = situation.braking;
    const double allowed =
        braking.way().speedFor(rest_m, next.until_s + next.delay_s + braking.reaction_time_s);
    const double scale = allowed / std::max(track.commanded_mps, speed);
    if (scale >= limit_.scale) continue;
    limit_ = {scale, model_->shapes()[track.shape].link, allowed, std::nullopt};
    if (next.is_due) limit_.next_look_s = next.until_s;
  }
}

/// Of the sensor whose verdict on the place comes first.
GovernedSpeed::NextLook GovernedSpeed::nextLook(const Place& place,
                                                const Situation& situation) const {
  NextLook first{kNoLook, 0.0, false};
  for (const Feed& feed : feeds_) first.delay_s = std::max(first.delay_s, feed.delay_s);
  std::size_t i = 0;
  for (const SensorView& view : situation.around) {
    const CuboidMap* map = view.map;
    const double delay_s = feeds_[i++].delay_s;
    if (view.is_out) continue;
    const double late_s = kLateShare * toSeconds(map->look_period) + delay_s;
    const auto next = map->looks.nextLook(place.p_fixed, marginAt(map->looks, place.p_fixed),
                                          situation.now, map->look_period, fromSeconds(late_s));
    if (!next) continue;
    const double until_s = std::max(0.0, toSeconds(*next - situation.now));
    if (until_s + delay_s < first.until_s + first.delay_s) first = {until_s, delay_s, true};
  }
  return first;
}

}  // namespace tccm
