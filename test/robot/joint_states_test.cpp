#include "robot/joint_states.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/random.h"
#include "support/tiny_robot.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Time at(double seconds) { return Time(fromSeconds(seconds)); }

/// The joints "slide" and "glide", in an order that add() need not keep.
class JointStatesTest : public ::testing::Test {
 protected:
  JointStates::Added add(double stamp, const std::vector<std::string>& names,
                         const std::vector<double>& positions,
                         const std::vector<double>& velocities = {}) {
    return joints_.add(at(stamp), names, positions, velocities);
  }
  JointStates::Added addBoth(double stamp, double slide, double glide) {
    return add(stamp, {"slide", "glide"}, {slide, glide});
  }
  [[nodiscard]] std::size_t indexOf(const std::string& name) const {
    return model_->variables()[0].name == name ? 0 : 1;
  }
  double positionNow(const std::string& name) { return joints_.latest()->positions[indexOf(name)]; }
  double velocityNow(const std::string& name) {
    return joints_.latest()->velocities[indexOf(name)];
  }
  /// NaN where there is no answer.
  double slideAt(double stamp) {
    std::vector<double> positions;
    return joints_.at(at(stamp), positions) ? positions[indexOf("slide")] : kNaN;
  }

  std::shared_ptr<const RobotModel> model_ = test::sliderModel();
  JointStates joints_{*model_, JointStates::Config{}};
};

TEST_F(JointStatesTest, NothingIsKnownAtTheStart) {
  EXPECT_EQ(joints_.latest(), nullptr);
  EXPECT_FALSE(joints_.missingJoints().empty());
  EXPECT_FALSE(joints_.answersUntil());
  EXPECT_TRUE(std::isnan(slideAt(0.0)));
}

TEST_F(JointStatesTest, PartialMessagesMakeAWholeOnceEveryJointWasHeardOf) {
  EXPECT_EQ(add(1.0, {"slide"}, {0.1}).taken, 1U);
  EXPECT_EQ(joints_.missingJoints(), std::vector<std::string>{"glide"});
  EXPECT_EQ(joints_.latest(), nullptr);
  EXPECT_FALSE(joints_.answersUntil());
  add(1.5, {"glide"}, {0.2});
  EXPECT_TRUE(joints_.missingJoints().empty());
  ASSERT_NE(joints_.latest(), nullptr);
  EXPECT_EQ(positionNow("slide"), 0.1);
  EXPECT_EQ(positionNow("glide"), 0.2);
  EXPECT_EQ(joints_.latest()->oldest, at(1.0));
  EXPECT_EQ(joints_.answersUntil(), at(1.0));
}

TEST_F(JointStatesTest, AJointThatFallsSilentSetsTheAge) {
  addBoth(1.0, 0.0, 0.0);
  add(5.0, {"slide"}, {0.3});
  EXPECT_EQ(joints_.latest()->oldest, at(1.0));
  EXPECT_EQ(positionNow("slide"), 0.3);
}

TEST_F(JointStatesTest, OtherJointsArePassedOver) {
  const auto added = add(1.0, {"wheel", "slide"}, {kNaN, 0.4});
  EXPECT_EQ(added.taken, 1U);
  EXPECT_EQ(added.refused, 0U);
}

TEST_F(JointStatesTest, PositionsThatAreNotFiniteOrNotThereAreRefused) {
  EXPECT_EQ(addBoth(1.0, kNaN, kInfinity).refused, 2U);
  EXPECT_FALSE(joints_.missingJoints().empty());
  const auto added = add(2.0, {"slide", "glide"}, {0.1});
  EXPECT_EQ(added.taken, 1U);
  EXPECT_EQ(added.refused, 1U);
  EXPECT_EQ(joints_.missingJoints(), std::vector<std::string>{"glide"});
}

TEST_F(JointStatesTest, ANaNLeavesTheLastGoodPositionAndItsAge) {
  addBoth(1.0, 0.1, 0.2);
  addBoth(1.1, kNaN, 0.3);
  EXPECT_EQ(positionNow("slide"), 0.1);
  EXPECT_EQ(joints_.latest()->oldest, at(1.0));
}

TEST_F(JointStatesTest, EqualAndBackwardStampsAreRefused) {
  addBoth(1.0, 0.1, 0.1);
  EXPECT_EQ(addBoth(1.0, 0.2, 0.2).refused, 2U);
  EXPECT_EQ(addBoth(0.9, 0.3, 0.3).refused, 2U);
  EXPECT_EQ(positionNow("slide"), 0.1);
  EXPECT_EQ(addBoth(1.01, 0.4, 0.4).taken, 2U);
}

TEST_F(JointStatesTest, AJointNamedTwiceInAMessageCountsOnce) {
  const auto added = add(1.0, {"slide", "slide"}, {0.1, 0.2});
  EXPECT_EQ(added.taken, 1U);
  EXPECT_EQ(added.refused, 1U);
}

TEST_F(JointStatesTest, PositionsAreDifferentiatedWhereVelocitiesAreMissing) {
  for (int i = 0; i <= 10; ++i) addBoth(1.0 + 0.01 * i, 0.02 * i, -0.01 * i);
  EXPECT_NEAR(velocityNow("slide"), 2.0, 1e-9);
  EXPECT_NEAR(velocityNow("glide"), -1.0, 1e-9);
}

TEST_F(JointStatesTest, AVelocityOfZeroDoesNotHideThatPositionsChange) {
  for (int i = 0; i <= 10; ++i) add(1.0 + 0.01 * i, {"slide", "glide"}, {0.02 * i, 0.0}, {0, 0});
  EXPECT_NEAR(velocityNow("slide"), 2.0, 1e-9);
  EXPECT_EQ(velocityNow("glide"), 0.0);
}

TEST_F(JointStatesTest, AReportedVelocityCountsWherePositionsStandStill) {
  for (int i = 0; i <= 10; ++i) add(1.0 + 0.01 * i, {"slide", "glide"}, {0.1, 0.1}, {-0.7, kNaN});
  EXPECT_EQ(velocityNow("slide"), -0.7);
  EXPECT_EQ(velocityNow("glide"), 0.0);
}

TEST_F(JointStatesTest, OneSampleHasTheReportedVelocityOrNone) {
  add(1.0, {"slide", "glide"}, {0.1, 0.1}, {0.5});
  EXPECT_EQ(velocityNow("slide"), 0.5);
  EXPECT_EQ(velocityNow("glide"), 0.0);
}

TEST_F(JointStatesTest, AnInfiniteReportedVelocityIsNotTaken) {
  add(1.0, {"slide", "glide"}, {0.1, 0.1}, {kInfinity, 0.1});
  EXPECT_EQ(velocityNow("slide"), 0.0);
}

TEST_F(JointStatesTest, DifferentiationSpansTheBaselineNotAStepOfTheEncoder) {
  for (int i = 0; i <= 100; ++i) addBoth(1.0 + 0.001 * i, i == 100 ? 0.001 : 0.0, 0.0);
  EXPECT_NEAR(velocityNow("slide"), 0.001 / 0.03, 1e-3);
}

TEST_F(JointStatesTest, PositionsInBetweenAreInterpolated) {
  addBoth(1.0, 0.0, 0.0);
  addBoth(1.1, 0.5, 0.0);
  EXPECT_EQ(slideAt(1.0), 0.0);
  EXPECT_NEAR(slideAt(1.025), 0.125, 1e-12);
  EXPECT_EQ(slideAt(1.1), 0.5);
}

TEST_F(JointStatesTest, NothingIsAnsweredBeyondTheFirstAndTheLastSample) {
  addBoth(1.0, 0.0, 0.0);
  addBoth(1.1, 0.5, 0.0);
  EXPECT_TRUE(std::isnan(slideAt(0.999999999)));
  EXPECT_TRUE(std::isnan(slideAt(1.100000001)));
}

TEST_F(JointStatesTest, NothingIsInterpolatedAcrossALongGap) {
  addBoth(1.0, 0.0, 0.0);
  addBoth(1.1001, 0.5, 0.0);
  EXPECT_TRUE(std::isnan(slideAt(1.05)));
  EXPECT_EQ(slideAt(1.0), 0.0) << "a sample itself is known";
  addBoth(1.2001, 0.6, 0.0);
  EXPECT_FALSE(std::isnan(slideAt(1.15)));
}

TEST_F(JointStatesTest, OneJointWithoutSamplesAroundTheInstantIsEnoughForNoAnswer) {
  addBoth(1.0, 0.0, 0.0);
  add(1.05, {"slide"}, {0.1});
  EXPECT_TRUE(std::isnan(slideAt(1.02)));
  add(1.05, {"glide"}, {0.1});
  EXPECT_FALSE(std::isnan(slideAt(1.02)));
}

TEST_F(JointStatesTest, AnswersReachAsFarAsTheJointHeardOfLeastRecently) {
  addBoth(1.0, 0.0, 0.0);
  add(1.2, {"slide"}, {0.1});
  add(1.1, {"glide"}, {0.1});
  EXPECT_EQ(joints_.answersUntil(), at(1.1));
}

TEST_F(JointStatesTest, ResetForgetsEverythingAndTakesOlderStamps) {
  addBoth(5.0, 0.0, 0.0);
  joints_.reset();
  EXPECT_EQ(joints_.latest(), nullptr);
  EXPECT_FALSE(joints_.answersUntil());
  EXPECT_EQ(addBoth(1.0, 0.7, 0.7).taken, 2U);
  EXPECT_EQ(positionNow("slide"), 0.7);
  EXPECT_EQ(velocityNow("slide"), 0.0);
}

TEST(JointStatesRingTest, TheOldestSamplesGiveWay) {
  JointStates::Config config;
  config.samples_max = 5;
  JointStates joints(*test::sliderModel(), config);
  for (int i = 0; i < 23; ++i) {
    joints.add(at(0.01 * i), {"slide", "glide"}, {0.01 * i, 0.0}, {});
  }
  std::vector<double> positions;
  for (int i = 18; i < 23; ++i) {
    ASSERT_TRUE(joints.at(at(0.01 * i), positions)) << i;
    EXPECT_NEAR(std::max(positions[0], positions[1]), 0.01 * i, 1e-12);
  }
  EXPECT_FALSE(joints.at(at(0.175), positions));
}

TEST(JointStatesRingTest, ManySamplesAreInterpolatedAsTheyWereGiven) {
  JointStates joints(*test::sliderModel(), {});
  test::Random random(1);
  std::vector<std::pair<double, double>> given;
  double stamp = 0.0;
  for (int i = 0; i < 400; ++i) {
    stamp += random.uniform(0.002, 0.02);
    given.emplace_back(stamp, random.uniform(-0.01, 0.01));
    joints.add(at(stamp), {"slide", "glide"}, {given.back().second, given.back().second}, {});
  }
  std::vector<double> positions;
  for (std::size_t i = 0; i + 1 < given.size(); ++i) {
    const double u = random.uniform(0.0, 1.0);
    const double when = given[i].first + u * (given[i + 1].first - given[i].first);
    ASSERT_TRUE(joints.at(at(when), positions));
    EXPECT_NEAR(positions[0], given[i].second + u * (given[i + 1].second - given[i].second), 1e-5);
    EXPECT_EQ(positions[0], positions[1]);
  }
}

TEST(JointStatesRingTest, ARobotWithoutJointsIsKnownFromTheFirstMessageOn) {
  JointStates joints(*test::modelOf(test::robotOf(test::ballLink("base"))), {});
  EXPECT_EQ(joints.latest(), nullptr);
  joints.add(at(3.0), {"wheel"}, {1.0}, {});
  ASSERT_NE(joints.latest(), nullptr);
  EXPECT_EQ(joints.latest()->oldest, at(3.0));
  EXPECT_EQ(joints.answersUntil(), at(3.0));
}

TEST(JointStatesConfigTest, ValuesOutOfRangeAreRefused) {
  const auto model = test::sliderModel();
  JointStates::Config config;
  config.gap_max_s = 0.0;
  EXPECT_THROW(JointStates(*model, config), ConfigError);
  config = {};
  config.velocity_baseline_s = kNaN;
  EXPECT_THROW(JointStates(*model, config), ConfigError);
  config = {};
  config.samples_max = 1;
  EXPECT_THROW(JointStates(*model, config), ConfigError);
}

TEST(FixedJointTest, AFixedJointThatIsPublishedElsewhereLeavesThePoseUnknown) {
  RobotModel::Config config;
  config.fixed_joints["glide"] = 0.5;
  JointStates states(*test::modelOf(test::sliderUrdf(), config), {});
  std::vector<double> positions;
  const auto hear = [&](double seconds, double glide) {
    states.add(Time(fromSeconds(seconds)), {"slide", "glide"}, {0.1, glide}, {});
    return states.at(Time(fromSeconds(seconds)), positions);
  };
  EXPECT_TRUE(hear(1.0, 0.509));
  EXPECT_EQ(states.contradiction(), "");
  EXPECT_FALSE(hear(1.01, 0.6));
  EXPECT_EQ(states.contradiction(), "joint 'glide' is published at 0.600, fixed_joints says 0.500");
  EXPECT_FALSE(hear(1.02, std::numeric_limits<double>::quiet_NaN()));
  EXPECT_TRUE(hear(1.03, 0.5));
  EXPECT_EQ(states.contradiction(), "");
  // Whoever published it may be gone.
  EXPECT_FALSE(hear(2.0, 0.6));
  const auto hearOther = [&](double seconds) {
    states.add(Time(fromSeconds(seconds)), {"slide"}, {0.1}, {});
    return states.at(Time(fromSeconds(seconds)), positions);
  };
  EXPECT_FALSE(hearOther(3.9));
  EXPECT_TRUE(hearOther(4.1));
  EXPECT_EQ(states.contradiction(), "");
}

TEST_F(JointStatesTest, AVelocityThatIsMissingIsSaid) {
  joints_.add(at(1.0), {"slide", "glide"}, {0.0, 0.0}, {0.0, 0.0});
  ASSERT_NE(joints_.latest(), nullptr);
  EXPECT_EQ(joints_.velocityDefect(), "");
  joints_.add(at(1.01), {"slide", "glide"}, {0.0, 0.0}, {0.0});
  ASSERT_NE(joints_.latest(), nullptr);
  EXPECT_NE(joints_.velocityDefect().find("'glide' is published without"), std::string::npos);
}

TEST_F(JointStatesTest, AVelocityThatIsZeroWhilePositionsChangeIsSaidAndThatOfAHaltIsNot) {
  joints_.add(at(1.00), {"slide", "glide"}, {0.00, 0.0}, {1.0, 0.0});
  joints_.add(at(1.01), {"slide", "glide"}, {0.01, 0.0}, {1.0, 0.0});
  joints_.add(at(1.02), {"slide", "glide"}, {0.02, 0.0}, {0.0, 0.0});
  ASSERT_NE(joints_.latest(), nullptr);
  EXPECT_EQ(joints_.velocityDefect(), "") << "it came to rest";
  joints_.add(at(1.03), {"slide", "glide"}, {0.03, 0.0}, {0.0, 0.0});
  ASSERT_NE(joints_.latest(), nullptr);
  EXPECT_NE(joints_.velocityDefect().find("'slide' is published with velocity 0"),
            std::string::npos);
}

/// A joint that turns without limits, published within half a turn of 0.
TEST(TurningJointTest, IsFollowedTheShortWayAcrossAHalfTurn) {
  using namespace test;
  const auto model =
      modelOf(robotOf(linkOf("base") + ballLink("hand") +
                      jointOf("roll", "continuous", "base", "hand", axisOf("1 0 0"))));
  constexpr double kHalfTurn = 3.14159265358979323846;
  JointStates joints(*model, JointStates::Config{});
  for (int k = 0; k <= 10; ++k) {  // at 1 rad/s across the half turn
    const double position = std::remainder(kHalfTurn - 0.05 + 0.01 * k, 2.0 * kHalfTurn);
    joints.add(at(1.0 + 0.01 * k), {"roll"}, {position}, {});
  }
  ASSERT_NE(joints.latest(), nullptr);
  EXPECT_NEAR(joints.latest()->velocities[0], 1.0, 1e-6);
  std::vector<double> positions;
  ASSERT_TRUE(joints.at(at(1.055), positions));
  EXPECT_NEAR(std::remainder(positions[0] - (kHalfTurn + 0.005), 2.0 * kHalfTurn), 0.0, 1e-9);
}

}  // namespace
}  // namespace tccm
