/// Which regions there may be, and which primitives they concern.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/keep_out_fixture.h"
#include "support/refusal.h"

namespace tccm {
namespace {

using namespace test::urdf_text;
using test::at;
using test::errorOf;
using test::keepOutBox;
using test::kStart;
using test::names;
using test::Regions;
using test::wall;
using test::wallRow;

class KeepOutRegionsTest : public test::KeepOutFixture {};

/// A base with a ball of its own, which no joint moves.
class KeepOutBaseTest : public test::KeepOutFixture {
 protected:
  KeepOutBaseTest() {
    model_ = test::modelOf(
        robotOf(ballLink("base") + ballLink("hand") + linkOf("torso") + linkOf("mount") +
                jointOf("bolt", "fixed", "base", "torso", "<origin xyz=\"0 0 0.3\"/>") +
                jointOf("slide", "prismatic", "torso", "hand",
                        "<origin xyz=\"0 0 0.2\"/>" + axisOf("1 0 0") + limitOf("-0.5", "1.0")) +
                jointOf("twist", "continuous", "torso", "mount", axisOf("0 0 1"))));
    remake();
  }
  Reason reasonWith(const KeepOutRegion& region, bool is_static) {
    remake();
    checker_->setKeepOut(region);
    setRoot(kStart, is_static);
    checker_->addJoints(at(kStart), at(kStart), {"slide"}, {0.0}, {0.0});
    setMap(kStart, clear_);
    return check(kStart).reason;
  }
};

TEST_F(KeepOutBaseTest, WhatNothingMovesAgainstARegionIsNotCheckedAgainstIt) {
  const Vector3 size(0.1, 0.1, 0.1);
  EXPECT_EQ(reasonWith(keepOutBox("floor", {0, 0, 0}, size), true), Reason::kClear);
  EXPECT_EQ(reasonWith(keepOutBox("floor", {0, 0, 0}, size), false), Reason::kKeepOut)
      << "a base that drives can enter it";
  EXPECT_EQ(reasonWith(keepOutBox("floor", {0, 0, 0}, size, "base"), false), Reason::kClear);
  EXPECT_EQ(reasonWith(keepOutBox("belly", {0, 0, 0.2}, size, "torso"), false), Reason::kKeepOut)
      << "the hand can";
  EXPECT_EQ(reasonWith(keepOutBox("belly", {0, 0, -0.3}, size, "torso"), false), Reason::kClear);
}

TEST_F(KeepOutBaseTest, WhatIsNotCheckedHasNoClearanceToItEither) {
  setRoot(kStart, true);
  checker_->setKeepOut(keepOutBox("floor", {0, 0, 0}, {0.1, 0.1, 0.1}));
  checker_->addJoints(at(kStart), at(kStart), {"slide"}, {0.0}, {0.0});
  setMap(kStart, clear_);
  for (const LinkClearance& entry : check(kStart).clearances) {
    EXPECT_TRUE(std::isinf(entry.distance_m)) << checker_->model()->links()[entry.link];
  }
}

TEST_F(KeepOutBaseTest, AFrameThatAJointMovesOrThatNobodyKnowsIsRefused) {
  for (const char* frame : {"hand", "nowhere"}) {
    const std::string error = refusalOf(keepOutBox("wall", {1, 0, 0}, {1, 1, 1}, frame));
    EXPECT_TRUE(names(error, std::string("frame: '") + frame)) << error;
    EXPECT_TRUE(names(error, "'base', 'torso'")) << error;
    Regions::Region row = wallRow();
    row.frame = frame;
    EXPECT_TRUE(names(refusalOf(Regions{{row}}), "keep_out[0]/frame: '")) << frame;
  }
  EXPECT_EQ(refusalOf(keepOutBox("wall", {1, 0, 0}, {1, 1, 1}, "torso")), "");
  EXPECT_EQ(refusalOf(keepOutBox("wall", {1, 0, 0}, {1, 1, 1}, "?")), "") << "the fixed frame";
}

TEST_F(KeepOutRegionsTest, WhatIsWrongInTheConfigurationIsNamedWithItsKey) {
  const auto with = [](const std::function<void(Regions::Region&)>& change) {
    Regions::Region other = wallRow();
    other.name = "other";
    Regions regions{{wallRow(), other}};
    change(regions.regions[1]);
    return regions;
  };
  EXPECT_EQ(refusalOf(with([](auto&) {})), "");
  const auto refused = [&](double Regions::Region::*member, double value, const char* text) {
    const std::string error = refusalOf(with([&](auto& row) { row.*member = value; }));
    EXPECT_TRUE(names(error, std::string("keep_out[1]/") + text)) << error;
  };
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  refused(&Regions::Region::size_x_m, 0.0,
          "size_x_m: 0 is outside the allowed range [0.001, 1000]");
  refused(&Regions::Region::size_y_m, -1.0, "size_y_m: -1 is outside");
  refused(&Regions::Region::size_z_m, kNaN, "size_z_m: nan is outside");
  refused(&Regions::Region::center_x_m, 1001.0, "center_x_m: 1001 is outside");
  refused(&Regions::Region::center_y_m, kNaN, "center_y_m: nan is outside");
  refused(&Regions::Region::center_z_m, -HUGE_VAL, "center_z_m: -inf is outside");
  refused(&Regions::Region::roll_rad, 90.0, "roll_rad: 90 is outside");
  refused(&Regions::Region::pitch_rad, -90.0, "pitch_rad: -90 is outside");
  refused(&Regions::Region::yaw_rad, kNaN, "yaw_rad: nan is outside");
  EXPECT_TRUE(names(refusalOf(with([](auto& row) { row.name = ""; })), "keep_out[1]/name"));
  EXPECT_TRUE(names(refusalOf(with([](auto& row) { row.name = "wall"; })),
                    "keep_out[1]/name: 'wall' is given twice"));
  EXPECT_TRUE(names(refusalOf(with([](auto& row) { row.frame = "hall"; })),
                    "keep_out[1]/frame: 'hall' is neither the fixed frame '?'"));
  Regions many{std::vector<Regions::Region>(65, wallRow())};
  EXPECT_TRUE(names(refusalOf(many), "keep_out: 65 regions, at most 64"));
}

TEST_F(KeepOutRegionsTest, WhatIsWrongWithOneThatIsSetIsNamedAndNothingChanges) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusalOf(wall()), "");
  for (const std::string& name : {std::string(), std::string(61, 'a'), std::string("two\nlines")}) {
    EXPECT_TRUE(names(refusalOf(keepOutBox(name, {1, 0, 0}, {1, 1, 1})), "name")) << name;
  }
  for (const double bad : {0.0, -1.0, kNaN, HUGE_VAL}) {
    EXPECT_TRUE(names(refusalOf(keepOutBox("b", {1, 0, 0}, {1, bad, 1})), "size_y_m")) << bad;
  }
  EXPECT_TRUE(names(refusalOf(keepOutBox("b", {1, 0, -2000}, {1, 1, 1})), "center_z_m"));
  EXPECT_NE(refusalOf(keepOutBox("b", {1, 0, kNaN}, {1, 1, 1})), "");
  KeepOutRegion sheared = keepOutBox("b", {1, 0, 0}, {1, 1, 1});
  sheared.T_frame_box.linear() *= 2.0;
  EXPECT_NE(refusalOf(sheared), "");
}

TEST_F(KeepOutRegionsTest, OneOfTheSameNameIsReplacedAndSixtyFourAreTheMost) {
  checker_->setKeepOut(wall());
  checker_->setKeepOut(keepOutBox("wall", {2.0, 0.0, 0.5}, {0.2, 0.4, 1.0}));
  EXPECT_EQ(checker_->keepOut().size(), 1U);
  EXPECT_EQ(feedAndCheck(kStart, clear_, 0.75).reason, Reason::kClear) << "it is elsewhere now";
  for (int i = 1; i < 64; ++i) {
    EXPECT_EQ(refusalOf(keepOutBox(std::to_string(i), {5.0, 0.0, 0.0}, {1, 1, 1})), "");
  }
  EXPECT_TRUE(names(refusalOf(keepOutBox("one more", {5, 0, 0}, {1, 1, 1})), "64 regions already"));
  EXPECT_EQ(refusalOf(wall()), "") << "it takes no more room";
  EXPECT_EQ(feedAndCheck(kStart + 0.02, clear_, 0.75).reason, Reason::kKeepOut);
  checker_->removeKeepOut("7");
  EXPECT_EQ(refusalOf(keepOutBox("one more", {5, 0, 0}, {1, 1, 1})), "");
}

TEST_F(KeepOutRegionsTest, RemovedItIsNoneAnyMoreAndTheOthersStay) {
  checker_->setKeepOut(keepOutBox("far", {3.0, 0.0, 0.5}, {0.2, 0.4, 1.0}));
  checker_->setKeepOut(wall());
  checker_->setKeepOut(keepOutBox("aside", {0.0, 0.9, 0.5}, {0.2, 0.2, 1.0}));
  checker_->removeKeepOut("far");
  EXPECT_EQ(checker_->keepOut().size(), 2U);
  EXPECT_EQ(feedAndCheck(kStart, clear_, 0.75).detail, "hand is in keep-out region 'wall'");
  checker_->removeKeepOut("wall");
  EXPECT_TRUE(
      names(errorOf([this] { checker_->removeKeepOut("wall"); }), "there is no region 'wall'"));
  EXPECT_EQ(run(kStart + 0.025, kStart + 1.2, clear_, 0.75).reason, Reason::kClear);
}

TEST_F(KeepOutRegionsTest, ThoseOfTheConfigurationAreNeitherReplacedNorRemoved) {
  config_.keep_out.regions = {wallRow()};
  remake();
  EXPECT_TRUE(names(refusalOf(keepOutBox("wall", {2, 0, 0}, {1, 1, 1})), "of the configuration"));
  EXPECT_TRUE(names(errorOf([this] { checker_->removeKeepOut("wall"); }), "of the configuration"));
  EXPECT_EQ(feedAndCheck(kStart, clear_, 0.75).reason, Reason::kKeepOut);
}

TEST_F(KeepOutRegionsTest, TuningGraspingAndAStepOfTheClockLeaveThemWhereTheyAre) {
  checker_->setKeepOut(wall());
  checker_->reconfigure(config_);
  checker_->attach({"ball", "hand", {Sphere{0.03}}});
  checker_->detach("ball");
  checker_->startAnew();
  EXPECT_EQ(feedAndCheck(kStart, clear_, 0.75).reason, Reason::kKeepOut);
}

TEST_F(KeepOutRegionsTest, SetBetweenTwoChecksItCountsFromTheNext) {
  EXPECT_EQ(feedAndCheck(kStart, clear_, 0.75).reason, Reason::kClear);
  checker_->setKeepOut(wall());
  EXPECT_EQ(reasonAt(kStart + 0.001), Reason::kKeepOut);
}

}  // namespace
}  // namespace tccm
