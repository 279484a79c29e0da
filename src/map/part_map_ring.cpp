#include "map/part_map_ring.h"

#include <cassert>

namespace tccm {

PartMapRing::PartMapRing(std::size_t scans_max, std::size_t returns_max)
    : parts_(scans_max), returns_(returns_max) {}

void PartMapRing::begin(std::uint32_t serial, Time stamp) {
  assert(!full());
  newest_ = (oldest_ + scans_) % parts_.size();
  ++scans_;
  parts_[newest_] = Part{serial, stamp, next_, 0};
}

void PartMapRing::clear() { oldest_ = scans_ = next_ = used_ = 0; }

std::size_t PartMapRing::memoryBytes() const {
  return parts_.capacity() * sizeof(Part) + returns_.capacity() * sizeof(MappedReturn);
}

}  // namespace tccm
