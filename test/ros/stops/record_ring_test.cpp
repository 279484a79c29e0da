#include "ros/stops/record_ring.h"

#include <gtest/gtest.h>

#include <cstring>
#include <deque>
#include <random>
#include <vector>

namespace tccm {
namespace {

struct Kept {
  std::uint8_t topic;
  std::int64_t stamp;
  std::vector<std::uint8_t> bytes;

  bool operator==(const Kept& other) const {
    return topic == other.topic && stamp == other.stamp && bytes == other.bytes;
  }
};

Kept randomRecord(std::mt19937& random, std::size_t size_max) {
  Kept record{static_cast<std::uint8_t>(random() % 20), static_cast<std::int64_t>(random()), {}};
  record.bytes.resize(random() % size_max);
  for (std::uint8_t& byte : record.bytes) byte = static_cast<std::uint8_t>(random());
  return record;
}

bool append(RecordRing& ring, const Kept& record) {
  std::uint8_t* place =
      ring.append(record.topic, Time(Duration(record.stamp)), record.bytes.size());
  if (place == nullptr) return false;
  if (!record.bytes.empty()) std::memcpy(place, record.bytes.data(), record.bytes.size());
  return true;
}

std::vector<Kept> readAll(const std::vector<RecordRing::Chunk*>& chunks) {
  std::vector<Kept> records;
  for (const RecordRing::Chunk* chunk : chunks) {
    chunk->visit([&records](const RecordRing::Chunk::Record& record) {
      records.push_back({record.topic,
                         record.stamp.time_since_epoch().count(),
                         {record.bytes, record.bytes + record.size}});
    });
  }
  return records;
}

TEST(RecordRingTest, ItHasTheLastRecordsInTheirOrder) {
  std::mt19937 random(1);
  RecordRing ring(17 * 1000);
  std::deque<Kept> all;
  std::vector<RecordRing::Chunk*> chunks;
  for (int i = 0; i < 5000; ++i) {
    all.push_back(randomRecord(random, 200));
    ASSERT_TRUE(append(ring, all.back()));
    ASSERT_LE(ring.bytes(), RecordRing::kHistory * ring.chunkBytes());
    if (i % 100 != 0) continue;
    ring.pin(chunks);
    const std::vector<Kept> records = readAll(chunks);
    for (RecordRing::Chunk* chunk : chunks) chunk->unpin();
    ASSERT_LE(records.size(), all.size());
    ASSERT_TRUE(std::equal(records.rbegin(), records.rend(), all.rbegin()));
    if (i <= 1000) continue;
    EXPECT_GT(ring.bytes(), 2000U);  // of 8000, as each pin ends a chunk
  }
}

TEST(RecordRingTest, WhatIsReadDoesNotChangeWhileOthersAreWritten) {
  std::mt19937 random(2);
  RecordRing ring(17 * 1000);
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(append(ring, randomRecord(random, 200)));
  std::vector<RecordRing::Chunk*> pinned;
  ring.pin(pinned);
  ASSERT_EQ(pinned.size(), RecordRing::kHistory);
  const std::vector<Kept> before = readAll(pinned);
  // More than the rest of the memory holds: the chunks that are not read are used again and again.
  for (int i = 0; i < 2000; ++i) ASSERT_TRUE(append(ring, randomRecord(random, 200)));
  EXPECT_TRUE(readAll(pinned) == before);
  for (RecordRing::Chunk* chunk : pinned) chunk->unpin();
}

TEST(RecordRingTest, WhatNoChunkHoldsIsRefused) {
  RecordRing ring(17 * 1000);
  EXPECT_EQ(ring.append(0, Time(), ring.chunkBytes()), nullptr);
  EXPECT_NE(ring.append(0, Time(), ring.chunkBytes() - RecordRing::kHeader), nullptr);
  EXPECT_TRUE(ring.startsChunk(1));
  EXPECT_NE(ring.append(0, Time(), 1), nullptr);
  EXPECT_FALSE(ring.startsChunk(1));
  ring.endChunk();
  EXPECT_TRUE(ring.startsChunk(1));
}

TEST(RecordRingTest, WithAllChunksReadNothingIsTaken) {
  RecordRing ring(17 * 1000);
  std::vector<std::vector<RecordRing::Chunk*>> pinned;
  for (int times = 0; times < 4; ++times) {
    for (std::size_t i = 0; i < RecordRing::kHistory; ++i) {
      ring.endChunk();
      if (ring.append(0, Time(), 1) == nullptr) {
        EXPECT_EQ(times, 2);  // one chunk more than twice the history
        return;
      }
    }
    ring.pin(pinned.emplace_back());
  }
  FAIL();
}

}  // namespace
}  // namespace tccm
