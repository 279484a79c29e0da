#include "check/contact_judge.h"

#include <algorithm>
#include <cmath>

#include "base/line_of.h"

namespace tccm {
namespace {

constexpr double kEscape_s = 10.0;  // a way out may be as slow as this
/// In the unit of CollisionCheck::work(): some 10 ms. A robot at its work takes a hundredth of it.
constexpr std::size_t kWorkMax = 2'000'000;

}  // namespace

void Braking::describe(ParameterTable& table) {
  table.add("reaction_time_s", &reaction_time_s, "s", {0.0, 2.0},
            "of the controller; with the measured latency and the joint states' age it is the "
            "delay after which a verdict has an effect",
            Tunable::kYes);
  table.add("deceleration_mps2", &deceleration_mps2, "m/s^2", {0.01, 1000.0},
            "of a link when the robot brakes", Tunable::kYes);
  table.add("stop_duration_s", &stop_duration_s, "s", {0.0, 5.0},
            "how long halting takes, however slow the robot is: the `stop_trajectory_duration` of "
            "an arm's JointTrajectoryController; no less than `trajectory_gate` has it; 0: as "
            "`deceleration_mps2` alone says");
  table.add("margin_max_m", &margin_max_m, "m", {0.0, 1.0},
            "ahead, primitives grow by their speed times the delay, at most by this; what only "
            "this margin touches slows the robot down");
}

void ContactJudge::Config::describe(ParameterTable& table) {
  table.add("horizon_s", &horizon_s, "s", {0.0, 10.0},
            "how far the way ahead is looked at (paper, section VI.B), further by 5/8 of "
            "`stop_duration_s`, and where braking takes longer; not tuned below `stop_time_s`",
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
                           const Braking& braking, Against against)
    : robot_(robot),
      config_(validated(config)),
      against_(against),
      ahead_(robot, config.step_m, braking.margin_max_m),
      moving_out_(robot),
      escape_(robot->model->variables().size()) {}

Obstacles ContactJudge::obstaclesOf(const Situation& situation) const {
  if (against_ == Against::kKeepOut) return *situation.around.keep_out;
  return situation.around.map;
}

const std::vector<Contact>& ContactJudge::contactsOf(const Situation& situation) const {
  return against_ == Against::kKeepOut ? situation.here.keep_out : situation.here.contacts;
}

std::string ContactJudge::textOf(const Situation& situation, const Contact& contact,
                                 Told told) const {
  const bool is_region = against_ == Against::kKeepOut;
  const auto text = [&](const char* of_map, const char* of_region) {
    std::string what = is_region ? of_region : of_map;
    if (is_region) what += " '" + situation.around.keep_out->name(contact.cuboid) + "'";
    if (told == Told::kTooNear) what += " for its speed";
    return textOfContact(*robot_->model, contact.shape, what);
  };
  switch (told) {
    case Told::kTouches:
      return text(" touches the map", " is in keep-out region");
    case Told::kMovesOut:
      return text(" moves out of contact", " moves out of keep-out region");
    case Told::kAhead:
      return text(" touches the map ahead", " enters keep-out region");
    default:
      return text(" comes too near to the map", " comes too near to keep-out region");
  }
}

const ContactJudge::Findings& ContactJudge::judge(const Situation& situation, Causes& causes) {
  if (against_ == Against::kKeepOut && !situation.around.keep_out) {
    findings_ = {};
    return findings_;
  }
  lookAhead(situation);
  const std::optional<WayAhead::Found>& touch = ahead_.touch();
  const std::optional<WayAhead::Found>& margin = ahead_.margin();
  findings_ = {};
  if (touch || margin) findings_.first_contact = touch ? touch->contact : margin->contact;
  const bool touches_now = !contactsOf(situation).empty();
  if (touches_now) {
    // Where not all is known no way out is known either.
    judgePresent(situation, !situation.known || (touch && touch->stops), causes);
  }
  findings_.touches = touches_now || touch;
  findings_.poses = ahead_.poses();
  if (touch || margin) causes.push_back(causeOf(situation, touch, margin));
  // It is the same whatever is ahead.
  if (ahead_.tooFast() && against_ == Against::kMap) causes.push_back(tooFast(*ahead_.tooFast()));
  if (ahead_.isTooLong()) causes.push_back(tooLong(situation.joints));
  return findings_;
}

void ContactJudge::lookAhead(const Situation& situation) {
  const Braking& braking = situation.braking;
  const double delay_s = braking.delay(toSeconds(situation.now - situation.joints.oldest));
  const Posture& posture = situation.check_here.posture();
  // Further by what a controller takes to halt: there is as much room to slow down as without it.
  const double horizon_s = config_.horizon_s + BrakingWay::kStopShare * braking.stop_duration_s;
  ahead_.begin({horizon_s, config_.stop_time_s, config_.slow_scale_min, delay_s, braking.way()},
               contactsOf(situation), posture, kWorkMax);
  const auto look = [&](const JointPath& path) {
    const Way way{obstaclesOf(situation), path, posture.T_fixed_roots};
    if (ahead_.lookAlong(way)) return;
    situation.commanded.lengthenWays(situation.joints, ahead_.lookTimeMax());
    static_cast<void>(ahead_.lookAlong(way));
  };
  const Ways& ways = situation.commanded.ways();
  look(ways.measured);
  if (ways.has_contrary) look(ways.contrary);
  if (ways.follows_trajectory) look(ways.commanded);
}

/// Of what touches and what only comes too near, the graver; of both of one primitive the touch is
/// named.
Cause ContactJudge::causeOf(const Situation& situation, const std::optional<WayAhead::Found>& touch,
                            const std::optional<WayAhead::Found>& margin) const {
  const bool margin_counts = !touch || (margin && !touch->stops && margin->scale < touch->scale);
  const double scale = margin_counts ? margin->scale : touch->scale;
  const bool is_same =
      touch && margin && touch->contact.contact.shape == margin->contact.contact.shape;
  const WayContact& ahead = margin_counts && !is_same ? margin->contact : touch->contact;
  const std::string& link = robot_->model->linkOf(ahead.contact.shape);
  const std::string what =
      textOf(situation, ahead.contact, ahead.by_margin ? Told::kTooNear : Told::kAhead);
  const std::string text = lineOf("%.250s in %.0f ms", what.c_str(), 1e3 * ahead.time_s);
  const Reason reason =
      against_ == Against::kKeepOut ? Reason::kKeepOutAhead : Reason::kCollisionAhead;
  return touch && touch->stops ? Cause::stopping(reason, text, link)
                               : Cause::slowing(reason, scale, text, link);
}

Cause ContactJudge::tooFast(const WayAhead::TooFast& part) const {
  const std::string& link = robot_->model->linkOf(part.shape);
  return Cause::slowing(
      Reason::kSpeedGoverned, part.scale,
      lineOf("%.100s moves at %.3g m/s: it halts within the %.3g s that are looked ahead at %.3g",
             link.c_str(), part.speed_mps, part.looked_s, part.scale * part.speed_mps),
      link);
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

void ContactJudge::judgePresent(const Situation& situation, bool is_blocked, Causes& causes) {
  const Contact& contact = contactsOf(situation).front();
  const std::string& link = robot_->model->linkOf(contact.shape);
  findings_.first_contact = WayContact{contact};
  findings_.touching = {against_ == Against::kKeepOut ? Reason::kKeepOut : Reason::kCollision,
                        textOf(situation, contact, Told::kTouches), link};
  if (!is_blocked && movesOut(situation)) {
    causes.push_back(Cause::slowing(Reason::kMovingOut, config_.moving_out_scale,
                                    textOf(situation, contact, Told::kMovesOut), link));
  } else {
    causes.push_back(findings_.touching);
  }
}

/// As it is commanded, and measured not to do the contrary; without a trajectory as it is measured.
/// Looked at is the way of the next centimetres, however slow it is.
bool ContactJudge::movesOut(const Situation& situation) {
  CommandedTrajectories& commanded = situation.commanded;
  const bool follows = commanded.ways().follows_trajectory;
  const std::vector<Pose>& T_fixed_roots = situation.check_here.posture().T_fixed_roots;
  const auto opensAlong = [&](const JointPath& path, bool must_open) {
    return moving_out_.opens({obstaclesOf(situation), path, T_fixed_roots}, contactsOf(situation),
                             must_open);
  };
  if (commanded.ways().has_contrary && !opensAlong(commanded.ways().contrary, false)) return false;
  commanded.makeMeasuredWay(situation.joints, follows ? config_.horizon_s : kEscape_s, escape_);
  if (!opensAlong(escape_, !follows)) return false;
  if (!follows) return true;
  commanded.makeWay(situation.joints, kEscape_s, escape_);
  return opensAlong(escape_, true);
}

}  // namespace tccm
