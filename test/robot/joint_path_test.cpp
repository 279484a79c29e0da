#include "robot/joint_path.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random.h"

namespace tccm {
namespace {

using Positions = std::vector<double>;

Positions at(const JointPath& path, double time_s) {
  Positions positions;
  path.positionsAt(time_s, positions);
  return positions;
}

Positions travel(const JointPath& path, double time_s) {
  Positions result;
  path.travelUntil(time_s, result);
  return result;
}

/// Two joints: one goes there and back, one goes on.
JointPath thereAndBack() {
  JointPath path(2);
  path.add(1.0, {0.0, 5.0});
  path.add(2.0, {0.5, 6.0});
  path.add(4.0, {-0.5, 8.0});
  return path;
}

TEST(JointPathTest, IsStraightBetweenItsPoints) {
  const JointPath path = thereAndBack();
  EXPECT_EQ(at(path, 1.0), (Positions{0.0, 5.0}));
  EXPECT_EQ(at(path, 1.5), (Positions{0.25, 5.5}));
  EXPECT_EQ(at(path, 2.0), (Positions{0.5, 6.0}));
  EXPECT_EQ(at(path, 2.5), (Positions{0.25, 6.5}));
  EXPECT_EQ(at(path, 4.0), (Positions{-0.5, 8.0}));
}

TEST(JointPathTest, BeyondItsEndsItStaysThere) {
  const JointPath path = thereAndBack();
  EXPECT_EQ(path.begin(), 1.0);
  EXPECT_EQ(path.end(), 4.0);
  EXPECT_EQ(at(path, -9.0), (Positions{0.0, 5.0}));
  EXPECT_EQ(at(path, 99.0), (Positions{-0.5, 8.0}));
  EXPECT_EQ(travel(path, -9.0), (Positions{0.0, 0.0}));
  EXPECT_EQ(travel(path, 99.0), (Positions{1.5, 3.0}));
}

TEST(JointPathTest, TravelAddsUpThereAndBack) {
  const JointPath path = thereAndBack();
  EXPECT_EQ(travel(path, 1.0), (Positions{0.0, 0.0}));
  EXPECT_EQ(travel(path, 1.5), (Positions{0.25, 0.5}));
  EXPECT_EQ(travel(path, 2.0), (Positions{0.5, 1.0}));
  EXPECT_EQ(travel(path, 3.0), (Positions{1.0, 2.0})) << "back where it was, but not at rest";
  EXPECT_EQ(at(path, 3.0)[0], 0.0);
  EXPECT_EQ(travel(path, 4.0), (Positions{1.5, 3.0}));
}

TEST(JointPathTest, OnePointIsAWayThatLeadsNowhere) {
  JointPath path(1);
  path.add(0.3, {0.7});
  EXPECT_EQ(path.begin(), path.end());
  for (const double time_s : {-1.0, 0.3, 1.0}) {
    EXPECT_EQ(at(path, time_s), Positions{0.7});
    EXPECT_EQ(travel(path, time_s), Positions{0.0});
  }
}

TEST(JointPathTest, OfPointsAtOneInstantTheLastIsWhereItIsAndTheWayBetweenThemCounts) {
  JointPath path(1);
  path.add(0.0, {0.0});
  path.add(1.0, {1.0});
  path.add(1.0, {3.0});
  path.add(2.0, {3.0});
  EXPECT_EQ(at(path, 0.5), Positions{0.5});
  EXPECT_EQ(at(path, 1.0), Positions{3.0});
  EXPECT_NEAR(at(path, std::nextafter(1.0, 0.0))[0], 1.0, 1e-12);
  EXPECT_EQ(travel(path, 1.0), Positions{3.0});
  EXPECT_EQ(travel(path, 2.0), Positions{3.0});
}

TEST(JointPathTest, PointsAtOneInstantAtItsEndsAreTakenAsWell) {
  JointPath path(1);
  path.add(0.0, {1.0});
  path.add(0.0, {2.0});
  EXPECT_EQ(at(path, -1.0), Positions{1.0});
  EXPECT_EQ(at(path, 0.0), Positions{2.0});
  EXPECT_EQ(travel(path, 0.0), Positions{1.0});
}

TEST(JointPathTest, ARobotWithoutJointsHasAWayAsWell) {
  JointPath path(0);
  path.add(0.0, {});
  path.add(1.0, {});
  EXPECT_EQ(path.size(), 2U);
  EXPECT_TRUE(at(path, 0.5).empty());
}

TEST(JointPathTest, ClearedItStartsAnew) {
  JointPath path = thereAndBack();
  path.clear();
  EXPECT_TRUE(path.empty());
  path.add(0.0, {1.0, 1.0});
  path.add(1.0, {2.0, 0.0});
  EXPECT_EQ(path.size(), 2U);
  EXPECT_EQ(path.time(1), 1.0);
  EXPECT_EQ(at(path, 0.5), (Positions{1.5, 0.5}));
  EXPECT_EQ(travel(path, 1.0), (Positions{1.0, 1.0}));
}

TEST(JointPathTest, LongerResultsOfEarlierCallsAreReplaced) {
  Positions positions(7, 9.0);
  thereAndBack().positionsAt(1.5, positions);
  EXPECT_EQ(positions, (Positions{0.25, 5.5}));
}

TEST(JointPathTest, TravelOfRandomWaysIsThatOfManySmallMoves) {
  constexpr int kMoves = 50;
  test::Random random(1);
  for (int way = 0; way < 20; ++way) {
    JointPath path(2);
    double time_s = random.uniform(-1.0, 1.0);
    for (int i = 0; i < 8; ++i, time_s += random.uniform(0.001, 1.0)) {
      path.add(time_s, {random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0)});
    }
    Positions sum(2, 0.0), last = at(path, path.begin());
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      for (int k = 1; k <= kMoves; ++k) {  // none of them cuts a corner
        const double now = path.time(i) + (path.time(i + 1) - path.time(i)) * k / kMoves;
        const Positions here = at(path, now);
        for (std::size_t v = 0; v < 2; ++v) {
          sum[v] += std::abs(here[v] - last[v]);
          EXPECT_NEAR(travel(path, now)[v], sum[v], 1e-9);
        }
        last = here;
      }
    }
  }
}

}  // namespace
}  // namespace tccm
