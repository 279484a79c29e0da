#include "check/permission.h"

#include <algorithm>
#include <utility>

namespace tccm {
namespace {

/// At the present pose, with the map or a region to keep out of.
bool isContact(Reason reason) { return reason == Reason::kCollision || reason == Reason::kKeepOut; }

/// Holds until it is reset.
bool isLasting(Reason reason) { return isContact(reason) || levelOf(reason) == Level::kFault; }

bool isOcclusion(Reason reason) {
  return reason == Reason::kOcclusion || reason == Reason::kOcclusionAhead;
}

}  // namespace

void Permission::Config::describe(ParameterTable& table) {
  table.add("release_s", &release_s, "s", {0.0, 600.0},
            "clear for so long before a stop is released; never less than the map's window",
            Tunable::kYes);
  table.add("release_checks", &release_checks, "checks", {1, 10000},
            "and in so many checks in a row", Tunable::kYes);
  table.add("hold_until_reset", &hold_until_reset,
            "collisions at the present pose, and faults, hold until `reset`; false for recordings: "
            "nobody resets");
  table.add("speed_scale_rise_per_s", &speed_scale_rise_per_s, "1/s", {0.01, 1000.0},
            "how fast the speed scale rises; it falls at once", Tunable::kYes);
}

Permission::Permission(const Config& config) : config_(validated(config)) {
  decision_.reasons.reserve(32);
}

void Permission::reconfigure(const Config& config) { config_ = validated(config); }

void Permission::startAnew() {
  Permission anew(config_);
  anew.latched_ = latched_;
  anew.was_ever_known_ = was_ever_known_;
  *this = std::move(anew);
}

bool Permission::needsRelease(const Cause& cause) const {
  const bool found = cause.reason > Reason::kInit && cause.level == Level::kStop;
  return found || (was_known_ && cause.level == Level::kFault);
}

void Permission::latch(const Cause& cause) {
  if (!config_.hold_until_reset || !isLasting(cause.reason)) return;
  // A fault before anything was known only says that the robot's other nodes are still starting;
  // a clock that goes to and fro starts everything anew again and again.
  const bool was_known = cause.reason == Reason::kNoClock ? was_ever_known_ : was_known_;
  if (levelOf(cause.reason) == Level::kFault && !was_known) return;
  if (latched_.reason < cause.reason) latched_ = cause;
}

Cause Permission::held(Time now, const Findings& findings, bool moving_out) {
  // Only moving out of contact suspends a contact that holds; nothing suspends a fault.
  const bool is_suspended =
      moving_out && isContact(findings.touching.reason) && isContact(latched_.reason);
  if (latched_.reason != Reason::kClear && !is_suspended) {
    return {Reason::kAwaitingReset,
            std::string(tccm::name(latched_.reason)) + " holds until reset: " + latched_.detail,
            latched_.link};
  }
  if (!last_stop_) return {};
  const bool is_led_out_of = isContact(last_stop_reason_) ? isContact(findings.touching.reason)
                                                          : isOcclusion(last_stop_reason_);
  if ((moving_out && is_led_out_of) || is_suspended) return {};
  const Duration release = std::max(fromSeconds(config_.release_s), findings.window);
  if (now - *last_stop_ >= release && clear_checks_ >= config_.release_checks) {
    last_stop_.reset();
    return {};
  }
  return {Reason::kReleasing, "clear, but not for a whole window yet"};
}

void Permission::moveScale(Time now, double wanted) {
  const double last = decision_.speed_scale;
  const double rise = last_ ? config_.speed_scale_rise_per_s * toSeconds(now - *last_) : 0.0;
  decision_.speed_scale = wanted <= last ? wanted : std::min(wanted, last + rise);
  last_ = now;
}

const Permission::Decision& Permission::decide(Time now, Findings& findings) {
  was_known_ = was_known_ || findings.known;
  was_ever_known_ = was_ever_known_ || was_known_;
  std::stable_sort(findings.causes.begin(), findings.causes.end(),
                   [](const Cause& a, const Cause& b) { return a.isWorseThan(b); });
  Cause worst = findings.causes.empty() ? Cause() : findings.causes.front();
  bool moving_out = false;
  double speed_scale = 1.0;
  latch(findings.touching);
  touching_ = findings.touching;
  lasting_ = touching_.reason;
  decision_.reasons.clear();
  for (const Cause& cause : findings.causes) {
    latch(cause);
    moving_out = moving_out || cause.reason == Reason::kMovingOut;
    if (isLasting(cause.reason)) lasting_ = std::max(lasting_, cause.reason);
    decision_.reasons.push_back(cause.reason);
    speed_scale = std::min(speed_scale, cause.speed_scale);
  }
  const bool is_stop = worst.level >= Level::kStop;
  // What is not known to be clear does not count towards the release.
  if (last_stop_ ? is_stop || moving_out : needsRelease(worst)) {
    last_stop_ = now;
    if (is_stop) last_stop_reason_ = worst.reason;
    clear_checks_ = 0;
  } else if (last_stop_) {
    ++clear_checks_;
  }
  const Cause hold = held(now, findings, moving_out);
  if (hold.isWorseThan(worst)) {
    worst = hold;
    decision_.reasons.insert(decision_.reasons.begin(), hold.reason);
  }
  decision_.worst = worst;
  decision_.latched = latched_.reason;
  moveScale(now, worst.level >= Level::kStop ? 0.0 : speed_scale);
  return decision_;
}

std::string Permission::reset() {
  // A fault that is over is lifted although the robot touches something: else nothing could move it
  // out.
  if (isContact(lasting_) && levelOf(latched_.reason) == Level::kFault) {
    latched_ = touching_;
    return {};
  }
  if (lasting_ != Reason::kClear) return std::string(tccm::name(lasting_)) + " lasts";
  latched_ = {};
  return {};
}

}  // namespace tccm
