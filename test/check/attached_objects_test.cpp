/// Checker with something in the robot's hand, and robots whose links hang on several roots.

#include "support/checker_fixture.h"
#include "support/near.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using namespace test::urdf_text;
using test::at;
using test::kStart;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A ball of 30 mm, 120 mm ahead of the hand: padded, it reaches 100 mm further than the hand.
AttachedObject ballAhead(const std::string& name = "ball", double radius = 0.03) {
  AttachedObject object{name, "hand", {Sphere{radius}}};
  object.primitive.pose.translation().x() = 0.12;
  return object;
}

class AttachedObjectsTest : public test::CheckerFixture {
 protected:
  /// The least slide at which the robot touches the post, to 5 mm.
  double firstContact() {
    for (double slide = 0.4; slide < 0.8; slide += 0.005) {
      if (findingsAt(slide).collision) return slide;
    }
    return kNaN;
  }
  PoseFindings findingsAt(double slide) {
    feed(kStart, post_);
    return checker_->checkState(at(kStart), {"slide"}, {slide}).findings;
  }
};

TEST_F(AttachedObjectsTest, WhatIsHeldAheadOfTheHandTouchesEarlierByAsMuchAsItReachesFurther) {
  const double empty_hand = firstContact();
  EXPECT_NEAR(empty_hand, 0.71, 0.006);
  checker_->attach(ballAhead());
  EXPECT_NEAR(firstContact(), empty_hand - (0.12 + 0.03 - 0.05), 0.006);
  checker_->attach(ballAhead("ball", 0.07));
  EXPECT_NEAR(firstContact(), empty_hand - (0.12 + 0.07 - 0.05), 0.006) << "by its size";
}

TEST_F(AttachedObjectsTest, TheVerdictNamesTheObjectAndTheLinkThatHoldsIt) {
  checker_->attach(ballAhead());
  EXPECT_EQ(feedAndCheck(kStart, post_, 0.59).reason, Reason::kClear);
  const Verdict& verdict = feedAndCheck(kStart + 0.02, post_, 0.65);
  EXPECT_EQ(verdict.reason, Reason::kCollision);
  EXPECT_EQ(verdict.link, "hand");
  EXPECT_EQ(verdict.detail, "'ball' on hand touches the map");
  ASSERT_FALSE(verdict.now.contacts.empty());
  EXPECT_EQ(checker_->model()->shapes()[verdict.now.contacts.front().shape].object, "ball");
  const auto asked = checker_->checkState(at(kStart + 0.02), {"slide"}, {0.65});
  EXPECT_EQ(asked.cause.reason, Reason::kCollision);
  EXPECT_EQ(asked.cause.link, "hand");
  EXPECT_EQ(asked.cause.detail, verdict.detail);
}

TEST_F(AttachedObjectsTest, WhereTheHandItselfTouchesTheHandIsNamed) {
  AttachedObject aside = ballAhead();
  aside.primitive.pose.translation() = Vector3(-0.2, 0.0, 0.0);
  checker_->attach(aside);
  EXPECT_EQ(feedAndCheck(kStart, post_, 0.75).detail, "hand touches the map");
}

TEST_F(AttachedObjectsTest, TheObjectIsCheckedAheadToo) {
  checker_->attach(ballAhead());
  const Verdict& verdict = feedAndCheck(kStart, post_, 0.45, 0.4);
  EXPECT_EQ(verdict.reason, Reason::kCollisionAhead);
  EXPECT_EQ(verdict.detail, "'ball' on hand touches the map ahead in 406 ms");
}

TEST_F(AttachedObjectsTest, WithoutTheObjectThePoseIsFreeAgainAfterTheRelease) {
  checker_->attach(ballAhead());
  EXPECT_EQ(run(kStart, kStart + 0.2, post_, 0.65).reason, Reason::kCollision);
  EXPECT_TRUE(checker_->detach("ball"));
  EXPECT_EQ(feedAndCheck(kStart + 0.225, post_, 0.65).reason, Reason::kReleasing);
  EXPECT_EQ(run(kStart + 0.25, kStart + 1.15, post_, 0.65).reason, Reason::kReleasing);
  EXPECT_EQ(run(kStart + 1.175, kStart + 1.3, post_, 0.65).reason, Reason::kClear);
  EXPECT_TRUE(checker_->attached().empty());
}

TEST_F(AttachedObjectsTest, AnObjectThatTouchesStopsFromTheNextCheckOn) {
  EXPECT_EQ(feedAndCheck(kStart, post_, 0.65).reason, Reason::kClear);
  checker_->attach(ballAhead());
  EXPECT_EQ(reasonAt(kStart + 0.001), Reason::kCollision);
}

TEST_F(AttachedObjectsTest, AnObjectOfTheSameNameIsReplacedAndAnotherIsAdded) {
  const std::size_t bare = model_->shapes().size();
  checker_->attach(ballAhead());
  checker_->attach(ballAhead("ball", 0.07));
  ASSERT_EQ(checker_->attached().size(), 1U);
  EXPECT_EQ(std::get<Sphere>(checker_->attached().front().primitive.shape).radius, 0.07);
  EXPECT_EQ(checker_->model()->shapes().size(), bare + 1);
  AttachedObject other = ballAhead("cap");
  other.link = "other";
  checker_->attach(other);
  EXPECT_EQ(checker_->attached().size(), 2U);
  EXPECT_EQ(checker_->model()->shapes().size(), bare + 2);
  EXPECT_TRUE(checker_->detach("ball"));
  ASSERT_EQ(checker_->attached().size(), 1U);
  EXPECT_EQ(checker_->attached().front().name, "cap");
  EXPECT_EQ(checker_->model()->linkOf(bare), "other");
}

TEST_F(AttachedObjectsTest, DetachingWhatIsNotThereChangesNothing) {
  checker_->attach(ballAhead());
  const auto before = checker_->model();
  EXPECT_FALSE(checker_->detach("mug"));
  EXPECT_FALSE(checker_->detach(""));
  EXPECT_EQ(checker_->model(), before);
}

TEST_F(AttachedObjectsTest, WhatIsRefusedLeavesEverythingAsItWas) {
  checker_->attach(ballAhead());
  const auto before = checker_->model();
  EXPECT_EQ(feedAndCheck(kStart, post_, 0.65).reason, Reason::kCollision);
  std::vector<AttachedObject> refused(6, ballAhead());
  refused[0].link = "nowhere";
  refused[1].name = "";
  refused[2].primitive.shape = Sphere{-0.05};
  refused[3].primitive.shape = Cylinder{0.05, kNaN};
  refused[4].primitive.pose.translation().z() = kNaN;
  refused[5].primitive.pose.linear() *= 2.0;
  for (std::size_t i = 0; i < refused.size(); ++i) {
    EXPECT_THROW(checker_->attach(refused[i]), ConfigError) << i;
    EXPECT_EQ(checker_->model(), before) << i;
    ASSERT_EQ(checker_->attached().size(), 1U) << i;
    EXPECT_EQ(checker_->attached().front().link, "hand") << i;
  }
  EXPECT_EQ(feedAndCheck(kStart + 0.02, post_, 0.65).detail, "'ball' on hand touches the map");
}

TEST_F(AttachedObjectsTest, AVerdictThatCountedOtherShapesForgetsItsContacts) {
  checker_->attach(ballAhead());
  const Verdict& verdict = feedAndCheck(kStart, post_, 0.75);
  ASSERT_TRUE(verdict.placed);
  ASSERT_FALSE(verdict.now.contacts.empty());
  EXPECT_TRUE(checker_->detach("ball"));
  EXPECT_FALSE(verdict.placed);
  EXPECT_TRUE(verdict.now.contacts.empty()) << "their shapes may be numbered otherwise now";
  EXPECT_TRUE(verdict.ahead.contacts.empty());
  EXPECT_TRUE(verdict.stop) << "what was said stands until the next check";
  for (const bool held : {true, false}) {
    if (held) checker_->attach(ballAhead());
    for (const Contact& contact : feedAndCheck(kStart + 0.02, post_, 0.75).now.contacts) {
      ASSERT_LT(contact.shape, checker_->model()->shapes().size());
    }
    EXPECT_EQ(verdict.reason, Reason::kCollision);
    checker_->detach("ball");
  }
}

TEST_F(AttachedObjectsTest, OtherLimitsAreInForceForTheObjectToo) {
  checker_->attach(ballAhead());
  config_.pose.collision_use.expansion.padding_m = 0.0;
  checker_->reconfigure(config_);
  EXPECT_NEAR(firstContact(), 0.80 - 0.12 - 0.03, 0.006);
}

TEST_F(AttachedObjectsTest, AnObjectOnALinkThatIsNotCheckedIsChecked) {
  config_.pose.collision_use.ignored = {"hand"};
  remake();
  EXPECT_FALSE(findingsAt(0.75).collision);
  checker_->attach(ballAhead());
  EXPECT_TRUE(findingsAt(0.65).collision);
}

TEST_F(AttachedObjectsTest, AfterTimeJumpedBackTheHandHoldsWhatItHeld) {
  checker_->attach(ballAhead());
  feedAndCheck(kStart, post_, 0.65);
  EXPECT_EQ(reasonAt(kStart - 50.0), Reason::kInit);
  EXPECT_EQ(feedAndCheck(kStart - 49.9, post_, 0.65).detail, "'ball' on hand touches the map");
}

class LinkPoseTest : public test::CheckerFixture {
 protected:
  std::optional<Pose> handAt(double now) { return checker_->linkPose(at(now), "hand"); }
};

TEST_F(LinkPoseTest, ALinkIsWhereJointsAndRootPutIt) {
  addJoints(kStart, 0.3);
  checker_->setRootPose(0, at(kStart), test::placedAt(0.0, 1.0, 0.0), false);
  const auto hand = handAt(kStart);
  ASSERT_TRUE(hand);
  EXPECT_TRUE(test::isNearly(*hand, test::placedAt(0.3, 1.0, 0.5), 1e-12));
  EXPECT_FALSE(checker_->linkPose(at(kStart), "nowhere"));
}

TEST_F(LinkPoseTest, NoMapIsNeededForIt) {
  addJoints(kStart, 0.3);
  setRoot(kStart);
  EXPECT_EQ(checker_->map(), nullptr);
  EXPECT_TRUE(handAt(kStart));
}

TEST_F(LinkPoseTest, ThereIsNoneWhileAnythingIsMissingOldOrInTheFuture) {
  EXPECT_FALSE(handAt(kStart));
  addJoints(kStart, 0.3);
  EXPECT_FALSE(handAt(kStart)) << "no root";
  setRoot(kStart);
  EXPECT_TRUE(handAt(kStart + 0.0999));
  EXPECT_FALSE(handAt(kStart + 0.1001)) << "joints too old";
  addJoints(kStart + 0.55, 0.3);
  EXPECT_FALSE(handAt(kStart + 0.55)) << "root too old";
  setRoot(kStart + 0.55, true);
  EXPECT_TRUE(handAt(kStart + 0.6));
  addJoints(kStart + 1.0, 0.3);
  EXPECT_FALSE(handAt(kStart + 0.6)) << "joints of the future";
}

TEST_F(LinkPoseTest, ThereIsNoneWhileTheClockStandsStill) {
  addJoints(kStart, 0.3);
  setRoot(kStart);
  checker_->inputs().setClockStalls(true);
  EXPECT_FALSE(handAt(kStart));
  checker_->inputs().setClockStalls(false);
  EXPECT_TRUE(handAt(kStart));
}

TEST_F(LinkPoseTest, JointsThatNobodyPublishedAreKnownByName) {
  const std::vector<std::string> both{"slide", "glide"};
  EXPECT_EQ(checker_->missingJoints(), both);
  checker_->addJoints(at(kStart), at(kStart), {"slide"}, {0.0}, {});
  EXPECT_EQ(checker_->missingJoints(), std::vector<std::string>{"glide"});
  addJoints(kStart + 0.01, 0.0);
  EXPECT_TRUE(checker_->missingJoints().empty());
}

/// The slider, and beside it a ball on a trolley that transforms place.
class SeveralRootsTest : public test::CheckerFixture {
 protected:
  SeveralRootsTest() {
    model_ = test::modelOf(
        robotOf(ballLink("base") + ballLink("hand") + ballLink("trolley") +
                jointOf("slide", "prismatic", "base", "hand",
                        "<origin xyz=\"0 0 0.5\"/>" + axisOf("1 0 0") + limitOf("-0.5", "1.0")) +
                jointOf("free", "floating", "base", "trolley")));
    config_.pose.check_occlusion = false;
    remake();
  }
  void feedAllBut(double now, std::size_t root) {
    addJoints(now, 0.0);
    setMap(now, post_);
    for (std::size_t other = 0; other < 2; ++other) {
      if (other != root) placeRoot(other, now, test::placedAt(0.3, -0.4, 0.3));
    }
  }
  void placeRoot(std::size_t root, double stamp, const Pose& pose) {
    checker_->setRootPose(root, at(stamp), pose, false);
  }
};

TEST_F(SeveralRootsTest, EachRootIsPlacedByItsOwnTransform) {
  ASSERT_EQ(model_->rootLinks(), (std::vector<std::string>{"base", "trolley"}));
  feedAllBut(kStart, 1);
  placeRoot(1, kStart, test::placedAt(0.3, -0.4, 0.3));
  EXPECT_EQ(reasonAt(kStart), Reason::kClear);
  placeRoot(1, kStart, test::placedAt(0.75, 0.0, 0.3));
  const Verdict& verdict = check(kStart);
  EXPECT_EQ(verdict.reason, Reason::kCollision);
  EXPECT_EQ(verdict.link, "trolley");
  const auto trolley = checker_->linkPose(at(kStart), "trolley");
  ASSERT_TRUE(trolley);
  EXPECT_TRUE(test::isNearly(*trolley, test::placedAt(0.75, 0.0, 0.3), 1e-12));
}

TEST_F(SeveralRootsTest, ARootThatIsMissingIsWaitedForAndThenNamed) {
  for (const std::size_t root : {std::size_t{0}, std::size_t{1}}) {
    remake();
    const std::string link = "'" + model_->rootLinks()[root] + "'";
    feedAllBut(kStart, root);
    EXPECT_EQ(check(kStart).reason, Reason::kInit);
    EXPECT_NE(check(kStart).detail.find(link), std::string::npos) << check(kStart).detail;
    EXPECT_FALSE(check(kStart).placed);
    feedAllBut(kStart + 0.6, root);
    EXPECT_EQ(reasonAt(kStart + 0.6), Reason::kNoTransform);
    EXPECT_NE(check(kStart + 0.6).detail.find(link), std::string::npos);
    EXPECT_FALSE(checker_->linkPose(at(kStart + 0.6), "hand"));
    EXPECT_EQ(checker_->checkState(at(kStart + 0.6), {"slide"}, {0.0}).cause.reason,
              Reason::kNoTransform);
  }
}

TEST_F(SeveralRootsTest, ARootThatIsLateOrInTheFutureIsNamed) {
  for (const std::size_t root : {std::size_t{0}, std::size_t{1}}) {
    remake();
    const std::string link = "'" + model_->rootLinks()[root] + "'";
    placeRoot(root, kStart, Pose::Identity());
    feedAllBut(kStart + 0.51, root);
    const Verdict& verdict = check(kStart + 0.51);
    EXPECT_EQ(verdict.reason, Reason::kNoTransform);
    EXPECT_NE(verdict.detail.find(link), std::string::npos) << verdict.detail;
    EXPECT_NE(verdict.detail.find("for 510 ms"), std::string::npos) << verdict.detail;
    placeRoot(root, kStart + 1.1, Pose::Identity());
    check(kStart + 0.52);
    EXPECT_EQ(verdict.reason, Reason::kFuture);
    EXPECT_NE(verdict.detail.find(link), std::string::npos) << verdict.detail;
  }
}

TEST_F(SeveralRootsTest, WhatIsHeldByALinkOfTheSecondRootMovesWithIt) {
  AttachedObject box = ballAhead("box");
  box.link = "trolley";
  checker_->attach(box);
  feedAllBut(kStart, 1);
  placeRoot(1, kStart, test::placedAt(0.65, 0.0, 0.3));
  EXPECT_EQ(check(kStart).detail, "'box' on trolley touches the map");
}

/// One joint has a configured place.
class FixedJointsTest : public test::CheckerFixture {
 protected:
  FixedJointsTest() {
    RobotModel::Config config;
    config.fixed_joints = {{"glide", 0.2}};
    model_ = test::modelOf(test::sliderUrdf(), config);
    remake();
    setRoot(kStart);
    setMap(kStart, clear_);
    checker_->addJoints(at(kStart), at(kStart), {"slide"}, {0.0}, {});
  }
  StateAnswer ask(const std::vector<std::string>& names, const std::vector<double>& positions) {
    return checker_->checkState(at(kStart), names, positions);
  }
};

TEST_F(FixedJointsTest, AJointThatIsFixedNeedNotBePublished) {
  EXPECT_TRUE(checker_->missingJoints().empty());
  EXPECT_EQ(reasonAt(kStart), Reason::kClear);
  const auto other = checker_->linkPose(at(kStart), "other");
  ASSERT_TRUE(other);
  EXPECT_NEAR(other->translation().x(), 0.2, 1e-12);
}

TEST_F(FixedJointsTest, NothingIsKnownWhileItIsPublishedElsewhere) {
  addJoints(kStart + 0.01, 0.0);  // with "glide" at 0
  const Verdict& verdict = check(kStart + 0.01);
  EXPECT_EQ(verdict.reason, Reason::kNoJoints);
  EXPECT_NE(verdict.detail.find("'glide'"), std::string::npos) << verdict.detail;
  EXPECT_EQ(checker_->checkState(at(kStart + 0.01), {"slide"}, {0.1}).cause.reason,
            Reason::kNoJoints);
  EXPECT_FALSE(checker_->linkPose(at(kStart + 0.01), "hand"));
}

TEST_F(FixedJointsTest, AQuestionMayNameAFixedJointWhereItIsAndNowhereElse) {
  EXPECT_EQ(ask({"slide", "glide"}, {0.1, 0.2}).cause.reason, Reason::kClear);
  EXPECT_EQ(ask({"glide"}, {0.2005}).cause.reason, Reason::kClear);
  const auto elsewhere = ask({"slide", "glide"}, {0.1, 0.3});
  EXPECT_EQ(elsewhere.cause.reason, Reason::kBadQuestion);
  EXPECT_NE(elsewhere.cause.detail.find("'glide'"), std::string::npos) << elsewhere.cause.detail;
  EXPECT_NE(elsewhere.cause.detail.find("fixed_joints"), std::string::npos)
      << elsewhere.cause.detail;
}

}  // namespace
}  // namespace tccm
