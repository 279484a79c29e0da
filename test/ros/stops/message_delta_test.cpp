#include "ros/stops/message_delta.h"

#include <gtest/gtest.h>

#include <random>

namespace tccm {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(MessageDeltaTest, AChangeMakesTheMessageFromTheOneBefore) {
  std::mt19937 random(3);
  tccm_monitor::CuboidMapChange change;
  for (int i = 0; i < 2000; ++i) {
    Bytes before(random() % 400), after;
    for (std::uint8_t& byte : before) byte = static_cast<std::uint8_t>(random());
    after = before;
    after.resize(random() % 400, 7);
    for (std::size_t k = random() % 5; k-- > 0 && !after.empty();) {
      after[random() % after.size()] = static_cast<std::uint8_t>(random());
    }
    toChange(before, after, change);
    Bytes made = before;
    ASSERT_EQ(applyChange(change, made), "");
    ASSERT_EQ(made, after);
  }
}

TEST(MessageDeltaTest, WhatIsTheSameTakesNoBytes) {
  Bytes before(3200, 1), after = before;
  tccm_monitor::CuboidMapChange change;
  toChange(before, after, change);
  EXPECT_TRUE(change.bytes.empty());
  after[100] = 2;
  after[133] = 2;  // in the block after
  after[1000] = 2;
  toChange(before, after, change);
  EXPECT_EQ(change.begins, (std::vector<std::uint32_t>{96, 992}));
  EXPECT_EQ(change.lengths, (std::vector<std::uint32_t>{64, 32}));
}

TEST(MessageDeltaTest, WhatDoesNotFitIsRefused) {
  tccm_monitor::CuboidMapChange change;
  Bytes before(100, 0), after(100, 1);
  toChange(before, after, change);
  Bytes made = before;
  change.begins[0] = 4000000000U;
  EXPECT_NE(applyChange(change, made), "");
  change.begins[0] = 8;
  EXPECT_NE(applyChange(change, made), "");
  change.begins = {0, 0};
  EXPECT_NE(applyChange(change, made), "");
  toChange(before, after, change);
  change.bytes.pop_back();
  EXPECT_NE(applyChange(change, made), "");
}

}  // namespace
}  // namespace tccm
