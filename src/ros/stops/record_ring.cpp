#include "ros/stops/record_ring.h"

#include <algorithm>
#include <cstring>

namespace tccm {

RecordRing::Chunk::Record RecordRing::Chunk::recordAt(std::size_t at) const {
  Record record{};
  std::int64_t stamp = 0;
  record.topic = bytes_[at];
  std::memcpy(&record.size, &bytes_[at + 1], sizeof record.size);
  std::memcpy(&stamp, &bytes_[at + 5], sizeof stamp);
  record.stamp = Time(Duration(stamp));
  record.bytes = bytes_.data() + at + kHeader;
  return record;
}

RecordRing::RecordRing(std::size_t bytes) {
  constexpr std::size_t kChunks = 2 * kHistory + 1;
  for (std::size_t i = 0; i < kChunks; ++i) {
    all_.push_back(std::make_unique<Chunk>());
    all_.back()->bytes_.resize(bytes / kChunks);
  }
  kept_.reserve(kHistory);
}

bool RecordRing::startsChunk(std::size_t size) const {
  return sealed_ || kept_.back()->used_ + kHeader + size > chunkBytes();
}

std::uint8_t* RecordRing::append(std::uint8_t topic, Time stamp, std::size_t size) {
  if (kHeader + size > chunkBytes()) return nullptr;
  if (startsChunk(size) && !startChunk()) return nullptr;
  Chunk& chunk = *kept_.back();
  std::uint8_t* header = chunk.bytes_.data() + chunk.used_;
  const auto length = static_cast<std::uint32_t>(size);
  const std::int64_t nanoseconds = stamp.time_since_epoch().count();
  header[0] = topic;
  std::memcpy(header + 1, &length, sizeof length);
  std::memcpy(header + 5, &nanoseconds, sizeof nanoseconds);
  chunk.used_ += kHeader + size;
  return header + kHeader;
}

bool RecordRing::startChunk() {
  if (kept_.size() == kHistory) kept_.erase(kept_.begin());
  const auto is_free = [this](const auto& chunk) {
    return chunk->pins_.load(std::memory_order_acquire) == 0 &&
           std::find(kept_.begin(), kept_.end(), chunk.get()) == kept_.end();
  };
  const auto found = std::find_if(all_.begin(), all_.end(), is_free);
  if (found == all_.end()) return false;
  (*found)->used_ = 0;
  kept_.push_back(found->get());
  sealed_ = false;
  return true;
}

void RecordRing::pin(std::vector<Chunk*>& chunks) {
  chunks.assign(kept_.begin(), kept_.end());
  for (Chunk* chunk : chunks) chunk->pins_.fetch_add(1, std::memory_order_relaxed);
  sealed_ = true;
}

std::size_t RecordRing::bytes() const {
  std::size_t sum = 0;
  for (const Chunk* chunk : kept_) sum += chunk->used_;
  return sum;
}

}  // namespace tccm
