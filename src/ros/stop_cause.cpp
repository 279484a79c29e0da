#include "ros/stop_cause.h"

#include <tccm_monitor/Cuboid.h>

namespace tccm {
namespace {

/// Nothing is found, and yet it stops.
bool endsAStop(Reason reason) {
  return reason == Reason::kReleasing || reason == Reason::kAwaitingReset;
}

}  // namespace

const char* name(Level level) {
  const char* const names[] = {"OK", "SLOW", "STOP", "FAULT"};
  return names[static_cast<std::size_t>(level)];
}

std::vector<Flagged> flaggedBy(const Verdict& verdict) {
  std::vector<Flagged> flagged;
  for (const PoseFindings* found : {&verdict.now, &verdict.ahead}) {
    for (const Contact& contact : found->contacts) {
      flagged.push_back({contact.cuboid, tccm_monitor::Cuboid::COLLISION});
    }
    for (const std::uint32_t cuboid : found->occluding_cuboids) {
      flagged.push_back({cuboid, tccm_monitor::Cuboid::OCCLUSION});
    }
  }
  if (verdict.approached) {
    flagged.push_back({verdict.approached->cuboid, tccm_monitor::Cuboid::COLLISION});
  }
  return flagged;
}

std::vector<FlaggedBox> flaggedBoxes(const Verdict& verdict, const CuboidMap& map) {
  std::vector<FlaggedBox> boxes;
  for (const auto& [cuboid, col] : flaggedBy(verdict)) {
    boxes.emplace_back(map.box(map.cuboids[cuboid]), col);
  }
  return boxes;
}

void StopCause::follow(const Verdict& verdict, const CuboidMap* map) {
  if (verdict.stop && (verdict.reason == reason_ || endsAStop(verdict.reason))) return;
  if (verdict.reason == Reason::kMovingOut) return;  // the stop comes back, to be released
  reason_ = verdict.stop ? verdict.reason : Reason::kClear;
  boxes_.clear();
  if (!verdict.stop) return;
  detail_ = verdict.detail;
  if (!verdict.placed || map == nullptr) return;
  boxes_ = flaggedBoxes(verdict, *map);
  if (verdict.first_contact) {
    const Cuboid& touched = map->cuboids[verdict.first_contact->contact.cuboid];
    boxes_.emplace_back(map->box(touched), std::uint8_t{tccm_monitor::Cuboid::COLLISION});
  }
}

bool ToldChanges::isNews(const Verdict& verdict) {
  constexpr Duration kWhile = std::chrono::seconds(1);
  const What now{verdict.level, verdict.reason};
  const bool is_of_stop = now.level >= Level::kStop || now.reason == Reason::kMovingOut;
  if (is_of_stop != std::exchange(is_of_stop_, is_of_stop)) seen_.fill(std::nullopt);
  std::optional<Time>& seen = seen_[static_cast<std::size_t>(now.reason)];
  if (!(now == current_)) {
    current_ = now;
    since_ = verdict.stamp;
    is_back_ = seen && verdict.stamp >= *seen && verdict.stamp - *seen <= kWhile;
  }
  seen = verdict.stamp;
  if (now == told_ || (is_back_ && verdict.stamp - since_ < kWhile)) return false;
  told_ = now;
  return true;
}

bool StopCause::outlives(const Verdict& verdict) const {
  return reason_ != Reason::kClear && endsAStop(verdict.reason);
}

}  // namespace tccm
