#include "ros/attached_mirror.h"

#include <gtest/gtest.h>

namespace tccm {
namespace {

using Names = std::vector<std::string>;

HeldShape ballOf(double radius) {
  HeldShape shape;
  shape.link = "palm";
  shape.primitive.shape = "sphere";
  shape.primitive.radius = radius;
  return shape;
}

/// A monitor that takes everything but what it refuses.
class AttachedMirrorTest : public ::testing::Test {
 protected:
  void mirror() {
    for (const std::string& name : mirror_.toAttach()) {
      ++calls_;
      if (name == refused_) {
        mirror_.refused(name);
        continue;
      }
      held_[name] = mirror_.planned(name);
      mirror_.attached(name);
    }
    for (const std::string& name : mirror_.toDetach()) {
      ++calls_;
      held_.erase(name);
      mirror_.detached(name);
    }
  }

  AttachedMirror mirror_;
  HeldShapes held_;
  std::string refused_;
  int calls_ = 0;
};

TEST_F(AttachedMirrorTest, NothingIsAskedForBeforeTheMonitorIsHeardOf) {
  mirror_.plan({{"cup", ballOf(0.04)}});
  EXPECT_EQ(mirror_.toAttach(), Names{});
  mirror_.hear({});
  EXPECT_EQ(mirror_.toAttach(), Names{"cup"});
}

TEST_F(AttachedMirrorTest, NewOnesAreAttachedOthersReplacedAndThoseThatAreGoneDetached) {
  mirror_.hear({});
  mirror_.plan({{"cup", ballOf(0.04)}, {"lid", ballOf(0.02)}});
  mirror();
  EXPECT_EQ(held_, (HeldShapes{{"cup", ballOf(0.04)}, {"lid", ballOf(0.02)}}));
  EXPECT_EQ(calls_, 2);
  mirror_.plan({{"cup", ballOf(0.05)}, {"lid", ballOf(0.02)}});
  EXPECT_EQ(mirror_.toAttach(), Names{"cup"});
  mirror();
  mirror_.plan({{"lid", ballOf(0.02)}});
  EXPECT_EQ(mirror_.toDetach(), Names{"cup"});
  mirror();
  EXPECT_EQ(held_, (HeldShapes{{"lid", ballOf(0.02)}}));
  mirror();
  EXPECT_EQ(calls_, 4) << "no more than is needed";
}

TEST_F(AttachedMirrorTest, WhatIsHeldAlreadyIsNotAttachedAgain) {
  mirror_.hear({{"cup", ballOf(0.04)}});
  mirror_.plan({{"cup", ballOf(0.04)}});
  EXPECT_EQ(mirror_.toAttach(), Names{});
  mirror_.plan({});
  EXPECT_EQ(mirror_.toDetach(), Names{"cup"}) << "it was planned once";
}

TEST_F(AttachedMirrorTest, WhatOthersHaveAttachedIsLeftAlone) {
  mirror_.hear({{"saw", ballOf(0.04)}});
  mirror_.plan({{"cup", ballOf(0.04)}});
  mirror();
  mirror_.plan({});
  mirror();
  EXPECT_EQ(mirror_.toDetach(), Names{});
  EXPECT_EQ(calls_, 2);
}

TEST_F(AttachedMirrorTest, ANameThatIsGoneMayBeAnothersLater) {
  refused_ = "cup";
  mirror_.hear({});
  mirror_.plan({{"cup", ballOf(0.04)}});
  mirror();
  mirror_.plan({});
  mirror_.hear({{"cup", ballOf(0.04)}});
  EXPECT_EQ(mirror_.toDetach(), Names{});
}

TEST_F(AttachedMirrorTest, AMonitorThatHasForgottenIsToldAnew) {
  mirror_.hear({});
  mirror_.plan({{"cup", ballOf(0.04)}});
  mirror();
  mirror_.hear({});
  EXPECT_EQ(mirror_.toAttach(), Names{"cup"});
}

TEST_F(AttachedMirrorTest, WhatIsRefusedIsAskedForAgainOnceATurn) {
  refused_ = "cup";
  mirror_.hear({});
  mirror_.plan({{"cup", ballOf(0.04)}, {"lid", ballOf(0.02)}});
  for (int i = 0; i < 10; ++i) {
    mirror();
    mirror_.hear(held_);
  }
  EXPECT_EQ(calls_, 2);
  mirror_.askAgain();
  mirror();
  EXPECT_EQ(calls_, 3);
  mirror_.plan({{"cup", ballOf(0.05)}, {"lid", ballOf(0.02)}});
  mirror();
  EXPECT_EQ(calls_, 4) << "it is another shape now";
  refused_ = "";
  mirror_.askAgain();
  mirror();
  EXPECT_EQ(held_.size(), 2U);
}

}  // namespace
}  // namespace tccm
