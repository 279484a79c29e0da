#include "check/exemptions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/checker_fixture.h"
#include "support/refusal.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using test::addBlock;
using test::at;
using test::kStart;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

PlacedShape boxAt(double x, double y, double z, const Vector3& half_extents) {
  return {Box{half_extents}, test::placedAt(x, y, z)};
}

Exemption exemptionFor(const std::string& link, const std::string& owner = "grasping") {
  return {owner, link, boxAt(0.85, 0.0, 0.5, {0.2, 0.3, 0.6}), Time()};
}

/// Hand and other, a ball each.
class ExemptionsTest : public ::testing::Test {
 protected:
  void add(double now, const Exemption& exemption, double duration_s = 1.0) {
    exemptions_.add(at(now), exemption, duration_s, *model_);
  }
  [[nodiscard]] std::string refusal(const Exemption& exemption, double duration_s = 1.0) {
    const std::size_t before = exemptions_.list().size();
    std::string message;
    try {
      add(0.0, exemption, duration_s);
    } catch (const ConfigError& error) {
      message = error.what();
    }
    EXPECT_EQ(exemptions_.list().size() == before, !message.empty()) << message;
    return message;
  }
  /// How many regions each of the links has.
  [[nodiscard]] std::size_t regionsOf(const std::string& link) const {
    const ExemptRegions regions = exemptions_.regionsOf(*model_, {0, 1});
    if (regions.empty()) return 0;
    EXPECT_EQ(regions.size(), 2U);
    return regions[model_->linkOf(0) == link ? 0 : 1].size();
  }

  std::shared_ptr<const RobotModel> model_ = test::sliderModel();
  Exemptions exemptions_{Exemptions::Config{}};
};

TEST_F(ExemptionsTest, WithoutOneThereAreNoRegions) {
  EXPECT_TRUE(exemptions_.regionsOf(*model_, {0, 1}).empty());
  EXPECT_FALSE(exemptions_.expire(at(9.0)));
}

TEST_F(ExemptionsTest, OnlyTheLinkThatIsNamedHasTheRegion) {
  add(0.0, exemptionFor("hand"));
  EXPECT_EQ(regionsOf("hand"), 1U);
  EXPECT_EQ(regionsOf("other"), 0U);
  add(0.0, exemptionFor("h*", "docking"));
  EXPECT_EQ(regionsOf("hand"), 2U) << "by a pattern, for another owner";
  EXPECT_EQ(regionsOf("other"), 0U);
}

TEST_F(ExemptionsTest, RegionsStandInTheOrderOfTheShapesAskedFor) {
  add(0.0, exemptionFor("hand"));
  const std::size_t hand = model_->linkOf(0) == "hand" ? 0 : 1;
  const ExemptRegions regions = exemptions_.regionsOf(*model_, {1 - hand, hand, 1 - hand});
  ASSERT_EQ(regions.size(), 3U);
  EXPECT_TRUE(regions[0].empty());
  EXPECT_EQ(regions[1].size(), 1U);
  EXPECT_TRUE(regions[2].empty());
}

TEST_F(ExemptionsTest, ItLastsUntilItsTimeIsOverAndNoLonger) {
  add(5.0, exemptionFor("hand"), 2.0);
  ASSERT_EQ(exemptions_.list().size(), 1U);
  EXPECT_EQ(exemptions_.list()[0].until, at(7.0));
  EXPECT_FALSE(exemptions_.expire(at(6.999)));
  EXPECT_EQ(regionsOf("hand"), 1U);
  EXPECT_TRUE(exemptions_.expire(at(7.0)));
  EXPECT_TRUE(exemptions_.list().empty());
  EXPECT_TRUE(exemptions_.regionsOf(*model_, {0, 1}).empty());
  EXPECT_FALSE(exemptions_.expire(at(8.0))) << "it has ended already";
}

TEST_F(ExemptionsTest, OnlyTheOneWhoseTimeIsOverEnds) {
  add(0.0, exemptionFor("hand"), 1.0);
  add(0.0, exemptionFor("other"), 2.0);
  EXPECT_TRUE(exemptions_.expire(at(1.5)));
  EXPECT_EQ(regionsOf("hand"), 0U);
  EXPECT_EQ(regionsOf("other"), 1U);
}

TEST_F(ExemptionsTest, ANewOneOfTheSameOwnerForTheSameLinkTakesItsPlace) {
  add(0.0, exemptionFor("hand"), 9.0);
  Exemption smaller = exemptionFor("hand");
  smaller.region = {Sphere{0.1}, test::placedAt(1.0, 2.0, 3.0)};
  add(1.0, smaller, 2.0);
  ASSERT_EQ(exemptions_.list().size(), 1U);
  EXPECT_EQ(exemptions_.list()[0].until, at(3.0)) << "sooner, too";
  EXPECT_TRUE(std::holds_alternative<Sphere>(exemptions_.list()[0].region.shape));
  add(1.0, exemptionFor("hand", "docking"));
  add(1.0, exemptionFor("other"));
  EXPECT_EQ(exemptions_.list().size(), 3U);
}

TEST_F(ExemptionsTest, ADurationOfZeroEndsIt) {
  add(0.0, exemptionFor("hand"), 9.0);
  add(0.0, exemptionFor("hand", "docking"), 9.0);
  add(1.0, exemptionFor("hand"), 0.0);
  ASSERT_EQ(exemptions_.list().size(), 1U);
  EXPECT_EQ(exemptions_.list()[0].owner, "docking");
  add(1.0, exemptionFor("other"), 0.0);
  EXPECT_EQ(exemptions_.list().size(), 1U) << "there was none";
}

TEST_F(ExemptionsTest, ClearedNoneIsLeft) {
  add(0.0, exemptionFor("hand"));
  exemptions_.clear();
  EXPECT_TRUE(exemptions_.list().empty());
}

TEST_F(ExemptionsTest, WhatIsWrongWithOneIsNamedAndNothingChanges) {
  EXPECT_EQ(refusal(exemptionFor("hand")), "");
  EXPECT_TRUE(test::names(refusal(exemptionFor("other", "")), "owner"));
  EXPECT_TRUE(test::names(refusal(exemptionFor("")), "link"));
  EXPECT_TRUE(test::names(refusal(exemptionFor("foot")), "foot"));
  EXPECT_TRUE(test::names(refusal(exemptionFor("*")), "more than one")) << "none for everything";
  EXPECT_TRUE(test::names(refusal(exemptionFor("base")), "base")) << "it has no primitive";
  for (const double duration : {-0.1, 60.1, kNaN, HUGE_VAL}) {
    EXPECT_TRUE(test::names(refusal(exemptionFor("other"), duration), "duration")) << duration;
  }
  for (const Shape& shape : {Shape(Sphere{0.0}), Shape(Sphere{-1.0}), Shape(Sphere{kNaN}),
                             Shape(Box{{0.1, HUGE_VAL, 0.1}})}) {
    Exemption exemption = exemptionFor("other");
    exemption.region.shape = shape;
    EXPECT_TRUE(test::names(refusal(exemption), "region"));
  }
  Exemption exemption = exemptionFor("other");
  exemption.region.pose.translation().y() = kNaN;
  EXPECT_TRUE(test::names(refusal(exemption), "region"));
  exemption.region.pose = Pose(Eigen::Scaling(2.0));
  EXPECT_TRUE(test::names(refusal(exemption), "region"));
}

TEST_F(ExemptionsTest, ARefusedOneDoesNotEndTheOneItWouldHaveReplaced) {
  add(0.0, exemptionFor("hand"), 9.0);
  EXPECT_THROW(add(1.0, exemptionFor("hand"), 61.0), ConfigError);
  ASSERT_EQ(exemptions_.list().size(), 1U);
  EXPECT_EQ(exemptions_.list()[0].until, at(9.0));
}

TEST_F(ExemptionsTest, NoMoreThanTheLimitAreInForce) {
  Exemptions::Config config;
  config.count_max = 2;
  exemptions_ = Exemptions(config);
  add(0.0, exemptionFor("hand"));
  add(0.0, exemptionFor("other"));
  EXPECT_TRUE(test::names(refusal(exemptionFor("hand", "docking")), "exemptions_max"));
  add(0.5, exemptionFor("other"), 2.0);
  EXPECT_EQ(exemptions_.list().size(), 2U) << "one may still be replaced";
  exemptions_.expire(at(1.0));
  EXPECT_EQ(refusal(exemptionFor("hand", "docking")), "");
}

TEST(ExemptionsConfigTest, ValuesOutOfRangeAreRefused) {
  for (const double duration_s : {-1.0, 3601.0, kNaN}) {
    Exemptions::Config config;
    config.duration_max_s = duration_s;
    EXPECT_THROW(Exemptions{config}, ConfigError) << duration_s;
  }
  Exemptions::Config config;
  config.count_max = -1;
  EXPECT_THROW(Exemptions{config}, ConfigError);
}

/// What the checker makes of one. The hand touches the post, 0.8 to 0.9 m, from 0.71 m on; the
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

  const PlacedShape post_region_ = boxAt(0.85, 0.0, 0.4, {0.1, 0.3, 0.5});
  const PlacedShape both_region_ = boxAt(0.85, 0.25, 0.4, {0.1, 0.6, 0.5});
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
  exempt("hand", boxAt(0.85, 0.0, 0.4, {0.1, 0.3, 0.29}));  // up to 0.69 of 0.70 m
  const Verdict& verdict = feedAndCheck(kStart, post_, 0.75);
  EXPECT_EQ(verdict.reason, Reason::kCollision);
  EXPECT_EQ(verdict.link, "hand");
}

TEST_F(ExemptedCheckTest, CuboidsBesideTheRegionAreStillTouched) {
  exempt("hand", boxAt(0.85, 0.0, 0.4, {0.1, 0.061, 0.5}));
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
  exempt("hand", boxAt(0.0, 0.0, 0.0, {50.0, 50.0, 50.0}));
  exempt("other", boxAt(0.0, 0.0, 0.0, {50.0, 50.0, 50.0}));
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

TEST_F(ExemptedCheckTest, ClearancesAreToldAsTheyAre) {
  exempt("hand", post_region_);
  const Verdict& verdict = feedAndCheck(kStart, post_, 0.72);
  double least = 1.0;
  for (const LinkClearance& entry : verdict.clearances) least = std::min(least, entry.distance_m);
  EXPECT_NEAR(least, 0.03, 1e-9);
}

}  // namespace
}  // namespace tccm
