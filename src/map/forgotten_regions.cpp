#include "map/forgotten_regions.h"

#include <algorithm>

namespace tccm {

ForgottenRegions::ForgottenRegions() { entries_.reserve(kShapesMax); }

void ForgottenRegions::add(const Region& region, Time until) {
  const std::size_t room = kShapesMax - entries_.size();
  if (region.size() > room) {
    entries_.erase(entries_.begin(),
                   entries_.begin() + static_cast<std::ptrdiff_t>(region.size() - room));
  }
  for (const PaddedShape& shape : region) entries_.push_back({RegionPart(shape), until, false});
}

bool ForgottenRegions::begin(Time stamp) {
  const auto over = [stamp](const Entry& entry) { return entry.until < stamp; };
  entries_.erase(std::remove_if(entries_.begin(), entries_.end(), over), entries_.end());
  bool any = false;
  for (Entry& entry : entries_) {
    entry.chosen = entry.until <= stamp + kUnderWayMax;
    any = any || entry.chosen;
  }
  return any;
}

bool ForgottenRegions::contains(const Vector3& p_fixed) const {
  return std::any_of(entries_.begin(), entries_.end(), [&p_fixed](const Entry& entry) {
    return entry.chosen && entry.part.contains(p_fixed);
  });
}

void ForgottenRegions::clear() { entries_.clear(); }

}  // namespace tccm
