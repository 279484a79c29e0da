/// What no healthy robot publishes of its joints is said, and what a sloppy one does is not.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "robot/joint_states.h"
#include "support/random.h"
#include "support/tiny_robot.h"

namespace tccm {
namespace {

using namespace test;

constexpr int kMembers = 40;  // of each kind
constexpr double kPeriod = 0.01;

Time at(double seconds) { return Time(fromSeconds(seconds)); }

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Two joints that turn at most at 2 rad/s and one that slides; "finger" mimics that.
std::shared_ptr<const RobotModel> armModel() {
  const std::string limits = "<limit lower=\"-3\" upper=\"3\" effort=\"1\" velocity=\"2\"/>";
  const std::string grip = "<limit lower=\"0\" upper=\"0.08\" effort=\"1\" velocity=\"0.2\"/>";
  return modelOf(
      robotOf(linkOf("base") + ballLink("upper") + ballLink("lower") + ballLink("left") +
              ballLink("right") +
              jointOf("shoulder", "revolute", "base", "upper", axisOf("0 0 1") + limits) +
              jointOf("elbow", "revolute", "upper", "lower", axisOf("0 1 0") + limits) +
              jointOf("grip", "prismatic", "lower", "left", axisOf("0 1 0") + grip) +
              jointOf("finger", "prismatic", "lower", "right",
                      axisOf("0 1 0") + grip + "<mimic joint=\"grip\" multiplier=\"1\"/>")));
}

/// How one joint swings.
struct Swing {
  double middle, amplitude, rate;
  explicit Swing(Random& random)
      : middle(random.uniform(-2.0, 2.0)),
        amplitude(random.uniform(0.0, 0.5)),
        rate(random.uniform(0.5, 3.0)) {}
  [[nodiscard]] double at(double t) const { return middle + amplitude * std::sin(rate * t); }
  [[nodiscard]] double speed(double t) const { return amplitude * rate * std::cos(rate * t); }
};

class JointDoubtsTest : public ::testing::Test {
 protected:
  void remake() { joints_ = std::make_unique<JointStates>(*model_, JointStates::Config{}); }
  JointStates::Added add(double stamp, const std::vector<std::string>& names,
                         const std::vector<double>& positions,
                         const std::vector<double>& velocities = {},
                         const std::string& publisher = {}) {
    return joints_->add(at(stamp), names, positions, velocities, publisher);
  }
  /// Everything at rest.
  void addAll(double stamp, double shoulder = 0.0, double grip = 0.04) {
    add(stamp, {"shoulder", "elbow", "grip"}, {shoulder, 0.0, grip});
  }
  [[nodiscard]] bool isDoubted() const {
    return !joints_->twoPositions().empty() || !joints_->outOfRange().empty();
  }
  [[nodiscard]] std::string doubts() const {
    return joints_->twoPositions() + joints_->outOfRange();
  }

  std::shared_ptr<const RobotModel> model_ = armModel();
  std::unique_ptr<JointStates> joints_ =
      std::make_unique<JointStates>(*model_, JointStates::Config{});
};

TEST_F(JointDoubtsTest, AJointThatIsTwiceInAMessageAtTwoPlacesIsSaid) {
  Random random(1);
  for (int i = 0; i < kMembers; ++i) {
    remake();
    const double one = random.uniform(-2.9, 2.9);
    const double off = random.uniform(0.02, i % 2 == 0 ? 1.0 : 0.04) * (one > 0.0 ? -1.0 : 1.0);
    add(1.0, {"elbow", "shoulder", "shoulder"}, {0.0, one, one + off}, {0.0, 1.9, 1.9});
    EXPECT_TRUE(has(joints_->twoPositions(), "joint 'shoulder' is at ")) << one << " " << off;
    std::vector<double> positions;
    EXPECT_FALSE(joints_->at(at(1.0), positions)) << "which is right is not known";
    remake();
    add(1.0, {"elbow", "shoulder", "shoulder"}, {0.0, one, one + random.uniform(-0.005, 0.005)});
    EXPECT_FALSE(isDoubted()) << "rounded";
  }
}

TEST_F(JointDoubtsTest, TwoThatPublishAJointWithOneStampAreNamed) {
  Random random(2);
  for (int i = 0; i < kMembers; ++i) {
    remake();
    const Swing swing(random);
    const bool zero_first = random.chance(0.5);
    for (double t = 0.0; t < 1.0; t += kPeriod) {
      const std::vector<double> zeros{0.0}, real{swing.at(t)};
      add(t, {"shoulder"}, zero_first ? zeros : real, {}, zero_first ? "/idle" : "/driver");
      add(t, {"shoulder"}, zero_first ? real : zeros, {}, zero_first ? "/driver" : "/idle");
    }
    if (std::abs(swing.middle) - swing.amplitude < 0.1) continue;  // they are one place at times
    EXPECT_TRUE(has(joints_->twoPositions(), "/idle")) << swing.middle << " " << swing.amplitude;
    EXPECT_TRUE(has(joints_->twoPositions(), "/driver")) << joints_->twoPositions();
    EXPECT_TRUE(has(joints_->twoPositions(), "at 0 rad by /idle")) << joints_->twoPositions();
  }
}

TEST_F(JointDoubtsTest, TwoHistoriesThatNoPermittedSpeedJoinsAreSaidWhateverTheirStampsAndRates) {
  Random random(3);
  for (int i = 0; i < kMembers; ++i) {
    remake();
    const Swing swing(random);
    const double parked =
        swing.middle + (swing.middle > 0.0 ? -1.0 : 1.0) * random.uniform(0.7, 1.5);
    const double period = random.uniform(0.005, 0.05);
    double next = random.uniform(0.0, period);
    for (double t = 0.0; t < 2.0; t += kPeriod) {
      for (; next < t; next += period) add(next, {"shoulder"}, {parked}, {0.0}, "/second");
      add(t + 1e-4, {"shoulder"}, {swing.at(t)}, {swing.speed(t)}, "/driver");
    }
    EXPECT_TRUE(has(joints_->twoPositions(), "joint 'shoulder' is at ")) << i << ": " << period;
  }
}

TEST_F(JointDoubtsTest, APublisherWhoseMessagesComeLateIsComparedWithWhatWasThen) {
  Random random(4);
  for (int i = 0; i < kMembers; ++i) {
    remake();
    const Swing swing(random);
    const double parked = swing.middle + (swing.middle > 0.0 ? -1.2 : 1.2);
    for (double t = 0.05; t < 1.0; t += kPeriod) {
      add(t, {"shoulder"}, {swing.at(t)});
      add(t - random.uniform(0.012, 0.03), {"shoulder"}, {parked});
    }
    EXPECT_FALSE(joints_->twoPositions().empty()) << i;
  }
}

TEST_F(JointDoubtsTest, WhoRelaysWhatAnotherPublishesIsNoSecondHistory) {
  Random random(5);
  for (int i = 0; i < 4 * kMembers; ++i) {
    remake();
    const Swing swing(random);
    const double lag = random.uniform(0.0, 0.1), period = random.uniform(0.01, 0.1);
    const bool keeps_stamps = random.chance(0.3), with_velocities = random.chance(0.5);
    double next = random.uniform(0.1, 0.1 + period);
    for (double t = 0.0; t < 2.0; t += kPeriod) {
      const std::vector<double> none;
      add(t, {"shoulder"}, {swing.at(t)}, with_velocities ? std::vector{swing.speed(t)} : none,
          "/driver");
      if (next > t) continue;
      const double then = std::max(0.0, kPeriod * std::floor((t - lag) / kPeriod));
      const double rounded = 1e-4 * std::round(1e4 * swing.at(then));
      add(keeps_stamps ? std::max(then, t - 0.09) : t + 0.5 * kPeriod, {"shoulder"},
          {keeps_stamps && then < t - 0.09 ? swing.at(t - 0.09) : rounded},
          with_velocities ? std::vector{swing.speed(then)} : none, "/joint_state_publisher");
      next += period;
    }
    EXPECT_FALSE(isDoubted()) << i << ": " << doubts() << " lag " << lag << " period " << period;
  }
}

TEST_F(JointDoubtsTest,
       PartsOfARobotThatArePublishedApartRoundedAndWithStampsThatJitterAreHealthy) {
  Random random(6);
  for (int i = 0; i < kMembers; ++i) {
    remake();
    const Swing shoulder(random), elbow(random);
    const double step = random.chance(0.5) ? 1e-3 : 0.00175;  // a tenth of a degree
    double last = -1.0;
    for (double t = 0.0; t < 2.0; t += kPeriod) {
      const double stamp = std::max(last + 1e-4, t + random.uniform(-0.004, 0.004));
      last = stamp;
      add(stamp, {"shoulder", "elbow"},
          {step * std::round(shoulder.at(t) / step), step * std::round(elbow.at(t) / step)}, {},
          "/arm");
      const double grip = 0.04 + 0.03 * std::sin(t);
      add(t + 0.003, {"grip", "finger"}, {grip, grip + random.uniform(-0.001, 0.001)}, {},
          "/gripper");
    }
    EXPECT_FALSE(isDoubted()) << i << ": " << doubts();
  }
}

TEST_F(JointDoubtsTest, FarBeyondALimitIsNotTakenAndALittleBeyondIsAsItIs) {
  Random random(7);
  for (int i = 0; i < kMembers; ++i) {
    remake();
    const double sign = random.chance(0.5) ? 1.0 : -1.0;
    addAll(0.9);
    const double far = sign * std::pow(10.0, random.uniform(0.6, 12.0));
    EXPECT_EQ(add(1.0, {"shoulder"}, {far}).refused, 1U);
    EXPECT_TRUE(has(joints_->outOfRange(), "joint 'shoulder' is published at ")) << far;
    EXPECT_TRUE(has(joints_->outOfRange(), "degrees?")) << far;
    remake();
    const double little = sign * (3.0 + random.uniform(0.002, 0.55));
    addAll(1.0, little);
    EXPECT_FALSE(isDoubted()) << little << ": " << doubts();
    ASSERT_NE(joints_->latest(), nullptr);
    EXPECT_EQ(joints_->latest()->positions[0], little);
    EXPECT_TRUE(has(joints_->limitDefect(), "joint 'shoulder' is at ")) << little;
    EXPECT_EQ(joints_->latest()->beyond_upper[0], sign > 0.0);
    EXPECT_EQ(joints_->latest()->beyond_lower[0], sign < 0.0);
  }
}

TEST_F(JointDoubtsTest, WhatDriversRoundToAtALimitLeavesTheLimitAsItIs) {
  Random random(8);
  for (int i = 0; i < kMembers; ++i) {
    remake();
    addAll(1.0, 3.0 + random.uniform(0.0, 9e-4), -random.uniform(0.0, 9e-4));
    EXPECT_EQ(joints_->limitDefect() + doubts(), "");
    EXPECT_FALSE(joints_->latest()->beyond_upper[0]);
  }
}

TEST_F(JointDoubtsTest, AGripInMillimetresIsAskedAfter) {
  addAll(1.0, 0.0, 40.0);
  EXPECT_EQ(joints_->outOfRange(),
            "joint 'grip' is published at 40 m, its limits are 0 and 0.08 m: are these "
            "millimetres?");
}

TEST_F(JointDoubtsTest, ASpeedFiveTimesAboveTheLimitIsSaidAndBoundedWhateverItsSize) {
  Random random(9);
  for (int i = 0; i < kMembers; ++i) {
    remake();
    const double speed =
        10.0 * std::pow(10.0, random.uniform(0.01, 300.0)) * (random.chance(0.5) ? 1.0 : -1.0);
    addAll(0.99);
    add(1.0, {"shoulder"}, {0.0}, {speed});
    EXPECT_TRUE(has(joints_->outOfRange(), "joint 'shoulder' is said to move at ")) << speed;
    EXPECT_LE(std::abs(joints_->latest()->velocities[0]), 10.0);
    remake();
    addAll(0.99);
    add(1.0, {"shoulder"}, {0.0}, {random.uniform(-9.9, 9.9)});
    EXPECT_FALSE(isDoubted()) << doubts();
  }
}

TEST_F(JointDoubtsTest, PositionsThatChangeFasterThanIsBelievedAreSaidAndOneJumpIsNot) {
  for (double t = 0.0; t < 0.3; t += kPeriod) addAll(t, t < 0.15 ? 0.0 : 0.8);
  EXPECT_FALSE(isDoubted()) << doubts();
  remake();
  for (double t = 0.0; t < 0.3; t += kPeriod) addAll(t, -2.0 + 12.0 * t);
  EXPECT_TRUE(has(joints_->outOfRange(), "joint 'shoulder' changes its position by 12 rad/s"))
      << joints_->outOfRange();
}

TEST_F(JointDoubtsTest, AMimicThatContradictsItsRuleIsSaidWithBothValues) {
  Random random(10);
  for (int i = 0; i < kMembers; ++i) {
    remake();
    const double grip = random.uniform(0.0, 0.08);
    const double finger =
        grip > 0.04 ? grip - random.uniform(0.02, 0.04) : grip + random.uniform(0.02, 0.04);
    add(1.0, {"grip", "finger"}, {grip, finger});
    EXPECT_TRUE(has(joints_->twoPositions(), "joint 'finger' is published at ")) << grip;
    EXPECT_TRUE(has(joints_->twoPositions(), "mimic of 'grip'")) << grip;
    remake();
    add(1.0, {"grip", "finger"}, {grip, grip + random.uniform(-0.004, 0.004)});
    EXPECT_FALSE(isDoubted()) << doubts();
  }
}

TEST_F(JointDoubtsTest, ADoubtIsForgottenTwoSecondsAfterItsCause) {
  addAll(1.0);
  add(1.0, {"shoulder"}, {1.0});
  ASSERT_TRUE(isDoubted());
  for (double t = 1.0; t < 2.95; t += 0.05) addAll(t + 0.05);
  EXPECT_TRUE(isDoubted());
  addAll(3.05);
  EXPECT_FALSE(isDoubted());
  std::vector<double> positions;
  EXPECT_TRUE(joints_->at(at(3.05), positions));
}

TEST_F(JointDoubtsTest, WhatIsWrongInAMessageIsSaidAlsoWhereTimeBeginsAnewWithIt) {
  for (const double wrong : {90.0, 1.0}) {
    // That the elbow's time begins anew shows after the shoulder was twice, or far beyond its
    // limit.
    remake();
    add(1.0, {"elbow"}, {0.0});
    add(10.0, {"elbow"}, {0.0});
    add(2.0, {"shoulder", "shoulder", "elbow"}, {0.0, wrong, 0.0});
    EXPECT_TRUE(isDoubted()) << wrong;
  }
}

TEST_F(JointDoubtsTest, WhereReportedAndDifferentiatedVelocitiesDifferInDirectionBothAreGiven) {
  Random random(12);
  for (int i = 0; i < kMembers; ++i) {
    remake();
    const double speed = random.uniform(0.05, 1.5), said = -random.uniform(0.05, 1.5);
    for (double t = 0.0; t < 0.2; t += kPeriod) {
      add(t, {"shoulder", "elbow", "grip"}, {speed * t, 0.5 * t, 0.04}, {said, 0.5, 0.0});
    }
    const JointSnapshot* joints = joints_->latest();
    ASSERT_EQ(joints->contrary_velocities.size(), 3U);
    EXPECT_NEAR(std::min(joints->velocities[0], joints->contrary_velocities[0]), said, 1e-6);
    EXPECT_NEAR(std::max(joints->velocities[0], joints->contrary_velocities[0]), speed, 1e-6);
    EXPECT_EQ(joints->velocities[1], joints->contrary_velocities[1]);
  }
}

TEST_F(JointDoubtsTest, NoiseAtRestHasNoDirection) {
  Random random(13);
  for (int i = 0; i < 200; ++i) {
    add(kPeriod * i, {"shoulder", "elbow", "grip"}, {random.uniform(-2e-4, 2e-4), 0.0, 0.0},
        {random.uniform(-0.1, 0.1), 0.0, 0.0});
    ASSERT_TRUE(joints_->latest()->contrary_velocities.empty());
  }
}

/// @param multiplier of a link's mimic of a motor that turns without limits.
std::shared_ptr<const RobotModel> gearedModel(const std::string& multiplier) {
  return modelOf(
      robotOf(linkOf("base") + linkOf("rotor") + ballLink("arm") +
              jointOf("motor", "continuous", "base", "rotor", axisOf("0 0 1")) +
              jointOf("shoulder", "revolute", "base", "arm",
                      axisOf("0 0 1") + limitOf("-3", "3") +
                          "<mimic joint=\"motor\" multiplier=\"" + multiplier + "\"/>")));
}

TEST(GearedJointDoubtsTest, IsTheSameAfterAWholeTurnOnlyWhereItsMimicsAre) {
  Random random(14);
  for (int i = 0; i < kMembers; ++i) {
    EXPECT_TRUE(gearedModel(std::to_string(random.integer(-5, 5)))->turnsFreely(0));
    EXPECT_FALSE(gearedModel(std::to_string(random.uniform(0.001, 0.999)))->turnsFreely(0));
  }
}

TEST(GearedJointDoubtsTest, AMimicOfAFreeMotorIsNotFollowedTheShortWay) {
  JointStates joints(*gearedModel("0.01"), {});
  for (int i = 0; i <= 20; ++i) joints.add(at(0.01 * i), {"motor"}, {0.5 * i}, {});
  EXPECT_NEAR(joints.latest()->velocities[0], 50.0, 1e-6);
  EXPECT_EQ(joints.latest()->positions[0], 10.0);
}

}  // namespace
}  // namespace tccm
