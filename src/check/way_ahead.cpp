#include "check/way_ahead.h"

#include <algorithm>

#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr double kEscape_s = 10.0;  // a way out may be as slow as this
constexpr double kEscape_m = 0.05;  // that a primitive moves at most on the way looked at

}  // namespace

void WayAhead::Config::validate() const {
  requireInRange("horizon_s", horizon_s, 0.0, 10.0);
  requireInRange("way_step_m", step_m, 1e-3, 1.0);
  requireInRange("reaction_time_s", reaction_time_s, 0.0, 2.0);
  requireInRange("margin_max_m", margin_max_m, 0.0, 1.0);
  requireInRange("stop_time_s", stop_time_s, 0.0, 10.0);
  requireInRange("deceleration_mps2", deceleration_mps2, 0.01, 1000.0);
  requireInRange("slow_scale_min", slow_scale_min, 0.0, 1.0);
  requireInRange("moving_out_scale", moving_out_scale, 0.0, 1.0);
}

WayAhead::WayAhead(std::shared_ptr<const RobotModel> model, const PoseCheck::Config& pose,
                   const Config& config)
    : model_(std::move(model)),
      config_((config.validate(), config)),
      check_(model_, pose.collision_use, pose.collision, config.step_m, config.margin_max_m),
      moving_out_(model_, pose),
      measured_(model_->variables().size()),
      commanded_(model_->variables().size()),
      escape_(model_->variables().size()),
      end_(model_->variables().size()) {
  measured_.reserve(model_->variables().size() + 2);
  commanded_.reserve(CommandedTrajectories::kWayPoints);
}

void WayAhead::exempt(const ExemptRegions& regions) {
  check_.exempt(regions);
  moving_out_.exempt(regions);
}

void WayAhead::setOut(const JointSnapshot& joints, CommandedTrajectories& commanded) {
  extrapolate(*model_, joints, config_.horizon_s, measured_);
  follows_ = commanded.active();
  if (follows_) commanded.makeWay(*model_, joints, config_.horizon_s, commanded_);
  (follows_ ? commanded_ : measured_).positionsAt(config_.horizon_s, end_);
}

std::optional<WayContact> WayAhead::along(const CuboidMap& map, const JointPath& way,
                                          const std::vector<Pose>& T_fixed_roots) {
  check_.setMargins(way, 0.0, config_.horizon_s, T_fixed_roots, {delay_s_, config_.margin_max_m});
  auto grown = check_.firstContact(map, way, 0.0, config_.horizon_s, T_fixed_roots);
  poses_ += check_.poses();
  if (!grown) return std::nullopt;
  check_.clearMargins();
  const auto found = check_.firstContact(map, way, 0.0, config_.horizon_s, T_fixed_roots);
  poses_ += check_.poses();
  grown->by_margin = true;
  return found ? found : grown;
}

std::optional<WayContact> WayAhead::firstContact(const CuboidMap& map, double latency_s,
                                                 const std::vector<Pose>& T_fixed_roots,
                                                 const std::vector<Contact>& present) {
  check_.skip(present);
  delay_s_ = config_.reaction_time_s + std::max(0.0, latency_s);
  poses_ = 0;
  const auto measured = along(map, measured_, T_fixed_roots);
  if (!follows_) return measured;
  const auto commanded = along(map, commanded_, T_fixed_roots);
  if (!measured || !commanded) return measured ? measured : commanded;
  if (measured->by_margin != commanded->by_margin) {
    return measured->by_margin ? commanded : measured;
  }
  return commanded->time_s < measured->time_s ? commanded : measured;
}

bool WayAhead::movesOut(const CuboidMap& map, const std::vector<Contact>& contacts,
                        const JointSnapshot& joints, CommandedTrajectories& commanded,
                        const std::vector<Pose>& T_fixed_roots) {
  const auto opens = [&](bool must_open) {
    const double until_s = moving_out_.timeOf(escape_, kEscape_m);
    return moving_out_.opens(map, contacts, escape_, until_s, T_fixed_roots, must_open);
  };
  extrapolate(*model_, joints, follows_ ? config_.horizon_s : kEscape_s, escape_);
  if (!opens(!follows_)) return false;
  if (!follows_) return true;
  commanded.makeWay(*model_, joints, kEscape_s, escape_);
  return opens(true);
}

double WayAhead::haltTime(const WayContact& contact) const {
  return config_.stop_time_s + delay_s_ + 0.5 * contact.link_speed_mps / config_.deceleration_mps2;
}

Level WayAhead::levelOf(const WayContact& contact) const {
  return !contact.by_margin && contact.time_s <= haltTime(contact) ? Level::kStop : Level::kSlow;
}

double WayAhead::speedScale(const WayContact& contact) const {
  const double span = config_.horizon_s - haltTime(contact);
  const double share = span > 0.0 ? (contact.time_s - haltTime(contact)) / span : 0.0;
  return std::clamp(share, config_.slow_scale_min, 1.0);
}

}  // namespace tccm
