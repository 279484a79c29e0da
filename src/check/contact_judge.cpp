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
  table.add("margin_max_m", &margin_max_m, "m", {0.0, 1.0},
            "ahead, primitives grow by their speed times the delay, at most by this; what only "
            "this margin touches slows the robot down");
}

void ContactJudge::Config::describe(ParameterTable& table) {
  table.add("horizon_s", &horizon_s, "s", {0.0, 10.0},
            "how far the way ahead is looked at (paper, section VI.B), further where halting takes "
            "longer; not tuned below `stop_time_s`",
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
      ahead_(robot, config.step_m, braking.margin_max_m),
      moving_out_(robot),
      escape_(robot->model->variables().size()) {}

const ContactJudge::Findings& ContactJudge::judge(const Situation& situation, Causes& causes) {
  lookAhead(situation);
  const std::optional<WayAhead::Found>& touch = ahead_.touch();
  const std::optional<WayAhead::Found>& margin = ahead_.margin();
  findings_ = {};
  if (touch || margin) findings_.first_contact = touch ? touch->contact : margin->contact;
  if (situation.here.collision) {
    // Where not all is known no way out is known either.
    judgePresent(situation, !situation.known || (touch && touch->stops), causes);
  }
  findings_.collision = situation.here.collision || touch;
  findings_.poses = ahead_.poses();
  if (touch || margin) causes.push_back(causeOf(touch, margin));
  if (ahead_.tooFast()) causes.push_back(tooFast(*ahead_.tooFast()));
  if (ahead_.isTooLong()) causes.push_back(tooLong(situation.joints));
  return findings_;
}

void ContactJudge::lookAhead(const Situation& situation) {
  const Braking& braking = situation.braking;
  const double delay_s = braking.delay(toSeconds(situation.now - situation.joints.oldest));
  const Posture& posture = situation.check_here.posture();
  ahead_.begin({config_.horizon_s, config_.stop_time_s, config_.slow_scale_min, delay_s,
                braking.deceleration_mps2},
               situation.here.contacts, posture, kWorkMax);
  const auto look = [&](const JointPath& path) {
    const Way way{situation.around.map, path, posture.T_fixed_roots};
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
Cause ContactJudge::causeOf(const std::optional<WayAhead::Found>& touch,
                            const std::optional<WayAhead::Found>& margin) const {
  const bool margin_counts = !touch || (margin && !touch->stops && margin->scale < touch->scale);
  const double scale = margin_counts ? margin->scale : touch->scale;
  const bool is_same =
      touch && margin && touch->contact.contact.shape == margin->contact.contact.shape;
  const WayContact& ahead = margin_counts && !is_same ? margin->contact : touch->contact;
  const std::string& link = robot_->model->linkOf(ahead.contact.shape);
  const std::string what = textOfContact(
      *robot_->model, ahead.contact.shape,
      ahead.by_margin ? " comes too near to the map for its speed" : " touches the map ahead");
  const std::string text = lineOf("%.150s in %.0f ms", what.c_str(), 1e3 * ahead.time_s);
  return touch && touch->stops ? Cause::stopping(Reason::kCollisionAhead, text, link)
                               : Cause::slowing(Reason::kCollisionAhead, scale, text, link);
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

/// As it is commanded, and measured not to do the contrary; without a trajectory as it is measured.
/// Looked at is the way of the next centimetres, however slow it is.
bool ContactJudge::movesOut(const Situation& situation) {
  CommandedTrajectories& commanded = situation.commanded;
  const bool follows = commanded.ways().follows_trajectory;
  const std::vector<Pose>& T_fixed_roots = situation.check_here.posture().T_fixed_roots;
  const auto opensAlong = [&](const JointPath& path, bool must_open) {
    return moving_out_.opens({situation.around.map, path, T_fixed_roots}, situation.here.contacts,
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
