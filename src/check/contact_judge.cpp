#include "check/contact_judge.h"

#include <algorithm>
#include <cstdio>

namespace tccm {
namespace {

constexpr double kEscape_s = 10.0;  // a way out may be as slow as this
constexpr double kEscape_m = 0.05;  // that a primitive moves at most on the way looked at

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
      escape_(robot->model().variables().size()) {}

void ContactJudge::judge(const Situation& situation, Causes& causes) {
  delay_s_ = situation.braking.delay(toSeconds(situation.now - situation.joints.oldest));
  const auto ahead = firstAhead(situation);
  Cause coming = ahead ? causeOf(*ahead, situation.braking) : Cause();
  first_contact_ = ahead;
  touching_ = {};
  if (situation.here.collision) {
    // Where not all is known no way out is known either.
    judgePresent(situation, !situation.known || coming.level == Level::kStop, causes);
  }
  collision_ = situation.here.collision || (ahead && !ahead->by_margin);
  if (ahead) causes.push_back(std::move(coming));
}

std::optional<WayContact> ContactJudge::along(const Way& way) {
  way_.setMargins(way, 0.0, config_.horizon_s, delay_s_);
  auto grown = way_.firstContact(way, 0.0, config_.horizon_s);
  poses_ += way_.poses();
  if (!grown) return std::nullopt;
  way_.clearMargins();
  const auto found = way_.firstContact(way, 0.0, config_.horizon_s);
  poses_ += way_.poses();
  grown->by_margin = true;
  return found ? found : grown;
}

std::optional<WayContact> ContactJudge::firstAhead(const Situation& situation) {
  const std::vector<Pose>& T_fixed_roots = situation.posture.T_fixed_roots;
  way_.skip(situation.here.contacts);
  poses_ = 0;
  const auto measured = along({situation.map, situation.ways.measured, T_fixed_roots});
  if (!situation.ways.follows_trajectory) return measured;
  const auto commanded = along({situation.map, situation.ways.commanded, T_fixed_roots});
  if (!measured || !commanded) return measured ? measured : commanded;
  if (measured->by_margin != commanded->by_margin) {
    return measured->by_margin ? commanded : measured;
  }
  return commanded->time_s < measured->time_s ? commanded : measured;
}

void ContactJudge::judgePresent(const Situation& situation, bool is_blocked, Causes& causes) {
  const Contact& contact = situation.here.contacts.front();
  const RobotModel& model = robot_->model();
  const std::string& link = model.linkOf(contact.shape);
  first_contact_ = WayContact{contact};
  touching_ = {Reason::kCollision, textOfContact(model, contact.shape, " touches the map"), link};
  if (!is_blocked && movesOut(situation)) {
    causes.push_back(Cause::slowing(Reason::kMovingOut, config_.moving_out_scale,
                                    textOfContact(model, contact.shape, " moves out of contact"),
                                    link));
  } else {
    causes.push_back(touching_);
  }
}

Cause ContactJudge::causeOf(const WayContact& ahead, const Braking& braking) const {
  const RobotModel& model = robot_->model();
  const std::string& link = model.linkOf(ahead.contact.shape);
  const std::string what = textOfContact(
      model, ahead.contact.shape,
      ahead.by_margin ? " comes too near to the map for its speed" : " touches the map ahead");
  char text[200];
  std::snprintf(text, sizeof text, "%.150s in %.0f ms", what.c_str(), 1e3 * ahead.time_s);
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
  const bool follows = situation.ways.follows_trajectory;
  const Way way{situation.map, escape_, situation.posture.T_fixed_roots};
  const auto opens = [&](bool must_open) {
    return moving_out_.opens(way, situation.here.contacts, moving_out_.timeOf(escape_, kEscape_m),
                             must_open);
  };
  situation.commanded.makeMeasuredWay(situation.joints, follows ? config_.horizon_s : kEscape_s,
                                      escape_);
  if (!opens(!follows)) return false;
  if (!follows) return true;
  situation.commanded.makeWay(situation.joints, kEscape_s, escape_);
  return opens(true);
}

}  // namespace tccm
