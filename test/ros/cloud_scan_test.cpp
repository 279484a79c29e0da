#include "ros/cloud_scan.h"

#include <gtest/gtest.h>

#include <functional>

#include "support/near.h"
#include "support/random.h"

namespace tccm {
namespace {

using tccm_monitor::CloudScan;
using test::isNearly;
using test::Random;

ScanReturns anyReturns(Random& random, bool moving) {
  ScanReturns returns;
  returns.stamp = Time(fromSeconds(1000.0 + random.uniform(0.0, 1.0)));
  returns.viewpoint = random.point(2.0);
  for (int i = random.integer(0, 50); i > 0; --i) returns.points.push_back(random.point(3.0));
  Vector3 viewpoint = returns.viewpoint;
  for (int i = random.integer(1, 50); i > 0; --i) {
    if (moving && random.chance(0.5)) viewpoint = random.point(2.0);
    returns.looks.push_back(
        {viewpoint, random.point(3.0), static_cast<Seen>(random.integer(1, 4))});
  }
  return returns;
}

TEST(CloudScanTest, PointsAndLooksComeBack) {
  CloudScan message;
  ScanReturns back;
  for (unsigned seed = 0; seed < 100; ++seed) {
    Random random(seed);
    const bool moving = random.chance(0.5);
    const ScanReturns returns = anyReturns(random, moving);
    toMessage(returns, "base", message);
    EXPECT_EQ(message.header.frame_id, "base");
    if (!moving) {
      EXPECT_EQ(message.look_viewpoints.size(), 1U);
      EXPECT_TRUE(message.look_origins.empty());
    }
    ASSERT_EQ(fromMessage(message, back), "") << seed;
    EXPECT_EQ(back.stamp, returns.stamp);
    EXPECT_TRUE(isNearly(back.viewpoint, returns.viewpoint, 0.0));
    ASSERT_EQ(back.points.size(), returns.points.size());
    for (std::size_t i = 0; i < back.points.size(); ++i) {
      EXPECT_TRUE(isNearly(back.points[i], returns.points[i], 1e-6));
    }
    ASSERT_EQ(back.looks.size(), returns.looks.size());
    for (std::size_t i = 0; i < back.looks.size(); ++i) {
      EXPECT_TRUE(isNearly(back.looks[i].viewpoint, returns.looks[i].viewpoint, 0.0));
      EXPECT_TRUE(isNearly(back.looks[i].end, returns.looks[i].end, 1e-6));
      EXPECT_EQ(back.looks[i].what, returns.looks[i].what);
    }
  }
}

TEST(CloudScanTest, APointCostsTwelveBytes) {
  ScanReturns returns;
  returns.points.resize(100000, Vector3::Ones());
  CloudScan message;
  toMessage(returns, "base", message);
  EXPECT_LT(ros::serialization::serializationLength(message), 12 * 100000 + 200U);
}

TEST(CloudScanTest, WhatContradictsItselfIsRefused) {
  const std::vector<std::function<void(CloudScan&, Random&)>> wrongs{
      [](CloudScan& m, Random&) { m.points.push_back(0.0F); },
      [](CloudScan& m, Random&) { m.look_ends.pop_back(); },
      [](CloudScan& m, Random&) { m.look_kinds.push_back(1); },
      [](CloudScan& m, Random&) { m.look_viewpoints.clear(); },
      [](CloudScan& m, Random& random) {
        m.look_origins.assign(m.look_kinds.size(), 0);
        m.look_origins.back() = static_cast<std::uint16_t>(random.integer(1, 65535));
      },
      [](CloudScan& m, Random&) { m.look_origins.assign(m.look_kinds.size() + 1, 0); },
      [](CloudScan& m, Random& random) {
        m.look_kinds.front() =
            static_cast<std::uint8_t>(random.chance(0.5) ? 0 : random.integer(5, 255));
      }};
  for (std::size_t kind = 0; kind < wrongs.size(); ++kind) {
    for (unsigned seed = 0; seed < 20; ++seed) {
      Random random(seed);
      CloudScan message;
      ScanReturns back;
      toMessage(anyReturns(random, false), "base", message);
      ASSERT_EQ(fromMessage(message, back), "");
      wrongs[kind](message, random);
      EXPECT_NE(fromMessage(message, back), "") << kind << " " << seed;
    }
  }
}

}  // namespace
}  // namespace tccm
