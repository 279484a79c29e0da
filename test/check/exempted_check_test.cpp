/// What the checker makes of exemptions.

#include <gtest/gtest.h>

#include "support/exempt_region.h"
#include "support/refusal.h"

namespace tccm {
namespace {

using test::addBlock;
using test::at;
using test::kStart;
using test::regionAt;

/// The hand touches the post, 0.8 to 0.9 m, from 0.71 m on; the
/// region takes it in.
class ExemptedCheckTest : public test::CheckerFixture {
 protected:
  ExemptedCheckTest() {
    config_.pose.check_occlusion = false;
    remake();
    // Another post in the way of the other.
    both_ = post_;
    addBlock(both_, {Vector3(0.8, 0.3, 0.0), Vector3(0.9, 0.7, 0.7)});
    test::lookAround(both_);
    config_.evidence.unseen_fraction_max = 1.0;  // what is touched is not seen through
    remake();
  }
  void exempt(const std::string& link, const PlacedShape& region, double duration_s = 5.0,
              double now = kStart) {
    checker_->addExemption(at(now), {"grasping", link, region, Time()}, duration_s);
  }
  const Verdict& feedBoth(double now, const CuboidMap& map, double slide, double glide,
                          double slide_speed = 0.0, double glide_speed = 0.0) {
    setRoot(now);
    checker_->addJoints(at(now), at(now), {"slide", "glide"}, {slide, glide},
                        {slide_speed, glide_speed});
    setMap(now, map);
    return check(now);
  }

  const PlacedShape post_region_ = regionAt(0.85, 0.0, 0.4, {0.1, 0.3, 0.5});
  const PlacedShape both_region_ = regionAt(0.85, 0.25, 0.4, {0.1, 0.6, 0.5});
  CuboidMap both_;
};

TEST_F(ExemptedCheckTest, WhatLiesInTheRegionMayBeTouchedNowAndAhead) {
  ASSERT_EQ(feedAndCheck(kStart, post_, 0.75).reason, Reason::kCollision);
  remake();
  exempt("hand", post_region_);
  const Verdict& verdict = feedAndCheck(kStart, post_, 0.75, 0.1);
  EXPECT_EQ(verdict.reason, Reason::kClear);
  EXPECT_FALSE(verdict.now.collision || verdict.ahead.collision || verdict.first_contact);
}

TEST_F(ExemptedCheckTest, ACuboidThatReachesOutOfTheRegionIsStillTouched) {
  exempt("hand", regionAt(0.85, 0.0, 0.4, {0.1, 0.3, 0.29}));  // up to 0.69 of 0.70 m
  const Verdict& verdict = feedAndCheck(kStart, post_, 0.75);
  EXPECT_EQ(verdict.reason, Reason::kCollision);
  EXPECT_EQ(verdict.link, "hand");
}

TEST_F(ExemptedCheckTest, CuboidsBesideTheRegionAreStillTouched) {
  exempt("hand", regionAt(0.85, 0.0, 0.4, {0.1, 0.061, 0.5}));
  EXPECT_EQ(feedAndCheck(kStart, post_, 0.75).reason, Reason::kCollision);
}

TEST_F(ExemptedCheckTest, OtherLinksMayNotTouchWhatLiesInTheRegion) {
  exempt("hand", both_region_);
  const Verdict& verdict = feedBoth(kStart, both_, 0.75, 0.75);
  EXPECT_EQ(verdict.reason, Reason::kCollision);
  EXPECT_EQ(verdict.link, "other");
  for (const Contact& contact : verdict.now.contacts) {
    EXPECT_EQ(model_->linkOf(contact.shape), "other");
  }
}

TEST_F(ExemptedCheckTest, TheWayAheadOfOtherLinksIsLookedAtAsBefore) {
  exempt("hand", both_region_);
  const Verdict& verdict = feedBoth(kStart, both_, 0.75, 0.5, 0.0, 0.6);
  EXPECT_EQ(verdict.reason, Reason::kCollisionAhead);
  EXPECT_EQ(verdict.link, "other");
  remake();
  exempt("hand", both_region_);
  EXPECT_EQ(feedBoth(kStart, both_, 0.75, 0.5, 0.2, 0.0).reason, Reason::kClear)
      << "the hand's own is not";
}

TEST_F(ExemptedCheckTest, ItEndsAtItsTimeAlthoughNobodyEndsIt) {
  exempt("hand", post_region_, 1.0);
  EXPECT_EQ(run(kStart, kStart + 0.975, post_, 0.75).reason, Reason::kClear);
  EXPECT_EQ(feedAndCheck(kStart + 1.0, post_, 0.75).reason, Reason::kCollision);
  EXPECT_TRUE(checker_->exemptions().empty());
}

TEST_F(ExemptedCheckTest, ItIsEndedAtOnce) {
  exempt("hand", post_region_);
  EXPECT_EQ(feedAndCheck(kStart, post_, 0.75).reason, Reason::kClear);
  exempt("hand", post_region_, 0.0);
  EXPECT_EQ(feedAndCheck(kStart + 0.01, post_, 0.75).reason, Reason::kCollision);
}

TEST_F(ExemptedCheckTest, ItNeverHidesAFault) {
  exempt("hand", regionAt(0.0, 0.0, 0.0, {50.0, 50.0, 50.0}));
  exempt("other", regionAt(0.0, 0.0, 0.0, {50.0, 50.0, 50.0}));
  ASSERT_EQ(feedBoth(kStart, both_, 0.75, 0.75).reason, Reason::kClear);
  CuboidMap overflowed = both_;
  overflowed.overflowed = true;
  EXPECT_EQ(feedBoth(kStart + 0.01, overflowed, 0.75, 0.75).reason, Reason::kMapOverflow);
  const Verdict& silence = check(kStart + 1.0);
  EXPECT_EQ(silence.level, Level::kFault);
  EXPECT_TRUE(silence.stop);
  EXPECT_FALSE(silence.known);
}

TEST_F(ExemptedCheckTest, WhatIsHeldByTheLinkMayTouchAsWellAndThatOfOthersNot) {
  AttachedObject object{"cup", "other", {Sphere{0.05}, test::placedAt(0.0, -0.5, 0.0)}};
  checker_->attach(object);  // it is where the hand is
  exempt("hand", post_region_);
  EXPECT_EQ(feedBoth(kStart, post_, 0.75, 0.75).reason, Reason::kCollision);
  remake();
  object.link = "hand";
  object.primitive.pose = test::placedAt(0.05, 0.0, 0.0);
  checker_->attach(object);
  exempt("hand", post_region_);
  EXPECT_EQ(feedBoth(kStart, post_, 0.75, 0.0).reason, Reason::kClear);
  ASSERT_TRUE(checker_->detach("cup"));
  EXPECT_EQ(feedBoth(kStart + 0.01, post_, 0.75, 0.0).reason, Reason::kClear)
      << "it outlasts what is held";
}

TEST_F(ExemptedCheckTest, ItOutlastsANewConfigurationAndNotAClockThatJumpsBack) {
  exempt("hand", post_region_, 50.0);
  checker_->reconfigure(config_);
  EXPECT_EQ(feedAndCheck(kStart, post_, 0.75).reason, Reason::kClear);
  check(kStart - 50.0);
  EXPECT_EQ(feedAndCheck(kStart - 49.0, post_, 0.75).reason, Reason::kCollision);
}

TEST_F(ExemptedCheckTest, QuestionsAboutStatesAndWaysKnowIt) {
  feed(kStart, post_);
  const JointTrajectory into_it{{"slide"}, {{1.0, {0.75}, {}, {}}}};
  const auto state = [this] {
    return checker_->checkState(at(kStart), {"slide"}, {0.75}).cause.reason;
  };
  EXPECT_EQ(state(), Reason::kCollision);
  EXPECT_EQ(checker_->checkTrajectory(at(kStart), into_it).cause.reason, Reason::kCollision);
  exempt("hand", post_region_);
  EXPECT_EQ(state(), Reason::kClear);
  EXPECT_EQ(checker_->checkTrajectory(at(kStart), into_it).cause.reason, Reason::kClear);
}

TEST_F(ExemptedCheckTest, AQuestionAfterItsEndDoesNotKnowIt) {
  feed(kStart, post_);
  exempt("hand", post_region_, 0.01);
  EXPECT_EQ(checker_->checkState(at(kStart + 0.02), {"slide"}, {0.75}).cause.reason,
            Reason::kCollision);
  exempt("hand", post_region_, 0.01);
  EXPECT_EQ(checker_->checkTrajectory(at(kStart + 0.02), {{"slide"}, {{1.0, {0.75}, {}, {}}}})
                .cause.reason,
            Reason::kCollision);
}

TEST_F(ExemptedCheckTest, ItIsLiftedAtOnce) {
  exempt("hand", post_region_);
  EXPECT_EQ(feedAndCheck(kStart, post_, 0.75).reason, Reason::kClear);
  EXPECT_EQ(checker_->liftExemptions("grasping", "other"), 0U);
  EXPECT_EQ(checker_->liftExemptions("grasping", ""), 1U);
  EXPECT_EQ(feedAndCheck(kStart + 0.01, post_, 0.75).reason, Reason::kCollision);
}

TEST_F(ExemptedCheckTest, WithAGoalItCountsFromItsBeginToItsEnd) {
  Exemption exemption{"/grasping", "hand", post_region_, Time()};
  exemption.with_goal = true;
  checker_->addExemption(at(kStart), exemption, 1.0);
  const JointTrajectory into_it{{"slide"}, {{1.0, {0.75}, {}, {}}}};
  const auto answerAt = [&](double now) {
    feed(now, post_);
    return checker_->checkTrajectory(at(now), into_it).cause.reason;
  };
  EXPECT_EQ(answerAt(kStart), Reason::kCollision);
  checker_->reportGoal(at(kStart), "/grasping", "1", true);
  EXPECT_EQ(answerAt(kStart), Reason::kClear) << "before any check";
  EXPECT_EQ(feedAndCheck(kStart + 0.01, post_, 0.75).reason, Reason::kClear);
  checker_->reportGoal(at(kStart + 0.02), "/grasping", "1", false);
  EXPECT_EQ(answerAt(kStart + 0.02), Reason::kCollision);
  EXPECT_EQ(feedAndCheck(kStart + 0.03, post_, 0.75).reason, Reason::kCollision);
}

TEST_F(ExemptedCheckTest, InAFrameItIsWhereTheNewestTransformSaysAndOnlyWhileThatIsFresh) {
  Exemption exemption{"grasping", "hand", {post_region_.shape, Pose::Identity()}, Time()};
  exemption.frame = "cup";
  checker_->addExemption(at(kStart), exemption, 50.0);
  EXPECT_EQ(checker_->exemptFrames(), std::vector<std::string>{"cup"});
  EXPECT_TRUE(feedAndCheck(kStart, post_, 0.75).now.collision);
  EXPECT_FALSE(checker_->regionPose(0));
  checker_->setExemptFrame("cup", at(kStart + 0.01), post_region_.pose, false);
  EXPECT_FALSE(feedAndCheck(kStart + 0.02, post_, 0.75).now.collision);
  ASSERT_TRUE(checker_->regionPose(0));
  EXPECT_TRUE(checker_->regionPose(0)->isApprox(post_region_.pose));
  const Pose aside = test::placedAt(0.0, 0.5, 0.0) * post_region_.pose;
  checker_->setExemptFrame("cup", at(kStart + 0.03), aside, false);
  EXPECT_TRUE(feedAndCheck(kStart + 0.04, post_, 0.75).now.collision);
  checker_->setExemptFrame("cup", at(kStart + 0.05), post_region_.pose, false);
  EXPECT_FALSE(run(kStart + 0.06, kStart + 0.55, post_, 0.75).now.collision);
  EXPECT_TRUE(feedAndCheck(kStart + 0.56, post_, 0.75).now.collision);
  EXPECT_TRUE(test::names(checker_->whyNotInForce(checker_->exemptions()[0]), "500 ms"));
}

TEST_F(ExemptedCheckTest, AStretchIsNotFreeBecauseTheRegionIsThereInItsMiddle) {
  CuboidMap wall = clear_;
  const CellIndex cell = *wall.grid.cellOf({0.81, 0.0, 0.5});
  test::addCuboid(wall, cell, 0.45, 0.55);
  test::lookAround(wall);
  const double middle = wall.grid.centre(cell).x();
  // Of the hand's way over the wall, from 20 mm before its middle on, both ends and the middle are
  // exempt, and what lies between is not.
  const auto exemptWhere = [&](double slide) {
    Exemption exemption{"at " + std::to_string(slide),
                        "hand",
                        {Box{{0.015, 0.1, 0.2}}, test::placedAt(middle - slide, 0.0, 0.0)},
                        Time()};
    exemption.frame = "hand";
    checker_->addExemption(at(kStart), exemption, 5.0);
  };
  feed(kStart, wall, middle - 0.02);
  for (const double shift : {-0.02, 0.03, 0.08}) exemptWhere(middle + shift);
  const auto reasonAt = [&](double shift) {
    return checker_->checkState(at(kStart), {"slide"}, {middle + shift}).cause.reason;
  };
  for (const double shift : {-0.02, 0.03, 0.08}) EXPECT_EQ(reasonAt(shift), Reason::kClear);
  ASSERT_EQ(reasonAt(0.005), Reason::kCollision);
  const JointTrajectory over_it{{"slide"},
                                {{0.0, {middle - 0.02}, {}, {}}, {1.0, {middle + 0.08}, {}, {}}}};
  EXPECT_EQ(checker_->checkTrajectory(at(kStart), over_it).cause.reason, Reason::kCollision);
  addJoints(kStart + 0.01, middle - 0.02, 0.5);
  EXPECT_EQ(check(kStart + 0.01).reason, Reason::kCollisionAhead);
}

TEST_F(ExemptedCheckTest, ClearancesAreToldAsTheyAre) {
  exempt("hand", post_region_);
  const Verdict& verdict = feedAndCheck(kStart, post_, 0.72);
  double least = 1.0;
  for (const LinkClearance& entry : verdict.clearances) least = std::min(least, entry.distance_m);
  EXPECT_NEAR(least, 0.03, 1e-9);
}

}  // namespace
}  // namespace tccm
