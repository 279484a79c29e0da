#include "check/exemptions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/exempt_region.h"
#include "support/refusal.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using test::addBlock;
using test::at;
using test::kStart;
using test::regionAt;
using State = Exemption::State;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Exemption exemptionFor(const std::string& link, const std::string& owner = "grasping") {
  return {owner, link, regionAt(0.85, 0.0, 0.5, {0.2, 0.3, 0.6}), Time()};
}

/// Hand and other, a ball each.
class ExemptionsTest : public ::testing::Test {
 protected:
  void add(double now, const Exemption& exemption, double duration_s = 1.0) {
    exemptions_.add(at(now), exemption, duration_s, *model_);
    exemptions_.update(at(now), limits_);
  }
  /// @return whether any ended.
  bool expire(double now) { return exemptions_.update(at(now), limits_); }
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
    if (regions.of_shapes.empty()) return 0;
    EXPECT_EQ(regions.of_shapes.size(), 2U);
    return regions.of_shapes[model_->linkOf(0) == link ? 0 : 1].size();
  }
  /// Of the first in the list.
  [[nodiscard]] State state() const { return exemptions_.list().at(0).state; }
  [[nodiscard]] std::string whyNot() const {
    return whyNotInForce(exemptions_.list().at(0), limits_);
  }
  [[nodiscard]] const ExemptRegion& region() const { return exemptions_.regions().at(0); }
  State stateAt(double now) {
    expire(now);
    return state();
  }

  std::shared_ptr<const RobotModel> model_ = test::sliderModel();
  Exemptions exemptions_{Exemptions::Config{}};
  const Exemptions::Limits limits_{0.5, 0.2};
};

TEST_F(ExemptionsTest, WithoutOneThereAreNoRegions) {
  EXPECT_TRUE(exemptions_.regionsOf(*model_, {0, 1}).of_shapes.empty());
  EXPECT_FALSE(expire(9.0));
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
  ASSERT_EQ(regions.regions.size(), 1U);
  ASSERT_EQ(regions.of_shapes.size(), 3U);
  EXPECT_TRUE(regions.of_shapes[0].empty());
  EXPECT_EQ(regions.of_shapes[1], std::vector<std::size_t>{0});
  EXPECT_TRUE(regions.of_shapes[2].empty());
}

TEST_F(ExemptionsTest, ItLastsUntilItsTimeIsOverAndNoLonger) {
  add(5.0, exemptionFor("hand"), 2.0);
  ASSERT_EQ(exemptions_.list().size(), 1U);
  EXPECT_EQ(exemptions_.list()[0].until, at(7.0));
  EXPECT_FALSE(expire(6.999));
  EXPECT_EQ(regionsOf("hand"), 1U);
  EXPECT_TRUE(expire(7.0));
  EXPECT_TRUE(exemptions_.list().empty());
  EXPECT_TRUE(exemptions_.regions().empty());
  EXPECT_TRUE(exemptions_.regionsOf(*model_, {0, 1}).of_shapes.empty());
  EXPECT_FALSE(expire(8.0)) << "it has ended already";
}

TEST_F(ExemptionsTest, OnlyTheOneWhoseTimeIsOverEnds) {
  add(0.0, exemptionFor("hand"), 1.0);
  add(0.0, exemptionFor("other"), 2.0);
  EXPECT_TRUE(expire(1.5));
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

TEST_F(ExemptionsTest, ThoseOfAnOwnerAreLiftedByLinkOrAltogether) {
  for (const char* link : {"hand", "other"}) {
    add(0.0, exemptionFor(link), 9.0);
    add(0.0, exemptionFor(link, "docking"), 9.0);
  }
  EXPECT_EQ(exemptions_.lift("nobody", ""), 0U);
  EXPECT_EQ(exemptions_.lift("docking", "foot"), 0U);
  EXPECT_EQ(exemptions_.list().size(), 4U);
  EXPECT_EQ(exemptions_.lift("docking", "hand"), 1U);
  EXPECT_EQ(regionsOf("hand"), 1U);
  EXPECT_EQ(regionsOf("other"), 2U);
  EXPECT_EQ(exemptions_.lift("grasping", ""), 2U);
  ASSERT_EQ(exemptions_.list().size(), 1U);
  EXPECT_EQ(exemptions_.list()[0].owner, "docking");
  EXPECT_EQ(exemptions_.list()[0].link, "other");
}

TEST_F(ExemptionsTest, OneWithAGoalCountsFromItsBeginToItsEnd) {
  Exemption exemption = exemptionFor("hand");
  exemption.with_goal = true;
  add(5.0, exemption, 2.0);
  EXPECT_EQ(state(), State::kAwaitsGoal);
  EXPECT_FALSE(region().in_force);
  EXPECT_TRUE(test::names(whyNot(), "waits for a goal of 'grasping'"));
  exemptions_.reportGoal(at(6.0), "docking", "docking-1", true);
  EXPECT_EQ(stateAt(6.0), State::kAwaitsGoal) << "it is another's goal";
  exemptions_.reportGoal(at(30.0), "grasping", "grasping-1", true);
  EXPECT_EQ(stateAt(30.0), State::kInForce);
  EXPECT_TRUE(region().in_force);
  EXPECT_EQ(whyNot(), "");
  EXPECT_EQ(exemptions_.list()[0].until, at(32.0)) << "for its duration from there";
  exemptions_.reportGoal(at(31.0), "docking", "docking-1", false);
  EXPECT_EQ(exemptions_.list().size(), 1U);
  exemptions_.reportGoal(at(31.0), "grasping", "grasping-1", false);
  EXPECT_TRUE(exemptions_.list().empty());
}

TEST_F(ExemptionsTest, AGoalThatLastsLongerThanItDoesNotKeepIt) {
  Exemption exemption = exemptionFor("hand");
  exemption.with_goal = true;
  add(5.0, exemption, 2.0);
  exemptions_.reportGoal(at(6.0), "grasping", "1", true);
  EXPECT_FALSE(expire(7.9));
  EXPECT_TRUE(expire(8.0));
  add(9.0, exemption, 2.0);
  EXPECT_EQ(state(), State::kInForce) << "the goal is still under way";
  EXPECT_EQ(exemptions_.list()[0].until, at(11.0));
  exemptions_.reportGoal(at(10.0), "grasping", "2", true);
  EXPECT_EQ(exemptions_.list()[0].until, at(11.0)) << "a second goal lengthens nothing";
}

TEST_F(ExemptionsTest, ItLapsesWhereNoGoalBegins) {
  Exemption exemption = exemptionFor("hand");
  exemption.with_goal = true;
  add(5.0, exemption, 2.0);
  EXPECT_FALSE(expire(64.9));
  EXPECT_EQ(state(), State::kAwaitsGoal);
  EXPECT_TRUE(expire(65.0));
  exemptions_.reportGoal(at(66.0), "grasping", "1", true);
  EXPECT_TRUE(exemptions_.list().empty());
}

TEST_F(ExemptionsTest, OfSeveralGoalsItEndsWithTheLast) {
  Exemption exemption = exemptionFor("hand");
  exemption.with_goal = true;
  add(0.0, exemption, 9.0);
  exemptions_.reportGoal(at(1.0), "/grasping", "left", true);
  exemptions_.reportGoal(at(1.0), "grasping", "right", true);
  exemptions_.reportGoal(at(1.5), "grasping", "right", true);  // said twice
  exemptions_.reportGoal(at(2.0), "grasping", "right", false);
  exemptions_.reportGoal(at(2.1), "grasping", "right", false);
  EXPECT_EQ(stateAt(2.2), State::kInForce);
  exemptions_.reportGoal(at(3.0), "grasping", "left", false);
  EXPECT_TRUE(exemptions_.list().empty());
  add(4.0, exemption, 9.0);
  EXPECT_EQ(state(), State::kAwaitsGoal);
  for (const char* goal : {"1", "2", "3"}) exemptions_.reportGoal(at(4.0), "grasping", goal, true);
  exemptions_.reportGoal(at(5.0), "grasping", "", false);
  EXPECT_TRUE(exemptions_.list().empty()) << "all of them have ended";
}

TEST_F(ExemptionsTest, AGoalEndsNoExemptionWithoutOne) {
  add(0.0, exemptionFor("hand"), 9.0);
  exemptions_.reportGoal(at(1.0), "grasping", "1", true);
  exemptions_.reportGoal(at(2.0), "grasping", "1", false);
  EXPECT_EQ(stateAt(2.0), State::kInForce);
}

TEST_F(ExemptionsTest, OfTooManyGoalsTheOldestCountsAsEnded) {
  Exemption exemption = exemptionFor("hand");
  exemption.with_goal = true;
  add(0.0, exemption, 9.0);
  exemptions_.reportGoal(at(1.0), "grasping", "1", true);
  const auto others = static_cast<int>(Exemptions::kGoalsMax);
  for (int i = 1; i < others; ++i) {
    exemptions_.reportGoal(at(1.0), "docking", std::to_string(i), true);
  }
  EXPECT_EQ(stateAt(1.0), State::kInForce);
  exemptions_.reportGoal(at(1.0), "docking", "one more", true);
  EXPECT_TRUE(exemptions_.list().empty());
}

TEST_F(ExemptionsTest, AGoalWithoutNameIsRefused) {
  EXPECT_THROW(exemptions_.reportGoal(at(0.0), "", "1", true), ConfigError);
  EXPECT_THROW(exemptions_.reportGoal(at(0.0), "", "", false), ConfigError);
  EXPECT_THROW(exemptions_.reportGoal(at(0.0), "grasping", "", true), ConfigError);
  EXPECT_NO_THROW(exemptions_.reportGoal(at(0.0), "grasping", "never heard of", false));
}

TEST_F(ExemptionsTest, ARegionInALinksFrameMovesWithTheLink) {
  model_ = test::modelOf(test::robotOf(
      test::linkOf("base") + test::ballLink("hand") + test::linkOf("tip") + test::linkOf("thumb") +
      test::jointOf("slide", "prismatic", "base", "hand",
                    test::axisOf("1 0 0") + test::limitOf("0", "1")) +
      test::jointOf("tip_joint", "fixed", "hand", "tip", "<origin xyz=\"0.1 0 0\"/>") +
      test::jointOf("thumb_joint", "prismatic", "hand", "thumb",
                    test::axisOf("1 0 0") + test::limitOf("0", "1"))));
  Exemption exemption = exemptionFor("hand");
  exemption.frame = "hand";
  add(0.0, exemption);
  ASSERT_TRUE(region().link);
  EXPECT_EQ(model_->links()[*region().link], "hand");
  EXPECT_TRUE(region().placed.pose.isApprox(exemption.region.pose));
  EXPECT_EQ(state(), State::kInForce);
  EXPECT_TRUE(exemptions_.frames().empty());

  exemption.frame = "tip";  // nobody monitors it, but it is fixed to the hand
  add(0.0, exemption);
  ASSERT_TRUE(region().link);
  EXPECT_EQ(model_->links()[*region().link], "hand");
  EXPECT_TRUE(region().placed.pose.isApprox(test::placedAt(0.1, 0.0, 0.0) * exemption.region.pose));

  exemption.frame = "thumb";  // moves, and no joint state has to say so
  add(0.0, exemption);
  EXPECT_FALSE(region().link);
  EXPECT_EQ(state(), State::kNoTransform);
  EXPECT_EQ(exemptions_.frames(), std::vector<std::string>{"thumb"});
}

TEST_F(ExemptionsTest, ARegionInAnotherFrameLiesWhereTheNewestTransformPutsIt) {
  Exemption exemption = exemptionFor("hand");
  exemption.frame = "cup";
  add(10.0, exemption, 50.0);
  add(10.0, exemptionFor("other"), 50.0);
  EXPECT_EQ(state(), State::kNoTransform);
  EXPECT_FALSE(region().in_force);
  EXPECT_TRUE(test::names(whyNot(), "'cup'"));
  EXPECT_EQ(exemptions_.frames(), std::vector<std::string>{"cup"});
  const Pose T_fixed_cup = test::placedAt(1.0, 2.0, 3.0) * Eigen::AngleAxisd(0.5, Vector3::UnitZ());
  exemptions_.setFrame("mug", at(10.0), T_fixed_cup, false);
  EXPECT_EQ(stateAt(10.0), State::kNoTransform) << "it is another frame's";
  exemptions_.setFrame("cup", at(10.0), T_fixed_cup, false);
  EXPECT_EQ(stateAt(10.0), State::kInForce);
  EXPECT_TRUE(region().in_force);
  EXPECT_FALSE(region().link);
  EXPECT_TRUE(region().placed.pose.isApprox(T_fixed_cup * exemption.region.pose));
  EXPECT_EQ(stateAt(10.5), State::kInForce);
  EXPECT_EQ(stateAt(10.501), State::kTransformOld);
  EXPECT_FALSE(region().in_force);
  EXPECT_TRUE(test::names(whyNot(), "transform_timeout_s")) << whyNot();
  exemptions_.setFrame("cup", at(11.0), Pose(Eigen::Scaling(2.0)), false);
  EXPECT_EQ(stateAt(11.0), State::kTransformOld) << "what is no pose says nothing";
  exemptions_.setFrame("cup", at(11.0), Pose::Identity(), false);
  EXPECT_EQ(stateAt(10.8), State::kInForce);
  EXPECT_EQ(stateAt(10.799), State::kTransformOfFuture);
  EXPECT_FALSE(region().in_force);
  EXPECT_TRUE(test::names(whyNot(), "future")) << whyNot();
  EXPECT_TRUE(exemptions_.regions()[1].in_force) << "the other one's";
}

TEST_F(ExemptionsTest, AStaticFrameNeverGrowsOld) {
  Exemption exemption = exemptionFor("hand");
  exemption.frame = "dock";
  add(10.0, exemption, 50.0);
  exemptions_.setFrame("dock", Time(), Pose::Identity(), true);
  EXPECT_EQ(stateAt(40.0), State::kInForce);
}

TEST_F(ExemptionsTest, ClearedNoneIsLeft) {
  add(0.0, exemptionFor("hand"));
  exemptions_.reportGoal(at(0.0), "grasping", "1", true);
  exemptions_.clear();
  EXPECT_TRUE(exemptions_.list().empty());
  Exemption exemption = exemptionFor("hand");
  exemption.with_goal = true;
  add(0.0, exemption);
  EXPECT_EQ(state(), State::kAwaitsGoal) << "goals are forgotten as well";
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
  expire(1.0);
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

}  // namespace
}  // namespace tccm
