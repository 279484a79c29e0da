#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <random>

#include "check/governed_speed.h"

namespace tccm {
namespace {

constexpr double kLag = 0.06;  // [s]
const Duration kLagTime = fromSeconds(kLag);
constexpr double kBraking = 5.0;  // [1/s]

Time at(double seconds) { return Time() + fromSeconds(seconds); }

TEST(ObeyedScaleTest, APermissionThatDoesNotChangeIsWhatIsObeyed) {
  ObeyedScale obeyed;
  for (double t = 0.0; t < 1.0; t += 0.01) obeyed.add(at(t), 0.4, kBraking, kLagTime);
  EXPECT_DOUBLE_EQ(obeyed.least(), 0.4);
  EXPECT_DOUBLE_EQ(obeyed.most(), 0.4);
}

TEST(ObeyedScaleTest, BeforeItIsKnownTheRobotMayMoveAtAnyScale) {
  ObeyedScale obeyed;
  obeyed.add(at(0.0), 0.2, kBraking, kLagTime);
  EXPECT_DOUBLE_EQ(obeyed.least(), 0.2);
  EXPECT_DOUBLE_EQ(obeyed.most(), 1.0);
}

// The oracle: a robot that follows each permission after a delay of less than the lag, and brakes
// no more slowly than it is said to.
TEST(ObeyedScaleTest, ARobotThatFollowsAfterADelayIsWithinTheRange) {
  std::mt19937_64 random(5);
  for (int run = 0; run < 50; ++run) {
    std::uniform_real_distribution<double> share(0.0, 1.0);
    const double delay = kLag * share(random);
    ObeyedScale obeyed;
    std::deque<std::pair<double, double>> permissions;
    double moves_at = 1.0;
    double permitted = 1.0;
    for (double t = 0.0; t < 3.0; t += 0.01) {
      if (share(random) < 0.1) permitted = share(random);
      permissions.emplace_back(t, permitted);
      obeyed.add(at(t), permitted, kBraking, kLagTime);
      while (permissions.size() > 1 && permissions[1].first <= t - delay) permissions.pop_front();
      const double heard =
          permissions.front().first <= t - delay ? permissions.front().second : 1.0;
      moves_at = std::max(heard, moves_at - kBraking * 0.01);
      EXPECT_LE(moves_at, obeyed.most() + 1e-9) << "run " << run << " at " << t;
      if (moves_at == heard) {
        EXPECT_GE(moves_at, obeyed.least()) << "run " << run << " at " << t;
      }
    }
    for (double t = 3.0; t < 4.0; t += 0.01) obeyed.add(at(t), 0.3, kBraking, kLagTime);
    EXPECT_DOUBLE_EQ(obeyed.least(), 0.3);
    EXPECT_DOUBLE_EQ(obeyed.most(), 0.3);
  }
}

}  // namespace
}  // namespace tccm
