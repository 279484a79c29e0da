#include "robot/path_cursor.h"

#include <gtest/gtest.h>

namespace tccm {
namespace {

/// One joint that moves a primitive by 2 m for each radian, one that does not move it.
const double kArms[] = {2.0, 0.0};

JointPath pathThrough(const std::vector<std::pair<double, double>>& places) {
  JointPath path(2);
  for (const auto& [time_s, position] : places) path.add(time_s, {position, -position});
  return path;
}

TEST(PathCursorTest, GoesByWhatThePrimitiveMovesNotByTime) {
  const JointPath path = pathThrough({{1.0, 0.0}, {2.0, 0.5}, {4.0, 0.3}});
  PathCursor cursor(2);
  cursor.start(path, kArms);
  EXPECT_EQ(cursor.time(), 1.0);
  ASSERT_TRUE(cursor.moveTo(0.5));
  EXPECT_DOUBLE_EQ(cursor.time(), 1.5);
  EXPECT_DOUBLE_EQ(cursor.positions()[0], 0.25);
  EXPECT_DOUBLE_EQ(cursor.positions()[1], -0.25);
  ASSERT_TRUE(cursor.moveTo(1.2)) << "and back again";
  EXPECT_DOUBLE_EQ(cursor.time(), 3.0);
  EXPECT_DOUBLE_EQ(cursor.positions()[0], 0.4);
  EXPECT_FALSE(cursor.moveTo(1.5));
  ASSERT_TRUE(cursor.moveTo(0.5)) << "back as well";
  EXPECT_DOUBLE_EQ(cursor.time(), 1.5);
  EXPECT_DOUBLE_EQ(cursor.metresUntil(1.5), 0.5);
  EXPECT_DOUBLE_EQ(cursor.metresUntil(9.0), 1.4);
}

TEST(PathCursorTest, APauseIsPassedAtItsBegin) {
  const JointPath path = pathThrough({{0.0, 0.0}, {1.0, 0.5}, {3.0, 0.5}, {4.0, 1.0}});
  PathCursor cursor(2);
  cursor.start(path, kArms);
  ASSERT_TRUE(cursor.moveTo(1.0));
  EXPECT_DOUBLE_EQ(cursor.time(), 1.0);
  ASSERT_TRUE(cursor.moveTo(1.5));
  EXPECT_DOUBLE_EQ(cursor.time(), 3.5);
}

TEST(PathCursorTest, TellsOfJumps) {
  const JointPath path = pathThrough({{0.0, 0.0}, {1.0, 0.5}, {1.0, 0.6}, {2.0, 0.7}});
  PathCursor cursor(2);
  cursor.start(path, kArms);
  ASSERT_TRUE(cursor.moveTo(0.9));
  EXPECT_FALSE(cursor.hasJumped(0.1));
  ASSERT_TRUE(cursor.moveTo(1.3));
  EXPECT_TRUE(cursor.hasJumped(0.1));
  EXPECT_FALSE(cursor.hasJumped(0.3));
  ASSERT_TRUE(cursor.moveTo(1.35));
  EXPECT_FALSE(cursor.hasJumped(0.1));
}

TEST(PathCursorTest, OfAPathOfOnePointThereIsOnlyTheBegin) {
  const JointPath path = pathThrough({{0.5, 0.3}});
  PathCursor cursor(2);
  cursor.start(path, kArms);
  EXPECT_TRUE(cursor.moveTo(0.0));
  EXPECT_EQ(cursor.positions()[0], 0.3);
  EXPECT_FALSE(cursor.moveTo(0.01));
}

}  // namespace
}  // namespace tccm
