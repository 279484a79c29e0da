#include "check/approach_check.h"

#include "geometry/distance.h"
#include "support/checker_fixture.h"
#include "support/random.h"

namespace tccm {
namespace {

using test::kStart;
using test::Random;

/// The slider robot: its hand is a ball of 50 mm at (slide, 0, 0.5).
class ApproachCheckTest : public test::CheckerFixture {
 protected:
  /// A block of cuboids that have appeared.
  static CuboidMap withAppeared(CuboidMap map, const UprightBox& block) {
    const std::size_t before = map.cuboids.size();
    test::addBlock(map, block);
    EXPECT_EQ(before, 0U);
    for (Cuboid& cuboid : map.cuboids) cuboid.appeared = true;
    map.appeared = static_cast<std::uint32_t>(map.cuboids.size());
    return map;
  }
  /// Things that have long stood there, but do not touch the hand.
  static void addStanding(CuboidMap& map, Random& random) {
    for (int i = 0; i < 20; ++i) {
      const Vector3 low(random.uniform(0.0, 1.3), random.uniform(-0.9, 0.8), 0.0);
      if ((low.head<2>() - Eigen::Vector2d(0.3, 0.0)).norm() < 0.2) continue;
      if ((low.head<2>() - Eigen::Vector2d(0.0, 0.5)).norm() < 0.2) continue;
      test::addBlock(map, {low, low + Vector3(0.03, 0.03, 0.9)});
    }
  }
  [[nodiscard]] bool isApproached() const {
    const auto& reasons = last_->reasons;
    return std::find(reasons.begin(), reasons.end(), Reason::kApproached) != reasons.end();
  }
  void checkWith(const CuboidMap& map) {
    remake();
    last_ = &feedAndCheck(kStart, map, 0.3);
  }
  /// A box whose nearest side is so far before the hand along x.
  static UprightBox aheadOfHand(double gap_m) {
    return {Vector3(0.35 + gap_m, -0.1, 0.4), Vector3(0.45 + gap_m, 0.1, 0.6)};
  }

  const Verdict* last_ = nullptr;
};

TEST_F(ApproachCheckTest, WhatHasAppearedStopsTheRobotFromAfar) {
  checkWith(withAppeared(clear_, aheadOfHand(0.09)));
  EXPECT_EQ(last_->reason, Reason::kApproached);
  EXPECT_EQ(last_->level, Level::kStop);
  EXPECT_EQ(last_->link, "hand");
  EXPECT_NE(last_->detail.find("150 mm"), std::string::npos) << last_->detail;
  EXPECT_FALSE(last_->collision);
  ASSERT_TRUE(last_->approached);
  EXPECT_EQ(model_->linkOf(last_->approached->shape), "hand");
  EXPECT_TRUE(checker_->map()->cuboids[last_->approached->cuboid].appeared);
  CuboidMap still = clear_;
  test::addBlock(still, aheadOfHand(0.09));
  checkWith(still);
  EXPECT_EQ(last_->reason, Reason::kClear) << "it stands there";
  EXPECT_FALSE(last_->approached);
}

/// The first of the shapes that something that has appeared is near to, and the first cuboid near
/// it.
std::optional<Contact> firstNear(const Checker& checker, double distance_m) {
  const RobotModel& model = *checker.model();
  const CuboidMap& map = *checker.map();
  for (std::uint32_t i = 0; i < model.shapes().size(); ++i) {
    const Pose& pose = checker.checkHere().posture().T_fixed_shapes[i];
    for (std::uint32_t k = 0; k < map.cuboids.size(); ++k) {
      const double away = distance(model.shapes()[i].shape, pose, map.box(map.cuboids[k]));
      if (map.cuboids[k].appeared && away < distance_m) return Contact{i, k};
    }
  }
  return std::nullopt;
}

/// Of all links' primitives without their padding.
double distanceTo(const RobotModel& model, const Posture& posture, const CuboidMap& map) {
  double least = std::numeric_limits<double>::infinity();
  for (const Cuboid& cuboid : map.cuboids) {
    if (!cuboid.appeared) continue;
    for (std::size_t i = 0; i < model.shapes().size(); ++i) {
      least = std::min(
          least, distance(model.shapes()[i].shape, posture.T_fixed_shapes[i], map.box(cuboid)));
    }
  }
  return least;
}

TEST_F(ApproachCheckTest, TheDistanceDecidesWhereverItIs) {
  std::size_t near = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    Random random(seed);
    config_.approach.distance_m = random.uniform(0.06, 0.4);
    const Vector3 low(random.uniform(0.0, 0.9), random.uniform(-0.5, 0.4),
                      random.uniform(0.0, 0.9));
    CuboidMap map = withAppeared(clear_, {low, low + Vector3(0.05, 0.05, 0.1)});
    if (random.chance(0.5)) addStanding(map, random);
    checkWith(map);
    const double away = distanceTo(*model_, checker_->checkHere().posture(), map);
    if (std::abs(away - config_.approach.distance_m) < 1e-6) continue;
    const bool is_near = away < config_.approach.distance_m;
    EXPECT_EQ(isApproached(), is_near) << seed << ": " << away;
    near += is_near ? 1 : 0;
    const std::optional<Contact> first = firstNear(*checker_, config_.approach.distance_m);
    ASSERT_EQ(last_->approached.has_value(), first.has_value()) << seed;
    if (!first) continue;
    EXPECT_EQ(last_->approached->shape, first->shape) << seed;
    EXPECT_EQ(last_->approached->cuboid, first->cuboid) << seed;
  }
  EXPECT_GT(near, 40U);
  EXPECT_LT(near, 160U);
}

TEST_F(ApproachCheckTest, ZeroIsNoneAndItIsTunable) {
  config_.approach.distance_m = 0.0;
  checkWith(withAppeared(clear_, aheadOfHand(0.06)));
  EXPECT_EQ(last_->reason, Reason::kClear);
  config_.approach.distance_m = 0.15;
  checker_->reconfigure(config_);
  EXPECT_EQ(check(kStart + 0.01).reason, Reason::kApproached);
}

TEST_F(ApproachCheckTest, WhereItIsOffWhatHasAppearedStopsAsContactsDo) {
  config_.approach.distance_m = 0.0;
  checkWith(withAppeared(clear_, aheadOfHand(-0.01)));
  EXPECT_EQ(last_->reason, Reason::kCollision);
  EXPECT_FALSE(isApproached());
  EXPECT_FALSE(last_->approached);
}

TEST_F(ApproachCheckTest, OfLinksThatAreNotCheckedNothingIsSaidAndOfOthersWhatIsTrueOfThem) {
  config_.pose.collision_use.ignored = {"hand"};
  checkWith(withAppeared(clear_, aheadOfHand(0.09)));
  EXPECT_EQ(last_->reason, Reason::kClear) << last_->detail;
  // The other ball is at (0, 0.5, 0.5).
  const CuboidMap map = withAppeared(clear_, {Vector3(0.14, 0.4, 0.4), Vector3(0.2, 0.6, 0.6)});
  checkWith(map);
  EXPECT_EQ(last_->reason, Reason::kApproached);
  EXPECT_EQ(last_->link, "other");
  ASSERT_TRUE(last_->approached);
  EXPECT_EQ(model_->linkOf(last_->approached->shape), "other");
}

TEST_F(ApproachCheckTest, EachLinkIsAsLargeAsItIs) {
  std::string urdf = test::sliderUrdf();
  const std::string radius = "radius=\"0.05\"";
  urdf.replace(urdf.rfind(radius), radius.size(), "radius=\"0.02\"");
  model_ = test::modelOf(urdf);
  for (const std::vector<std::string>& ignored : {std::vector<std::string>{}, {"hand"}}) {
    config_.pose.collision_use.ignored = ignored;
    for (const double gap : {0.14, 0.16}) {
      const double x = 0.02 + gap;
      checkWith(withAppeared(clear_, {Vector3(x, 0.4, 0.4), Vector3(x + 0.06, 0.6, 0.6)}));
      EXPECT_EQ(last_->reason, gap < 0.15 ? Reason::kApproached : Reason::kClear) << gap;
    }
  }
}

TEST_F(ApproachCheckTest, WhatOneLinkMayTouchStopsTheOthers) {
  const CuboidMap map = withAppeared(clear_, {Vector3(0.14, 0.4, 0.4), Vector3(0.2, 0.6, 0.6)});
  Pose pose = Pose::Identity();
  pose.translation() = Vector3(0.2, 0.5, 0.5);
  for (const std::vector<std::string>& ignored : {std::vector<std::string>{}, {"hand"}}) {
    for (const std::string link : {"hand", "other"}) {
      if (link == "hand" && !ignored.empty()) continue;
      config_.pose.collision_use.ignored = ignored;
      remake();
      checker_->addExemption(test::at(kStart), {"test", link, {Box{{0.2, 0.3, 0.3}}, pose}, {}},
                             1.0);
      const Reason reason = feedAndCheck(kStart, map, 0.3).reason;
      EXPECT_EQ(reason, link == "hand" ? Reason::kApproached : Reason::kClear) << link;
    }
  }
}

TEST_F(ApproachCheckTest, OnceItBeginsAnewNothingIsSaidOfACuboidThatIsGone) {
  checkWith(withAppeared(clear_, aheadOfHand(0.09)));
  ASSERT_TRUE(last_->approached);
  checker_->startAnew();
  EXPECT_FALSE(check(kStart + 0.01).approached);
}

TEST_F(ApproachCheckTest, AFewReturnsAreNoneAndWhatALinkMayTouchIsNone) {
  CuboidMap map = withAppeared(clear_, aheadOfHand(0.08));
  for (Cuboid& cuboid : map.cuboids) cuboid.points = 0;
  checkWith(map);
  EXPECT_EQ(last_->reason, Reason::kClear) << "no support";

  remake();
  Pose pose = Pose::Identity();
  pose.translation() = Vector3(0.5, 0.0, 0.5);
  checker_->addExemption(test::at(kStart), {"test", "hand", {Box{{0.2, 0.3, 0.3}}, pose}, {}}, 1.0);
  feed(kStart, withAppeared(clear_, aheadOfHand(0.08)), 0.3);
  last_ = &check(kStart);
  EXPECT_EQ(last_->reason, Reason::kClear) << last_->detail;
}

TEST_F(ApproachCheckTest, ItIsReleasedOnceNothingThatHasAppearedIsNear) {
  run(kStart, kStart + 0.5, withAppeared(clear_, aheadOfHand(0.08)), 0.3);
  CuboidMap still = clear_;
  test::addBlock(still, aheadOfHand(0.08));
  EXPECT_EQ(run(kStart + 0.53, kStart + 0.8, still, 0.3).reason, Reason::kReleasing);
  EXPECT_EQ(run(kStart + 0.83, kStart + 3.0, still, 0.3).reason, Reason::kClear);
}

}  // namespace
}  // namespace tccm
