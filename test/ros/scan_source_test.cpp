#include "ros/scan_source.h"

#include <gtest/gtest.h>

#include <limits>

#include "ros/conversions.h"
#include "support/tiny_robot.h"

namespace tccm {
namespace {

Time at(double seconds) { return Time(fromSeconds(seconds)); }

/// 20 ms long.
LaserScan scanAt(double stamp) {
  LaserScan scan;
  scan.stamp = at(stamp);
  scan.angle_increment = 0.1;
  scan.time_increment = fromSeconds(0.01);
  scan.range_min = 0.1;
  scan.range_max = 4.0;
  scan.ranges = {1.0F, 1.0F, 1.0F};
  return scan;
}

class ScanSourceTest : public ::testing::Test {
 protected:
  ScanSourceTest() {
    settings_.fixed_frame = "base";
    settings_.transform_wait_max_s = 0.5;
  }

  void hear(const std::string& child, double stamp) {
    tf2_msgs::TFMessage message;
    message.transforms.resize(1);
    message.transforms[0].header.frame_id = "base";
    message.transforms[0].header.stamp = toRos(at(stamp));
    message.transforms[0].child_frame_id = child;
    message.transforms[0].transform.translation.x = stamp;
    message.transforms[0].transform.rotation.w = 1.0;
    history_.add(message, false);
  }
  void hearFromTo(const std::string& child, double first, double last) {
    for (double stamp = first; stamp < last + 1e-6; stamp += 0.05) hear(child, stamp);
  }
  ScanSource source(const std::vector<std::string>& roots = {}) {
    return {settings_, roots, history_};
  }
  /// Nothing is heard of the first one's sensor.
  void addOneThatCannotLeaveAndOneThatCould(ScanSource& source) {
    hearFromTo("camera", 0.95, 1.15);
    EXPECT_EQ(source.add(scanAt(1.0), "laser", at(1.03)), "");
    EXPECT_EQ(source.add(scanAt(1.03), "camera", at(1.06)), "");
  }

  AssemblerConfig settings_;
  TransformHistory history_{fromSeconds(0.1)};
};

TEST_F(ScanSourceTest, AScanLeavesOnceThereAreTransformsAroundAllItsBeams) {
  ScanSource source = this->source();
  EXPECT_EQ(source.add(scanAt(1.0), "laser", at(1.03)), "");
  EXPECT_EQ(source.next(nullptr, at(1.03)), nullptr);
  hear("laser", 0.99);
  hear("laser", 1.01);  // after the first beam, before the last
  EXPECT_EQ(source.next(nullptr, at(1.04)), nullptr);
  EXPECT_EQ(source.waiting(), 1U);
  hear("laser", 1.03);
  const ScanSource::Ready* ready = source.next(nullptr, at(1.05));
  ASSERT_NE(ready, nullptr);
  EXPECT_EQ(ready->scan.stamp, at(1.0));
  ASSERT_TRUE(ready->T_fixed_sensor.covers(at(1.0), at(1.02)));
  EXPECT_NEAR(ready->T_fixed_sensor.at(at(1.01))->translation().x(), 1.01, 1e-9);
  EXPECT_EQ(source.waiting(), 0U);
  EXPECT_EQ(source.droppedCount(), 0U);
}

TEST_F(ScanSourceTest, ScansLeaveInTheOrderTheyCame) {
  ScanSource source = this->source();
  for (const double stamp : {1.0, 1.03, 1.06}) {
    EXPECT_EQ(source.add(scanAt(stamp), "laser", at(stamp + 0.03)), "");
  }
  hearFromTo("laser", 0.95, 1.15);
  for (const double stamp : {1.0, 1.03, 1.06}) {
    const ScanSource::Ready* ready = source.next(nullptr, at(1.2));
    ASSERT_NE(ready, nullptr);
    EXPECT_EQ(ready->scan.stamp, at(stamp));
  }
  EXPECT_EQ(source.next(nullptr, at(1.2)), nullptr);
}

TEST_F(ScanSourceTest, AScanIsNotOvertakenByOneThatCouldLeave) {
  ScanSource source = this->source();
  addOneThatCannotLeaveAndOneThatCould(source);
  EXPECT_EQ(source.next(nullptr, at(1.1)), nullptr);
  EXPECT_EQ(source.waiting(), 2U);
}

TEST_F(ScanSourceTest, AScanThatWaitsTooLongIsDroppedAndTheNextLeaves) {
  ScanSource source = this->source();
  addOneThatCannotLeaveAndOneThatCould(source);
  EXPECT_EQ(source.next(nullptr, at(1.53)), nullptr);
  const ScanSource::Ready* ready = source.next(nullptr, at(1.54));
  ASSERT_NE(ready, nullptr);
  EXPECT_EQ(ready->scan.stamp, at(1.03));
  EXPECT_EQ(source.dropped().at("no_transform"), 1U);
}

TEST_F(ScanSourceTest, AGapInTheTransformsDropsAScanAtOnce) {
  ScanSource source = this->source();
  hear("laser", 0.95);
  hear("laser", 1.1);
  EXPECT_EQ(source.add(scanAt(1.0), "laser", at(1.03)), "");
  EXPECT_EQ(source.next(nullptr, at(1.03)), nullptr);
  EXPECT_EQ(source.waiting(), 0U);
  EXPECT_EQ(source.dropped().at("transform_gap"), 1U);
}

TEST_F(ScanSourceTest, AScanFromBeforeTheFirstTransformIsDroppedAtOnce) {
  ScanSource source = this->source();
  hearFromTo("laser", 1.01, 1.2);
  EXPECT_EQ(source.add(scanAt(1.0), "laser", at(1.03)), "");
  EXPECT_EQ(source.next(nullptr, at(1.03)), nullptr);
  EXPECT_EQ(source.dropped().at("no_transform"), 1U);
}

TEST_F(ScanSourceTest, AScanThatCannotBeProjectedIsRefusedAndCounted) {
  ScanSource source = this->source();
  LaserScan scan = scanAt(1.0);
  scan.angle_increment = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(source.add(scan, "laser", at(1.03)), "");
  scan = scanAt(1.0);
  scan.ranges.clear();
  EXPECT_NE(source.add(scan, "laser", at(1.03)), "");
  EXPECT_EQ(source.waiting(), 0U);
  EXPECT_EQ(source.dropped().at("malformed"), 2U);
}

TEST_F(ScanSourceTest, FramesMayStartWithASlash) {
  settings_.fixed_frame = "/base";
  ScanSource source = this->source();
  hearFromTo("laser", 0.95, 1.15);
  EXPECT_EQ(source.add(scanAt(1.0), "/laser", at(1.03)), "");
  EXPECT_NE(source.next(nullptr, at(1.03)), nullptr);
}

TEST_F(ScanSourceTest, WithoutEndlessMemoryTheOldestScanGoesFirst) {
  ScanSource source = this->source();
  for (int i = 0; i < 150; ++i) {
    EXPECT_EQ(source.add(scanAt(1.0 + 0.03 * i), "laser", at(1.0 + 0.03 * i)), "");
  }
  EXPECT_EQ(source.waiting() + source.dropped().at("no_transform"), 150U);
  EXPECT_LT(source.waiting(), 150U);
  hearFromTo("laser", 1.0, 6.0);
  const ScanSource::Ready* ready = source.next(nullptr, at(5.5));
  ASSERT_NE(ready, nullptr);
  EXPECT_EQ(ready->scan.stamp, at(1.0 + 0.03 * static_cast<double>(source.droppedCount())));
}

TEST_F(ScanSourceTest, DrainingDropsAndCountsWhatWaits) {
  ScanSource source = this->source();
  EXPECT_EQ(source.add(scanAt(1.0), "laser", at(1.03)), "");
  EXPECT_EQ(source.add(scanAt(1.03), "laser", at(1.06)), "");
  source.drain();
  EXPECT_EQ(source.waiting(), 0U);
  EXPECT_EQ(source.dropped().at("no_transform"), 2U);
}

/// With a robot to filter out, whose joints and root have to be known too.
class ScanSourceWithRobotTest : public ScanSourceTest {
 protected:
  ScanSourceWithRobotTest() : source_(source({"root"})) { hearFromTo("laser", 0.95, 1.15); }
  void addJoints(double stamp) { joints_.add(at(stamp), {"slide", "glide"}, {0.0, 0.0}, {}); }
  ScanSource source_;
  JointStates joints_{*test::sliderModel(), {}};
};

TEST_F(ScanSourceWithRobotTest, AScanWaitsForJointStatesAndRootPast) {
  EXPECT_EQ(source_.add(scanAt(1.0), "laser", at(1.03)), "");
  hearFromTo("root", 0.95, 1.15);
  EXPECT_EQ(source_.next(&joints_, at(1.03)), nullptr);
  addJoints(0.99);
  addJoints(1.01);
  EXPECT_EQ(source_.next(&joints_, at(1.03)), nullptr);
  EXPECT_EQ(source_.waiting(), 1U);
  addJoints(1.03);
  const ScanSource::Ready* ready = source_.next(&joints_, at(1.04));
  ASSERT_NE(ready, nullptr);
  EXPECT_TRUE(ready->T_fixed_roots.at(0).covers(at(1.0), at(1.02)));
}

TEST_F(ScanSourceWithRobotTest, WhereJointStatesNeverComeTheDropSaysSo) {
  hearFromTo("root", 0.95, 1.15);
  EXPECT_EQ(source_.add(scanAt(1.0), "laser", at(1.03)), "");
  EXPECT_EQ(source_.next(&joints_, at(1.54)), nullptr);
  EXPECT_EQ(source_.dropped().at("no_joint_states"), 1U);
}

TEST_F(ScanSourceWithRobotTest, WhereTheRootsPoseNeverComesTheDropSaysSo) {
  addJoints(0.99);
  addJoints(1.03);
  EXPECT_EQ(source_.add(scanAt(1.0), "laser", at(1.03)), "");
  EXPECT_EQ(source_.next(&joints_, at(1.54)), nullptr);
  EXPECT_EQ(source_.dropped().at("no_transform"), 1U);
}

/// With a robot whose links hang on two roots.
class ScanSourceWithTwoRootsTest : public ScanSourceTest {
 protected:
  ScanSourceWithTwoRootsTest() : source_(source({"root", "trailer"})) {
    hearFromTo("laser", 0.95, 1.15);
    for (const double stamp : {0.99, 1.03}) {
      joints_.add(at(stamp), {"slide", "glide"}, {0.0, 0.0}, {});
    }
    EXPECT_EQ(source_.add(scanAt(1.0), "laser", at(1.03)), "");
  }
  ScanSource source_;
  JointStates joints_{*test::sliderModel(), {}};
};

TEST_F(ScanSourceWithTwoRootsTest, AScanWaitsForBothAndBringsThemInTheirOrder) {
  hear("trailer", 0.99);
  hear("trailer", 1.01);
  hear("trailer", 1.03);
  EXPECT_EQ(source_.next(&joints_, at(1.04)), nullptr);
  EXPECT_EQ(source_.waiting(), 1U);
  hear("root", 0.98);
  hear("root", 1.08);
  const ScanSource::Ready* ready = source_.next(&joints_, at(1.09));
  ASSERT_NE(ready, nullptr);
  ASSERT_EQ(ready->T_fixed_roots.size(), 2U);
  for (const PosePath& path : ready->T_fixed_roots) {
    ASSERT_TRUE(path.covers(at(1.0), at(1.02)));
    EXPECT_NEAR(path.at(at(1.01))->translation().x(), 1.01, 1e-9);
  }
}

TEST_F(ScanSourceWithTwoRootsTest, EachIsPlacedByItsOwnFrame) {
  hearFromTo("root", 0.95, 1.15);
  tf2_msgs::TFMessage message;
  message.transforms.resize(1);
  message.transforms[0].header.frame_id = "base";
  message.transforms[0].child_frame_id = "trailer";
  message.transforms[0].transform.translation.y = -2.0;
  message.transforms[0].transform.rotation.w = 1.0;
  history_.add(message, true);
  const ScanSource::Ready* ready = source_.next(&joints_, at(1.04));
  ASSERT_NE(ready, nullptr);
  EXPECT_NEAR(ready->T_fixed_roots.at(0).at(at(1.01))->translation().x(), 1.01, 1e-9);
  EXPECT_NEAR(ready->T_fixed_roots.at(1).at(at(1.01))->translation().y(), -2.0, 1e-9);
  EXPECT_NEAR(ready->T_fixed_roots.at(1).at(at(1.01))->translation().x(), 0.0, 1e-9);
}

TEST_F(ScanSourceWithTwoRootsTest, WhereTheSecondNeverComesTheScanIsDropped) {
  hearFromTo("root", 0.95, 1.15);
  EXPECT_EQ(source_.next(&joints_, at(1.53)), nullptr);
  EXPECT_EQ(source_.waiting(), 1U);
  EXPECT_EQ(source_.next(&joints_, at(1.54)), nullptr);
  EXPECT_EQ(source_.waiting(), 0U);
  EXPECT_EQ(source_.dropped().at("no_transform"), 1U);
}

TEST_F(ScanSourceWithTwoRootsTest, AGapInTheSecondDropsTheScan) {
  hearFromTo("root", 0.95, 1.15);
  hear("trailer", 0.95);
  hear("trailer", 1.1);
  EXPECT_EQ(source_.next(&joints_, at(1.04)), nullptr);
  EXPECT_EQ(source_.waiting(), 0U);
  EXPECT_EQ(source_.dropped().at("transform_gap"), 1U);
}

}  // namespace
}  // namespace tccm
