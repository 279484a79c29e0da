#include "check/contact_judge.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/line_of.h"
#include "geometry/distance.h"

namespace tccm {
namespace {

constexpr double kEscape_s = 10.0;  // a way out may be as slow as this
constexpr double kEscape_m = 0.05;  // that a primitive moves at most on the way looked at
constexpr double kStep = 0.01;      // [m] between two poses
constexpr std::size_t kPosesMax = 256;
constexpr double kJump = 1e-6;    // [s]; a motion that is as short cannot be followed
constexpr double kNoise = 0.002;  // [m] by which a distance may shrink without closing
constexpr double kOpens = 0.003;  // [m] by which it has to grow over the way
/// In the unit of CollisionCheck::work(): some 10 ms. A robot at its work takes a hundredth of it.
constexpr std::size_t kWorkMax = 2'000'000;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

MovingOut::MovingOut(std::shared_ptr<const CheckedRobot> robot)
    : robot_(std::move(robot)),
      body_(robot_->collision_body),
      kinematics_(robot_->model),
      bound_(*robot_->model, body_.shapes, body_.radii(0.0)),
      contacts_max_(static_cast<std::size_t>(robot_->config.collision.contacts_max)) {
  for (const std::size_t shape : body_.shapes) {
    cores_.push_back(core(robot_->model->shapes()[shape].shape));
  }
  pairs_.reserve(contacts_max_);
  least_m_.resize(body_.shapes.size());
}

void MovingOut::place(const Way& way, double time_s) {
  way.path.positionsAt(time_s, positions_);
  body_.place(kinematics_.update(positions_, way.T_fixed_roots));
}

double MovingOut::coreDistance(const CuboidMap& map, std::size_t shape,
                               std::uint32_t cuboid) const {
  return distance(cores_[shape], body_.body.poses[shape], map.box(map.cuboids[cuboid]));
}

bool MovingOut::closesAny(const CuboidMap& map) {
  for (Pair& pair : pairs_) {
    const double metres = coreDistance(map, pair.shape, pair.cuboid);
    if (metres == 0.0 || metres < pair.last_m - kNoise) return true;
    pair.last_m = std::max(pair.last_m, metres);
  }
  // Cuboids that came into reach since: not nearer than what touched before.
  robot_->collision.find(map, body_.body, contacts_);
  if (contacts_.size() >= contacts_max_) return true;  // not all of them are known
  return std::any_of(contacts_.begin(), contacts_.end(), [&](const Contact& contact) {
    const double least = least_m_[contact.shape];
    if (least == kInfinity) return true;
    // The padding may reach it, the primitive itself may not.
    const UprightBox box = map.box(map.cuboids[contact.cuboid]);
    const bool is_new = std::none_of(pairs_.begin(), pairs_.end(), [&](const Pair& pair) {
      return pair.shape == contact.shape && pair.cuboid == contact.cuboid;
    });
    const Shape& bare = robot_->model->shapes()[body_.shapes[contact.shape]].shape;
    if (is_new && distance(bare, body_.body.poses[contact.shape], box) == 0.0) return true;
    return coreDistance(map, contact.shape, contact.cuboid) < least - kNoise;
  });
}

double MovingOut::furthest(const JointPath& way, double from_s, double to_s) {
  way.travelUntil(from_s, travel_from_);
  way.travelUntil(to_s, travel_);
  for (std::size_t v = 0; v < travel_.size(); ++v) travel_[v] -= travel_from_[v];
  double metres = 0.0;
  for (std::size_t i = 0; i < body_.shapes.size(); ++i) {
    metres = std::max(metres, bound_.displacement(i, travel_));
  }
  return metres;
}

double MovingOut::timeOf(const JointPath& way, double metres) {
  if (furthest(way, way.begin(), way.end()) <= metres) return way.end();
  double before = way.begin(), after = way.end();
  for (int i = 0; i < 20; ++i) {
    const double middle = 0.5 * (before + after);
    (furthest(way, way.begin(), middle) <= metres ? before : after) = middle;
  }
  return after;
}

bool MovingOut::closesBetween(const Way& way, double from_s, double to_s) {
  if (furthest(way.path, from_s, to_s) > kStep) {
    if (to_s - from_s < kJump) return true;
    const double middle_s = 0.5 * (from_s + to_s);
    return closesBetween(way, from_s, middle_s) || closesBetween(way, middle_s, to_s);
  }
  if (++poses_ > kPosesMax) return true;  // too fast to be looked at
  place(way, to_s);
  return closesAny(way.map);
}

bool MovingOut::opens(const Way& way, const std::vector<Contact>& contacts, double until_s,
                      bool must_open) {
  if (contacts.size() >= contacts_max_) return false;  // not all of them are known
  place(way, way.path.begin());
  pairs_.clear();
  std::fill(least_m_.begin(), least_m_.end(), kInfinity);
  for (const Contact& contact : contacts) {
    const auto used = std::find(body_.shapes.begin(), body_.shapes.end(), contact.shape);
    const auto shape = static_cast<std::size_t>(used - body_.shapes.begin());
    const double metres = coreDistance(way.map, shape, contact.cuboid);
    if (metres == 0.0) return false;
    pairs_.push_back({shape, contact.cuboid, metres, metres});
    least_m_[shape] = std::min(least_m_[shape], metres);
  }
  poses_ = 0;
  if (closesBetween(way, way.path.begin(), until_s)) return false;
  // Of each shape what was nearest has to recede; the rest must only not come nearer.
  return !must_open || std::all_of(pairs_.begin(), pairs_.end(), [this](const Pair& pair) {
    return pair.first_m > least_m_[pair.shape] || pair.last_m >= pair.first_m + kOpens;
  });
}

void Braking::describe(ParameterTable& table) {
  table.add("reaction_time_s", &reaction_time_s, "s", {0.0, 2.0},
            "of the controller; with the measured latency and the joint states' age it is the "
            "delay after which a verdict has an effect",
            Tunable::kYes);
  table.add("deceleration_mps2", &deceleration_mps2, "m/s^2", {0.01, 1000.0},
            "of a link when the robot brakes", Tunable::kYes);
  table.add("margin_max_m", &margin_max_m, "m", {0.0, 1.0},
            "ahead, primitives grow by their speed times the delay, at most by this; what only "
            "this margin touches slows the robot down");
}

void ContactJudge::Config::describe(ParameterTable& table) {
  table.add("horizon_s", &horizon_s, "s", {0.0, 10.0},
            "how far the way ahead is looked at (paper, section VI.B); not tuned below "
            "`stop_time_s`",
            Tunable::kYes);
  table.add("way_step_m", &step_m, "m", {1e-3, 1.0},
            "no primitive moves further between two poses that are looked at; a cell");
  table.add("stop_time_s", &stop_time_s, "s", {0.0, 10.0},
            "a contact sooner than this, the delay and half the braking time stops, a later one "
            "slows down; `horizon_s`: whatever touches ahead stops, as in the paper; not tuned "
            "below `tuning_stop_time_min_s`",
            Tunable::kYes);
  table.add("slow_scale_min", &slow_scale_min, "", {0.0, 1.0},
            "the least speed scale short of a stop");
  table.add("moving_out_scale", &moving_out_scale, "", {0.0, 1.0},
            "speed scale while the robot moves out of a contact or a hidden place");
}

std::string textOfContact(const RobotModel& model, std::uint32_t shape, const std::string& what) {
  const std::string& link = model.linkOf(shape);
  const std::string& object = model.shapes()[shape].object;
  return (object.empty() ? link : "'" + object + "' on " + link) + what;
}

ContactJudge::ContactJudge(const std::shared_ptr<const CheckedRobot>& robot, const Config& config,
                           const Braking& braking)
    : robot_(robot),
      config_(validated(config)),
      way_(robot, config.step_m, braking.margin_max_m),
      moving_out_(robot),
      escape_(robot->model->variables().size()) {}

const ContactJudge::Findings& ContactJudge::judge(const Situation& situation, Causes& causes) {
  delay_s_ = situation.braking.delay(toSeconds(situation.now - situation.joints.oldest));
  const auto ahead = firstAhead(situation);
  Cause coming = ahead ? causeOf(*ahead, situation.braking) : Cause();
  findings_.first_contact = ahead;
  findings_.touching = {};
  if (situation.here.collision) {
    // Where not all is known no way out is known either.
    judgePresent(situation, !situation.known || coming.level == Level::kStop, causes);
  }
  findings_.collision = situation.here.collision || (ahead && !ahead->by_margin);
  if (ahead) causes.push_back(std::move(coming));
  if (findings_.is_too_long) causes.push_back(tooLong(situation.joints));
  return findings_;
}

Cause ContactJudge::tooLong(const JointSnapshot& joints) const {
  const auto fastest =
      std::max_element(joints.velocities.begin(), joints.velocities.end(),
                       [](double a, double b) { return std::abs(a) < std::abs(b); });
  const auto v = static_cast<std::size_t>(fastest - joints.velocities.begin());
  if (v >= joints.velocities.size())
    return {Reason::kCheckLate, "the way ahead is too long to judge"};
  return {Reason::kCheckLate,
          lineOf("the way ahead is too long to judge in time: joint '%.100s' moves at %.3g %s/s",
                 robot_->model->variables()[v].name.c_str(), joints.velocities[v],
                 robot_->model->slides(v) ? "m" : "rad")};
}

std::optional<WayContact> ContactJudge::along(const Way& way) {
  way_.setMargins(way, 0.0, config_.horizon_s, delay_s_);
  auto grown = way_.firstContact(way, 0.0, config_.horizon_s);
  findings_.poses += way_.poses();
  if (!grown) return std::nullopt;
  way_.clearMargins();
  const auto found = way_.firstContact(way, 0.0, config_.horizon_s);
  findings_.poses += way_.poses();
  grown->by_margin = true;
  return found ? found : grown;
}

/// Of two first contacts the graver: a touch before one of the margin alone, then the earlier.
std::optional<WayContact> ContactJudge::graver(const std::optional<WayContact>& one,
                                               const std::optional<WayContact>& other) {
  if (!one || !other) return one ? one : other;
  if (one->by_margin != other->by_margin) return one->by_margin ? other : one;
  return other->time_s < one->time_s ? other : one;
}

std::optional<WayContact> ContactJudge::firstAhead(const Situation& situation) {
  const std::vector<Pose>& T_fixed_roots = situation.check_here.posture().T_fixed_roots;
  const Ways& ways = situation.commanded.ways();
  way_.skip(situation.here.contacts);
  way_.allow(kWorkMax);
  findings_.poses = 0;
  auto first = along({situation.map, ways.measured, T_fixed_roots});
  if (ways.has_contrary)
    first = graver(first, along({situation.map, ways.contrary, T_fixed_roots}));
  if (ways.follows_trajectory) {
    first = graver(first, along({situation.map, ways.commanded, T_fixed_roots}));
  }
  findings_.is_too_long = way_.isTooLong();
  return first;
}

void ContactJudge::judgePresent(const Situation& situation, bool is_blocked, Causes& causes) {
  const Contact& contact = situation.here.contacts.front();
  const RobotModel& model = *robot_->model;
  const std::string& link = model.linkOf(contact.shape);
  findings_.first_contact = WayContact{contact};
  findings_.touching = {Reason::kCollision, textOfContact(model, contact.shape, " touches the map"),
                        link};
  if (!is_blocked && movesOut(situation)) {
    causes.push_back(Cause::slowing(Reason::kMovingOut, config_.moving_out_scale,
                                    textOfContact(model, contact.shape, " moves out of contact"),
                                    link));
  } else {
    causes.push_back(findings_.touching);
  }
}

Cause ContactJudge::causeOf(const WayContact& ahead, const Braking& braking) const {
  const RobotModel& model = *robot_->model;
  const std::string& link = model.linkOf(ahead.contact.shape);
  const std::string what = textOfContact(
      model, ahead.contact.shape,
      ahead.by_margin ? " comes too near to the map for its speed" : " touches the map ahead");
  const std::string text = lineOf("%.150s in %.0f ms", what.c_str(), 1e3 * ahead.time_s);
  // A contact that comes sooner cannot be waited for.
  const double halt_s =
      config_.stop_time_s + delay_s_ + 0.5 * ahead.link_speed_mps / braking.deceleration_mps2;
  if (!ahead.by_margin && ahead.time_s <= halt_s) {
    return Cause::stopping(Reason::kCollisionAhead, text, link);
  }
  const double span_s = config_.horizon_s - halt_s;
  const double share = span_s > 0.0 ? (ahead.time_s - halt_s) / span_s : 0.0;
  return Cause::slowing(Reason::kCollisionAhead, std::clamp(share, config_.slow_scale_min, 1.0),
                        text, link);
}

bool ContactJudge::movesOut(const Situation& situation) {
  const bool follows = situation.commanded.ways().follows_trajectory;
  const Way way{situation.map, escape_, situation.check_here.posture().T_fixed_roots};
  const auto opensAlong = [&](const Way& along, bool must_open) {
    return moving_out_.opens(along, situation.here.contacts,
                             moving_out_.timeOf(along.path, kEscape_m), must_open);
  };
  const auto opens = [&](bool must_open) { return opensAlong(way, must_open); };
  const JointPath& contrary = situation.commanded.ways().contrary;
  if (situation.commanded.ways().has_contrary &&
      !opensAlong({way.map, contrary, way.T_fixed_roots}, false)) {
    return false;
  }
  situation.commanded.makeMeasuredWay(situation.joints, follows ? config_.horizon_s : kEscape_s,
                                      escape_);
  if (!opens(!follows)) return false;
  if (!follows) return true;
  situation.commanded.makeWay(situation.joints, kEscape_s, escape_);
  return opens(true);
}

}  // namespace tccm
