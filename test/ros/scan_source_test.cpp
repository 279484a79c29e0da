#include "ros/scan_source.h"

#include <gtest/gtest.h>

#include <limits>

#include "ros/conversions.h"
#include "support/random.h"
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
  /// Nothing is heard of the sensor at the time of the first.
  void addOneThatCannotLeaveAndOneThatCould(ScanSource& source) {
    hearFromTo("laser", 0.95, 1.15);
    source.add(scanAt(1.2), "laser", at(1.23));
    source.add(scanAt(1.03), "laser", at(1.26));
  }

  AssemblerConfig settings_;
  TransformHistory history_{fromSeconds(0.1)};
};

TEST_F(ScanSourceTest, AScanLeavesOnceThereAreTransformsAroundAllItsBeams) {
  ScanSource source = this->source();
  source.add(scanAt(1.0), "laser", at(1.03));
  EXPECT_EQ(source.next(nullptr, at(1.03)), nullptr);
  hear("laser", 0.99);
  hear("laser", 1.01);  // after the first beam, before the last
  EXPECT_EQ(source.next(nullptr, at(1.04)), nullptr);
  EXPECT_EQ(source.waiting(), 1U);
  hear("laser", 1.03);
  const ScanSource::Ready* ready = source.next(nullptr, at(1.05));
  ASSERT_NE(ready, nullptr);
  EXPECT_EQ(ready->scan->stamp, at(1.0));
  ASSERT_TRUE(ready->T_fixed_sensor.covers(at(1.0), at(1.02)));
  EXPECT_NEAR(ready->T_fixed_sensor.at(at(1.01))->translation().x(), 1.01, 1e-9);
  EXPECT_EQ(source.waiting(), 0U);
  EXPECT_EQ(source.droppedCount(), 0U);
}

TEST_F(ScanSourceTest, ScansLeaveInTheOrderTheyCame) {
  ScanSource source = this->source();
  for (const double stamp : {1.0, 1.03, 1.06}) {
    source.add(scanAt(stamp), "laser", at(stamp + 0.03));
  }
  hearFromTo("laser", 0.95, 1.15);
  for (const double stamp : {1.0, 1.03, 1.06}) {
    const ScanSource::Ready* ready = source.next(nullptr, at(1.2));
    ASSERT_NE(ready, nullptr);
    EXPECT_EQ(ready->scan->stamp, at(stamp));
  }
  EXPECT_EQ(source.next(nullptr, at(1.2)), nullptr);
}

TEST_F(ScanSourceTest, AScanIsNotOvertakenByOneThatCouldLeave) {
  ScanSource source = this->source();
  addOneThatCannotLeaveAndOneThatCould(source);
  EXPECT_EQ(source.next(nullptr, at(1.3)), nullptr);
  EXPECT_EQ(source.waiting(), 2U);
}

TEST_F(ScanSourceTest, AScanThatWaitsTooLongIsDroppedAndTheNextLeaves) {
  ScanSource source = this->source();
  addOneThatCannotLeaveAndOneThatCould(source);
  EXPECT_EQ(source.next(nullptr, at(1.73)), nullptr);
  const ScanSource::Ready* ready = source.next(nullptr, at(1.74));
  ASSERT_NE(ready, nullptr);
  EXPECT_EQ(ready->scan->stamp, at(1.03));
  EXPECT_EQ(source.dropped().at("no_transform"), 1U);
}

TEST_F(ScanSourceTest, AGapInTheTransformsDropsAScanAtOnce) {
  ScanSource source = this->source();
  hear("laser", 0.95);
  hear("laser", 1.1);
  source.add(scanAt(1.0), "laser", at(1.03));
  EXPECT_EQ(source.next(nullptr, at(1.03)), nullptr);
  EXPECT_EQ(source.waiting(), 0U);
  EXPECT_EQ(source.dropped().at("transform_gap"), 1U);
}

TEST_F(ScanSourceTest, AScanFromBeforeTheFirstTransformIsDroppedAtOnce) {
  ScanSource source = this->source();
  hearFromTo("laser", 1.01, 1.2);
  source.add(scanAt(1.0), "laser", at(1.03));
  EXPECT_EQ(source.next(nullptr, at(1.03)), nullptr);
  EXPECT_EQ(source.dropped().at("no_transform"), 1U);
}

TEST_F(ScanSourceTest, AScanThatCannotBeProjectedIsRefusedAndCounted) {
  ScanSource source = this->source();
  LaserScan scan = scanAt(1.0);
  scan.angle_increment = std::numeric_limits<double>::quiet_NaN();
  source.add(scan, "laser", at(1.03));
  scan = scanAt(1.0);
  scan.ranges.clear();
  source.add(scan, "laser", at(1.03));
  EXPECT_EQ(source.waiting(), 0U);
  EXPECT_EQ(source.dropped().at("malformed"), 2U);
}

TEST_F(ScanSourceTest, ScansOfAnotherFrameAreDroppedNamingBoth) {
  test::Random random(3);
  for (int member = 0; member < 30; ++member) {
    ScanSource source = this->source();
    std::vector<ScanReport> dropped;
    source.onDrop([&dropped](const ScanReport& report) { dropped.push_back(report); });
    const int sensors = random.integer(2, 3);
    int before = 0;
    std::size_t changes = 0;
    for (int i = 0; i < 20; ++i) {
      // In turn, or one after the other, or as it comes.
      const int sensor = member % 3 == 0 ? i % sensors : random.integer(0, sensors - 1);
      if (i > 0 && sensor != before) ++changes;
      source.add(scanAt(1.0 + 0.03 * i), "laser" + std::to_string(sensor), at(1.03 + 0.03 * i));
      if (i > 0 && sensor != before) {
        const ScanReport& last = dropped.back();
        EXPECT_EQ(last.dropped, "frame_changed");
        EXPECT_NE(last.detail.find("'laser" + std::to_string(sensor) + "'"), std::string::npos);
        EXPECT_NE(last.detail.find("'laser" + std::to_string(before) + "'"), std::string::npos);
      }
      before = sensor;
    }
    EXPECT_EQ(dropped.size(), changes);
    EXPECT_EQ(source.waiting(), 20 - changes);
  }
}

TEST_F(ScanSourceTest, ASlashIsNoOtherFrameAndARecordingThatBeginsAnewMayHaveOne) {
  ScanSource source = this->source();
  source.add(scanAt(1.0), "laser", at(1.03));
  source.add(scanAt(1.03), "/laser", at(1.06));
  EXPECT_EQ(source.waiting(), 2U);
  source.clear();
  source.add(scanAt(1.06), "camera", at(1.09));
  EXPECT_EQ(source.waiting(), 1U);
  EXPECT_EQ(source.droppedCount(), 0U);
}

TEST_F(ScanSourceTest, AStampThatIsOffIsToldWithTheAmount) {
  hearFromTo("laser", 1e9, 1e9 + 0.2);
  const std::vector<std::pair<double, std::string>> stamps{{0.0, "its stamp is 0"},
                                                           {1e9 - 20.0, "s behind"},
                                                           {1e9 - 7200.0, "2.0 h behind"},
                                                           {1e9 + 20.0, "20 s ahead"},
                                                           {1e9 - 1e9 / 2.0, "16 years behind"},
                                                           {1e9 + 3.0 * 86400.0, "3.0 days ahead"}};
  for (const auto& [stamp, words] : stamps) {
    ScanSource source = this->source();
    std::string detail;
    source.onDrop([&detail](const ScanReport& report) { detail = report.detail; });
    source.add(scanAt(stamp), "laser", at(1e9));
    EXPECT_EQ(source.next(nullptr, at(1e9 + 0.51)), nullptr);
    EXPECT_NE(detail.find(words), std::string::npos) << stamp << ": " << detail;
  }
}

TEST_F(ScanSourceTest, AFrameThatTfDoesNotKnowIsNamed) {
  hearFromTo("camera", 0.95, 1.15);
  ScanSource source = this->source();
  std::string detail;
  source.onDrop([&detail](const ScanReport& report) { detail = report.detail; });
  source.add(scanAt(1.0), "laser", at(1.03));
  EXPECT_EQ(source.next(nullptr, at(1.6)), nullptr);
  EXPECT_NE(detail.find("tf has no frame 'laser'"), std::string::npos) << detail;
}

TEST_F(ScanSourceTest, WhereTransformsAreRefusedTheDropSaysSo) {
  ScanSource source = this->source();
  std::string detail;
  source.onDrop([&detail](const ScanReport& report) { detail = report.detail; });
  tf2_msgs::TFMessage message;
  message.transforms.resize(1);
  message.transforms[0].header.frame_id = "base";
  message.transforms[0].child_frame_id = "laser";
  message.transforms[0].transform.rotation.w = 1.1;
  history_.add(message, false);
  source.add(scanAt(1.0), "laser", at(1.03));
  EXPECT_EQ(source.next(nullptr, at(1.74)), nullptr);
  EXPECT_NE(detail.find("of laser: its quaternion is not of length 1"), std::string::npos)
      << detail;
}

TEST_F(ScanSourceTest, FramesMayStartWithASlash) {
  settings_.fixed_frame = "/base";
  ScanSource source = this->source();
  hearFromTo("laser", 0.95, 1.15);
  source.add(scanAt(1.0), "/laser", at(1.03));
  EXPECT_NE(source.next(nullptr, at(1.03)), nullptr);
}

TEST_F(ScanSourceTest, WithoutEndlessMemoryTheOldestScanGoesFirst) {
  ScanSource source = this->source();
  for (int i = 0; i < 150; ++i) {
    source.add(scanAt(1.0 + 0.03 * i), "laser", at(1.0 + 0.03 * i));
  }
  EXPECT_EQ(source.waiting() + source.dropped().at("no_transform"), 150U);
  EXPECT_LT(source.waiting(), 150U);
  hearFromTo("laser", 1.0, 6.0);
  const ScanSource::Ready* ready = source.next(nullptr, at(5.5));
  ASSERT_NE(ready, nullptr);
  EXPECT_EQ(ready->scan->stamp, at(1.0 + 0.03 * static_cast<double>(source.droppedCount())));
}

TEST_F(ScanSourceTest, DrainingDropsAndCountsWhatWaits) {
  ScanSource source = this->source();
  source.add(scanAt(1.0), "laser", at(1.03));
  source.add(scanAt(1.03), "laser", at(1.06));
  source.drain(nullptr);
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
  source_.add(scanAt(1.0), "laser", at(1.03));
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
  source_.add(scanAt(1.0), "laser", at(1.03));
  EXPECT_EQ(source_.next(&joints_, at(1.54)), nullptr);
  EXPECT_EQ(source_.dropped().at("no_joint_states"), 1U);
}

TEST_F(ScanSourceWithRobotTest, DrainingTellsWhatEachWaitedFor) {
  addJoints(0.99);
  addJoints(1.03);
  source_.add(scanAt(1.0), "laser", at(1.03));
  source_.add(scanAt(1.03), "laser", at(1.06));
  source_.drain(&joints_);
  EXPECT_EQ(source_.dropped().at("no_transform"), 1U);
  EXPECT_EQ(source_.dropped().at("no_joint_states"), 1U);
}

TEST_F(ScanSourceWithRobotTest, WhereTheRootsPoseNeverComesTheDropSaysSo) {
  addJoints(0.99);
  addJoints(1.03);
  source_.add(scanAt(1.0), "laser", at(1.03));
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
    source_.add(scanAt(1.0), "laser", at(1.03));
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
