#include "check/leaving.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "check/contact_judge.h"
#include "check/way_ahead.h"
#include "geometry/distance.h"
#include "support/checked_robot.h"
#include "support/cuboid_scene.h"
#include "support/random.h"
#include "support/tiny_robot.h"

namespace tccm {
namespace {

using namespace test::urdf_text;
using test::addBlock;
using test::Random;

const std::vector<Pose> kAtOrigin{Pose::Identity()};
const Shape kBall = Sphere{0.09};
const Shape kMiddle = core(kBall);

Pose atX(double x) { return Pose(Eigen::Translation3d(x, 0.0, 0.5)); }

/// Two columns, one behind the other: they begin at x = 0.80 and 0.82 m.
class LeavingTest : public ::testing::Test {
 protected:
  LeavingTest() {
    addBlock(map_, {Vector3(0.8, 0.0, 0.3), Vector3(0.84, 0.02, 0.7)});
    leaving_.begin({0, 1});
  }
  void passEscapeAt(double x) { leaving_.passEscape(map_, kBall, kMiddle, atX(x)); }
  double updateAt(double x) { return leaving_.update(map_, kMiddle, atX(x)); }

  CuboidMap map_ = test::emptyMap();
  Leaving leaving_{8};
};

TEST_F(LeavingTest, AtFirstItIsAllThatTouches) {
  ASSERT_EQ(map_.cuboids.size(), 2U);
  EXPECT_EQ(leaving_.obstacles(), (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(leaving_.followed(), 0U);
}

TEST_F(LeavingTest, ThenItIsWhatStillTouches) {
  passEscapeAt(0.72);
  EXPECT_EQ(leaving_.followed(), 1U);
  updateAt(0.72);
  EXPECT_EQ(leaving_.obstacles(), std::vector<std::uint32_t>{0});
}

TEST_F(LeavingTest, WhatWasLeftIsAheadAsAnythingElse) {
  passEscapeAt(0.70);
  EXPECT_EQ(leaving_.followed(), 0U);
  EXPECT_EQ(updateAt(0.72), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(leaving_.obstacles().empty());
}

TEST_F(LeavingTest, WhatIsGoneFurtherIntoIsAhead) {
  passEscapeAt(0.72);
  EXPECT_NEAR(updateAt(0.71), 0.012, 1e-6) << "10 mm, and the noise";
  EXPECT_EQ(leaving_.obstacles().size(), 1U);
  updateAt(0.7215);
  EXPECT_EQ(leaving_.obstacles().size(), 1U) << "noise";
  updateAt(0.7225);
  EXPECT_TRUE(leaving_.obstacles().empty());
  updateAt(0.71);
  EXPECT_EQ(leaving_.obstacles().size(), 1U) << "whatever came before";
}

/// Two slides, one on the other, that go against each other: the hand goes less far than its joints
/// together, by which 100 mm of its way are told. Its ball, padded, reaches 90 mm around
/// (slide + back, 0, 0.5); a wall begins at x = 0.8 m.
class LeavingSlowlyTest : public ::testing::Test {
 protected:
  LeavingSlowlyTest() {
    config_.check_occlusion = false;
    config_.collision_use.expansion.padding_m = 0.04;
    robot_ = test::checked(model_, config_);
    addBlock(map_, {Vector3(0.8, -0.2, 0.3), Vector3(0.9, 0.2, 0.7)});
  }

  /// In contact, and on its way out; it still touches once its joints went 100 mm.
  struct Motion {
    double share;    ///< of the slide's way that the other takes back
    double begin_m;  ///< the hand's place
    [[nodiscard]] double escaped_m() const {
      return begin_m - MovingOut::kEscape * (1.0 - share) / (1.0 + share);
    }
  };
  static Motion motion(Random& random) {
    Motion motion{random.uniform(0.3, 0.8), 0.0};
    const double moves_m = -motion.escaped_m();
    motion.begin_m = 0.71 + random.uniform(moves_m + 0.005, 0.075);
    return motion;
  }
  /// By variable, for a motion of the hand by so much.
  [[nodiscard]] std::vector<double> joints(double metres, double share) const {
    std::vector<double> values(2);
    const bool slide_first = model_->variables()[0].name == "slide";
    values[slide_first ? 0 : 1] = metres / (1.0 - share);
    values[slide_first ? 1 : 0] = -share * metres / (1.0 - share);
    return values;
  }

  /// On a way from there through these places of the hand, evenly over a second.
  std::optional<WayAhead::Found> lookAlong(const Motion& motion,
                                           const std::vector<double>& places) {
    JointPath path(2);
    path.add(0.0, joints(motion.begin_m, motion.share));
    for (std::size_t i = 0; i < places.size(); ++i) {
      path.add(static_cast<double>(i + 1) / static_cast<double>(places.size()),
               joints(places[i], motion.share));
    }
    PoseCheck here(robot_, 1.5);
    here.place(joints(motion.begin_m, motion.share), kAtOrigin);
    PoseFindings found;
    here.findContacts(map_, found);
    EXPECT_TRUE(found.collision);
    WayAhead ahead(robot_, 0.02, 0.1);
    ahead.begin({1.0, 0.3, 0.1, 0.0, 2.0}, found.contacts, here.posture(), 1'000'000);
    EXPECT_TRUE(ahead.lookAlong({map_, path, kAtOrigin}));
    EXPECT_FALSE(ahead.isTooLong());
    return ahead.touch();
  }

  std::string rail(const std::string& name, const std::string& parent, const std::string& child,
                   const std::string& more = "") const {
    return jointOf(name, "prismatic", parent, child, more + axisOf("1 0 0") + limitOf("-9", "9"));
  }
  const std::shared_ptr<const RobotModel> model_ =
      test::modelOf(robotOf(linkOf("base") + linkOf("carriage") + ballLink("hand") +
                            rail("slide", "base", "carriage", "<origin xyz=\"0 0 0.5\"/>") +
                            rail("back", "carriage", "hand")));
  CheckedRobot::Config config_;
  std::shared_ptr<CheckedRobot> robot_;
  CuboidMap map_ = test::emptyMap();
};

/// What is judged of the hand at a place, at a speed.
class LeavingVerdictTest : public LeavingSlowlyTest {
 protected:
  Causes judge(const Motion& motion, double speed_mps) {
    JointSnapshot joints;
    joints.positions = LeavingSlowlyTest::joints(motion.begin_m, motion.share);
    joints.velocities = LeavingSlowlyTest::joints(speed_mps, motion.share);
    CommandedTrajectories commanded(model_, {});
    commanded.findWays(joints, ContactJudge::Config().horizon_s);
    PoseCheck here(robot_, 1.5);
    here.place(joints.positions, kAtOrigin);
    PoseFindings found;
    here.check(map_, found);
    EXPECT_TRUE(found.collision);
    const Braking braking;
    Causes causes;
    ContactJudge(robot_, {}, braking)
        .judge({Time(), map_, joints, commanded, here, here, found, found, braking, true, 1.0},
               causes);
    return causes;
  }
  static Level levelOf(const Causes& causes) {
    Level level = Level::kOk;
    for (const Cause& cause : causes) level = std::max(level, cause.level);
    return level;
  }
  static bool has(const Causes& causes, Reason reason) {
    return std::any_of(causes.begin(), causes.end(),
                       [&](const Cause& cause) { return cause.reason == reason; });
  }
};

TEST_F(LeavingVerdictTest, AContactThatIsLeftSlowlyIsMovedOutOf) {
  Random random(19);
  for (int i = 0; i < 40; ++i) {
    const Motion out = motion(random);
    const double speed = (1.0 - out.share) * random.uniform(0.4, 1.5);
    const Causes causes = judge(out, -speed);
    EXPECT_TRUE(has(causes, Reason::kMovingOut)) << out.begin_m << " " << out.share;
    EXPECT_EQ(levelOf(causes), Level::kSlow) << out.begin_m << " " << out.share;
  }
}

TEST_F(LeavingVerdictTest, WhatElseIsAheadStopsItAllTheSame) {
  Random random(20);
  for (int i = 0; i < 40; ++i) {
    const Motion out = motion(random);
    map_ = test::emptyMap();
    addBlock(map_, {Vector3(0.8, -0.2, 0.3), Vector3(0.9, 0.2, 0.7)});
    const double end = out.begin_m - 0.09 - random.uniform(0.025, 0.045);
    addBlock(map_, {Vector3(end - 0.1, -0.2, 0.3), Vector3(end, 0.2, 0.7)});
    const Causes causes = judge(out, -random.uniform(0.25, 0.5));
    EXPECT_EQ(levelOf(causes), Level::kStop) << out.begin_m << " " << out.share;
    EXPECT_TRUE(has(causes, Reason::kCollisionAhead));
  }
}

TEST_F(LeavingVerdictTest, WayInIsACollision) {
  Random random(21);
  for (int i = 0; i < 20; ++i) {
    const Motion in = motion(random);
    EXPECT_EQ(levelOf(judge(in, random.uniform(0.1, 0.5))), Level::kStop) << in.begin_m;
  }
}

/// Out beyond the 100 mm, and then further in than it was there.
TEST_F(LeavingSlowlyTest, InAgainIsAhead) {
  Random random(22);
  for (int i = 0; i < 40; ++i) {
    const Motion out = motion(random);
    const double turn = out.escaped_m() - random.uniform(0.001, 0.2);
    const double end = random.uniform(out.escaped_m() + 0.006, 0.795);
    const auto touch = lookAlong(out, {turn, end});
    ASSERT_TRUE(touch) << out.begin_m << " " << turn << " " << end;
    EXPECT_GT(touch->contact.time_s, 0.5);
  }
}

/// Nothing else is near, so that places could be passed over.
TEST_F(LeavingSlowlyTest, InAndOutAgainIsNotPassedOver) {
  map_ = test::emptyMap();
  addBlock(map_, {Vector3(0.8, 0.0, 0.3), Vector3(0.82, 0.02, 0.7)});
  Random random(23);
  for (int i = 0; i < 40; ++i) {
    const Motion out = motion(random);
    const double turn = out.escaped_m() - random.uniform(0.001, 0.05);
    const double end = out.escaped_m() + random.uniform(0.008, 0.012);
    EXPECT_TRUE(lookAlong(out, {turn, end, turn - 0.1})) << out.begin_m << " " << turn;
  }
}

TEST_F(LeavingSlowlyTest, OutAndOutAgainIsFree) {
  Random random(24);
  for (int i = 0; i < 40; ++i) {
    const Motion out = motion(random);
    const double turn = out.escaped_m() - random.uniform(0.001, 0.05);
    EXPECT_FALSE(lookAlong(out, {turn, turn - 0.1})) << out.begin_m << " " << turn;
  }
}

}  // namespace
}  // namespace tccm
