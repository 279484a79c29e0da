#include "ros/transform_history.h"

#include <console_bridge/console.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "ros/conversions.h"
#include "support/near.h"

namespace tccm {
namespace {

using Status = TransformHistory::Status;

Time at(double seconds) { return Time(fromSeconds(seconds)); }

/// A shift along x.
tf2_msgs::TFMessage shift(const std::string& parent, const std::string& child, double stamp,
                          double x) {
  tf2_msgs::TFMessage message;
  message.transforms.resize(1);
  geometry_msgs::TransformStamped& transform = message.transforms.front();
  transform.header.frame_id = parent;
  transform.header.stamp = toRos(at(stamp));
  transform.child_frame_id = child;
  transform.transform.translation.x = x;
  transform.transform.rotation.w = 1.0;
  return message;
}

class TransformHistoryTest : public ::testing::Test {
 protected:
  void move(const std::string& parent, const std::string& child, double stamp, double x) {
    history_.add(shift(parent, child, stamp, x), false);
  }
  void fix(const std::string& parent, const std::string& child, double x) {
    history_.add(shift(parent, child, 0.0, x), true);
  }
  Status statusAt(const std::string& target, const std::string& source, double stamp) {
    return history_.at(target, source, at(stamp)).status;
  }
  /// Fails, with NaN, where it is not found.
  double xAt(const std::string& target, const std::string& source, double stamp) {
    const auto lookup = history_.at(target, source, at(stamp));
    EXPECT_EQ(lookup.status, Status::kFound);
    return lookup.status == Status::kFound ? lookup.pose.translation().x()
                                           : std::numeric_limits<double>::quiet_NaN();
  }

  TransformHistory history_{fromSeconds(0.1)};
};

TEST_F(TransformHistoryTest, AQuaternionOfThreeDigitsIsARotation) {
  auto turned = shift("base", "laser", 0.0, 0.0);
  turned.transforms.front().transform.rotation.y = 0.707;
  turned.transforms.front().transform.rotation.w = 0.707;
  history_.add(turned, true);
  const auto lookup = history_.at("base", "laser", at(1.0));
  ASSERT_EQ(lookup.status, Status::kFound);
  EXPECT_TRUE(isRigid(lookup.pose));
}

TEST_F(TransformHistoryTest, BetweenTwoStampsAPoseIsInterpolated) {
  move("base", "laser", 1.0, 0.0);
  move("base", "laser", 1.1, 0.2);
  EXPECT_NEAR(xAt("base", "laser", 1.025), 0.05, 1e-9);
  EXPECT_NEAR(xAt("laser", "base", 1.025), -0.05, 1e-9);
  EXPECT_NEAR(xAt("base", "laser", 1.0), 0.0, 1e-9);
  EXPECT_NEAR(xAt("base", "laser", 1.1), 0.2, 1e-9);
}

TEST_F(TransformHistoryTest, NothingIsInterpolatedAcrossAGap) {
  move("base", "laser", 1.0, 0.0);
  move("base", "laser", 1.101, 0.2);
  move("base", "laser", 1.15, 0.3);
  EXPECT_EQ(statusAt("base", "laser", 1.05), Status::kGap);
  EXPECT_EQ(statusAt("base", "laser", 1.0), Status::kFound);
  EXPECT_EQ(statusAt("base", "laser", 1.101), Status::kFound);
  EXPECT_EQ(statusAt("base", "laser", 1.12), Status::kFound);
}

TEST_F(TransformHistoryTest, AfterTheNewestStampItIsNotYetKnown) {
  EXPECT_EQ(statusAt("base", "laser", 1.0), Status::kNotYet);
  move("base", "laser", 1.0, 0.0);
  EXPECT_EQ(statusAt("base", "laser", 1.001), Status::kNotYet);
}

TEST_F(TransformHistoryTest, BeforeTheOldestStampItIsNeverKnown) {
  move("base", "laser", 1.0, 0.0);
  move("base", "laser", 1.05, 0.0);
  EXPECT_EQ(statusAt("base", "laser", 0.999), Status::kNever);
}

TEST_F(TransformHistoryTest, StaticTransformsHoldAtAnyTime) {
  fix("base", "laser", 0.4);
  EXPECT_NEAR(xAt("base", "laser", 0.5), 0.4, 1e-9);
  EXPECT_NEAR(xAt("base", "laser", 1e6), 0.4, 1e-9);
}

TEST_F(TransformHistoryTest, FramesMayStartWithASlash) {
  move("/base", "/laser", 1.0, 0.1);
  EXPECT_NEAR(xAt("base", "laser", 1.0), 0.1, 1e-9);
  EXPECT_EQ(withoutSlash("//odd"), "odd");
  EXPECT_EQ(withoutSlash("plain"), "plain");
  EXPECT_EQ(withoutSlash("/"), "");
}

TEST_F(TransformHistoryTest, InAMixedChainTheMovingPartDecides) {
  fix("base", "mount", 1.0);
  move("mount", "tilt", 1.0, 0.0);
  move("mount", "tilt", 1.05, 0.1);
  fix("tilt", "laser", 10.0);
  EXPECT_NEAR(xAt("base", "laser", 1.025), 11.05, 1e-9);
  EXPECT_EQ(statusAt("base", "laser", 1.1), Status::kNotYet);
  EXPECT_NEAR(xAt("base", "mount", 1.1), 1.0, 1e-9);
}

TEST_F(TransformHistoryTest, TheSlowestPartOfAChainDecides) {
  for (int i = 0; i <= 20; ++i) move("odom", "base", 1.0 + 0.05 * i, 0.0);
  move("base", "laser", 1.0, 0.0);
  move("base", "laser", 1.5, 0.0);
  EXPECT_EQ(statusAt("odom", "laser", 1.2), Status::kGap);
  EXPECT_EQ(statusAt("odom", "laser", 1.6), Status::kNotYet);
}

TEST_F(TransformHistoryTest, WhatLiesAboveACommonAncestorTakesNoPart) {
  move("odom", "base", 1.0, 0.0);  // never heard of again
  for (const char* const child : {"arm", "laser"}) {
    move("base", child, 2.0, child[0] == 'a' ? 0.5 : 0.2);
    move("base", child, 2.05, child[0] == 'a' ? 0.5 : 0.2);
  }
  EXPECT_NEAR(xAt("arm", "laser", 2.02), -0.3, 1e-9);
  EXPECT_EQ(statusAt("odom", "laser", 2.02), Status::kNotYet);
}

TEST_F(TransformHistoryTest, FramesThatAreNotConnectedAreNotFound) {
  fix("base", "laser", 0.4);
  fix("elsewhere", "camera", 0.1);
  EXPECT_NE(statusAt("base", "camera", 1.0), Status::kFound);
  EXPECT_NE(statusAt("nowhere", "laser", 1.0), Status::kFound);
  EXPECT_FALSE(history_.newest("base", "camera"));
}

TEST_F(TransformHistoryTest, StampsThatJumpBackByMoreThanASecondForgetWhatMoves) {
  fix("tilt", "laser", 0.5);
  move("base", "tilt", 100.0, 0.1);
  move("base", "tilt", 100.05, 0.1);
  move("base", "tilt", 1.0, 0.2);
  EXPECT_EQ(statusAt("base", "tilt", 100.02), Status::kNotYet);
  EXPECT_NEAR(xAt("base", "laser", 1.0), 0.7, 1e-9);
}

TEST_F(TransformHistoryTest, AMessageThatIsALittleLateIsPutInItsPlace) {
  move("base", "laser", 1.0, 0.0);
  move("base", "laser", 1.15, 0.3);
  EXPECT_EQ(statusAt("base", "laser", 1.05), Status::kGap);
  move("base", "laser", 1.075, 0.1);
  EXPECT_EQ(statusAt("base", "laser", 1.05), Status::kFound);
  EXPECT_EQ(statusAt("base", "laser", 1.1), Status::kFound);
}

TEST_F(TransformHistoryTest, TheSameStampTwiceIsOneSample) {
  move("base", "laser", 1.0, 0.0);
  move("base", "laser", 1.0, 0.0);
  move("base", "laser", 1.05, 0.1);
  EXPECT_NEAR(xAt("base", "laser", 1.025), 0.05, 1e-9);
}

TEST_F(TransformHistoryTest, TransformsThatAreNotFiniteArePassedOver) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  move("base", "laser", 1.0, 0.0);
  move("base", "laser", 1.05, nan);
  EXPECT_EQ(statusAt("base", "laser", 1.02), Status::kNotYet);
  auto turned = shift("base", "laser", 1.05, 0.0);
  turned.transforms.front().transform.rotation.z = nan;
  history_.add(turned, false);
  turned.transforms.front().transform.rotation = geometry_msgs::Quaternion();  // of length 0
  history_.add(turned, false);
  EXPECT_EQ(statusAt("base", "laser", 1.02), Status::kNotYet);
}

TEST_F(TransformHistoryTest, AFrameWithoutANameOrItsOwnParentIsPassedOver) {
  move("base", "", 1.0, 0.0);
  move("", "laser", 1.0, 0.0);
  move("laser", "laser", 1.0, 0.0);
  EXPECT_NE(statusAt("base", "laser", 1.0), Status::kFound);
}

TEST_F(TransformHistoryTest, AFrameMayChangeItsParent) {
  move("base", "tool", 1.0, 0.1);
  move("base", "tool", 1.05, 0.1);
  fix("base", "hand", 1.0);
  move("hand", "tool", 1.1, 0.2);
  move("hand", "tool", 1.15, 0.2);
  EXPECT_NEAR(xAt("base", "tool", 1.12), 1.2, 1e-9);
}

TEST_F(TransformHistoryTest, NothingIsInterpolatedFromOneParentToAnother) {
  move("base", "tool", 1.0, 0.1);
  fix("base", "hand", 1.0);
  move("hand", "tool", 1.05, 0.2);
  EXPECT_NE(statusAt("base", "tool", 1.025), Status::kFound);
}

TEST_F(TransformHistoryTest, APathHoldsBothEndsAndStepsNoLongerThanAsked) {
  for (int i = 0; i <= 10; ++i) move("base", "laser", 1.0 + 0.02 * i, 0.1 * i);
  PosePath path;
  ASSERT_EQ(history_.path("base", "laser", at(1.01), at(1.05), fromSeconds(0.004), path),
            Status::kFound);
  EXPECT_TRUE(path.covers(at(1.01), at(1.05)));
  EXPECT_FALSE(path.at(at(1.051)));
  EXPECT_NEAR(path.at(at(1.034))->translation().x(), 0.17, 1e-9);
}

TEST_F(TransformHistoryTest, APathOfOneInstantIsOnePose) {
  fix("base", "laser", 0.4);
  PosePath path;
  ASSERT_EQ(history_.path("base", "laser", at(2.0), at(2.0), fromSeconds(0.004), path),
            Status::kFound);
  ASSERT_TRUE(path.at(at(2.0)));
  EXPECT_TRUE(
      test::isNearly(Vector3(path.at(at(2.0))->translation()), Vector3(0.4, 0.0, 0.0), 1e-9));
}

TEST_F(TransformHistoryTest, APathThatCannotBeWholeIsEmpty) {
  move("base", "laser", 1.0, 0.0);
  move("base", "laser", 1.05, 0.0);
  PosePath path;
  EXPECT_EQ(history_.path("base", "laser", at(1.01), at(1.06), fromSeconds(0.004), path),
            Status::kNotYet);
  EXPECT_FALSE(path.at(at(1.01)));
  EXPECT_EQ(history_.path("base", "laser", at(0.9), at(1.01), fromSeconds(0.004), path),
            Status::kNever);
  EXPECT_FALSE(path.at(at(1.0)));
}

TEST_F(TransformHistoryTest, TheNewestPoseSaysItsStampAndWhetherItMoves) {
  EXPECT_FALSE(history_.newest("odom", "base"));
  move("odom", "base", 1.0, 0.1);
  move("odom", "base", 1.05, 0.2);
  const auto moving = history_.newest("odom", "base");
  ASSERT_TRUE(moving);
  EXPECT_EQ(moving->stamp, at(1.05));
  EXPECT_FALSE(moving->is_static);
  EXPECT_NEAR(moving->pose.translation().x(), 0.2, 1e-9);
  fix("world", "odom", 1.0);
  EXPECT_TRUE(history_.newest("world", "odom")->is_static);
  EXPECT_FALSE(history_.newest("world", "base")->is_static);
  EXPECT_TRUE(history_.newest("base", "base")->is_static);
}

TEST_F(TransformHistoryTest, WhatComesOfHugeNumbersIsNoPose) {
  for (const double x : {0.9 * std::numeric_limits<double>::max(), HUGE_VAL}) {
    history_.clear();
    for (const double stamp : {1.0, 1.05}) {
      move("map", "base", stamp, x);
      move("base", "laser", stamp, x);
    }
    EXPECT_NE(statusAt("map", "laser", 1.02), Status::kFound) << x;
    EXPECT_FALSE(history_.newest("map", "laser")) << x;
    PosePath path;
    EXPECT_NE(history_.path("map", "laser", at(1.0), at(1.05), fromSeconds(0.01), path),
              Status::kFound);
  }
}

/// Catches what tf2 prints.
class PrintedLines : public console_bridge::OutputHandler {
 public:
  PrintedLines() { console_bridge::useOutputHandler(this); }
  PrintedLines(const PrintedLines&) = delete;
  PrintedLines& operator=(const PrintedLines&) = delete;
  ~PrintedLines() override { console_bridge::restorePreviousOutputHandler(); }
  void log(const std::string& text, console_bridge::LogLevel /*level*/, const char* /*file*/,
           int /*line*/) override {
    last_ = text;
  }
  [[nodiscard]] const std::string& last() const { return last_; }

 private:
  std::string last_;
};

TEST_F(TransformHistoryTest, WhatIsNoTransformIsRefusedAndNamedWithoutALineForEach) {
  const PrintedLines printed;
  const auto change = [](const std::function<void(geometry_msgs::TransformStamped&)>& how) {
    auto message = shift("base", "laser", 1.1, 9.0);
    how(message.transforms.front());
    return message;
  };
  const std::vector<std::pair<tf2_msgs::TFMessage, std::string>> refused = {
      {change([](auto& t) { t.transform.translation.y = std::nan(""); }), "translation"},
      {change([](auto& t) { t.transform.translation.z = -HUGE_VAL; }), "translation"},
      {change([](auto& t) { t.transform.rotation.w = 2.0; }), "of laser: its quaternion"},
      {change([](auto& t) { t.transform.rotation.w = 0.0; }), "quaternion"},
      {change([](auto& t) { t.transform.rotation.x = std::nan(""); }), "quaternion"},
      {change([](auto& t) { t.header.frame_id = ""; }), "no frame"},
      {change([](auto& t) { t.child_frame_id = "/"; }), "no frame"},
      {change([](auto& t) { t.header.frame_id = "laser"; }), "its own parent"}};
  move("base", "laser", 1.05, 0.1);
  std::size_t count = 0;
  for (const auto& [message, why] : refused) {
    history_.add(message, false);
    EXPECT_EQ(statusAt("base", "laser", 1.1), Status::kNotYet) << why;
    EXPECT_NE(history_.defect().find(why), std::string::npos) << history_.defect();
    EXPECT_EQ(history_.defect().find(std::to_string(++count) + " transforms"), 0u);
  }
  move("base", "laser", 1.1, 0.2);
  EXPECT_NEAR(xAt("base", "laser", 1.1), 0.2, 1e-9);
  EXPECT_EQ(printed.last(), "");
}

TEST_F(TransformHistoryTest, OfSeveralOfOneStampTheFirstHoldsWithoutALineForEach) {
  const PrintedLines printed;
  for (const double stamp : {1.0, 1.05, 1.05, 1.0}) move("base", "laser", stamp, stamp);
  for (const double stamp : {1.05, 1.0}) move("base", "laser", stamp, 9.0);
  EXPECT_NEAR(xAt("base", "laser", 1.0), 1.0, 1e-9);
  EXPECT_NEAR(xAt("base", "laser", 1.05), 1.05, 1e-9);
  EXPECT_EQ(printed.last(), "");
}

TEST_F(TransformHistoryTest, WhatIsOlderThanKeptIsForgotten) {
  for (int i = 0; i <= 300; ++i) move("base", "laser", 1.0 + 0.05 * i, 0.0);
  EXPECT_EQ(statusAt("base", "laser", 2.0), Status::kNever);
  EXPECT_EQ(statusAt("base", "laser", 15.0), Status::kFound);
}

TEST_F(TransformHistoryTest, EveryStatusHasAReasonToDropAScan) {
  EXPECT_STREQ(TransformHistory::name(Status::kNever), "no_transform");
  EXPECT_STREQ(TransformHistory::name(Status::kNotYet), "no_transform");
  EXPECT_STREQ(TransformHistory::name(Status::kGap), "transform_gap");
}

TEST_F(TransformHistoryTest, EverNewNamesArePassedOverAndThoseKnownBeforeGoOn) {
  fix("base", "arm", 0.3);
  move("arm", "laser", 1.0, 0.0);
  EXPECT_EQ(history_.defect(), "");
  for (int i = 0; i < 3000; ++i) {
    move("nobody" + std::to_string(i), "new" + std::to_string(i), 1.0, 1.0);
  }
  EXPECT_NE(history_.defect().find("more than 2000 frame names"), std::string::npos)
      << history_.defect();
  move("arm", "laser", 1.1, 0.2);
  EXPECT_NEAR(xAt("base", "laser", 1.05), 0.4, 1e-9);
  EXPECT_EQ(statusAt("nobody10", "new10", 1.0), Status::kFound);
  EXPECT_EQ(statusAt("nobody2900", "new2900", 1.0), Status::kNotYet);
}

TEST_F(TransformHistoryTest, AFrameThatMovesAfterAllIsInterpolated) {
  fix("odom", "base", 5.0);
  fix("base", "mount", 0.25);
  for (int i = 0; i <= 10; ++i) move("odom", "base", 1.0 + 0.05 * i, 0.1 * i);
  EXPECT_NEAR(xAt("odom", "base", 1.225), 0.45, 1e-9);
  EXPECT_NEAR(xAt("odom", "mount", 1.225), 0.7, 1e-9) << "what else is static stays";
  const auto newest = history_.newest("odom", "base");
  ASSERT_TRUE(newest);
  EXPECT_EQ(newest->stamp, at(1.5));
  EXPECT_FALSE(newest->is_static);
  EXPECT_NE(history_.defect().find("base was heard of both on /tf and on /tf_static"),
            std::string::npos)
      << history_.defect();
}

TEST_F(TransformHistoryTest, AFrameThatIsStaticAfterAllIsKnownAtAnyTime) {
  for (int i = 0; i <= 10; ++i) move("odom", "base", 1.0 + 0.05 * i, 0.1 * i);
  fix("odom", "base", 5.0);
  EXPECT_NEAR(xAt("odom", "base", 100.0), 5.0, 1e-9);
  const auto newest = history_.newest("odom", "base");
  ASSERT_TRUE(newest && newest->is_static);
}

TEST_F(TransformHistoryTest, WhatWasSaidOfTimesToComeIsForgottenWhereTheClockStepsBack) {
  fix("base", "mount", 0.25);
  history_.setNow(at(1.5));
  for (int i = 0; i <= 10; ++i) move("odom", "base", 1.0 + 0.05 * i, 0.1 * i);
  history_.setNow(at(1.45));
  EXPECT_EQ(statusAt("odom", "mount", 1.3), Status::kFound) << "a clock is set by less";
  history_.setNow(at(1.2));
  EXPECT_NE(statusAt("odom", "mount", 1.3), Status::kFound);
  EXPECT_NEAR(xAt("base", "mount", 1.3), 0.25, 1e-9);
}

}  // namespace
}  // namespace tccm
