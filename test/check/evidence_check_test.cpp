#include "check/evidence_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "support/checked_robot.h"
#include "support/cuboid_scene.h"
#include "support/look_around.h"
#include "support/tiny_robot.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using test::placedAt;

constexpr double kPeriod = 1.0;  // [s]
Time at(double seconds) { return Time(fromSeconds(seconds)); }

/// The slider robot's two balls of 50 mm, at heights of 0.5 m, seen from above and behind. The
/// map's looks are half a second and a whole one old at 10.5 s.
class EvidenceCheckTest : public ::testing::Test {
 protected:
  EvidenceCheckTest() {
    map_.stamp = at(10.5);
    map_.viewpoint = Vector3(-0.5, 0.0, 1.5);
    test::lookAround(map_);
  }

  [[nodiscard]] static Body bodyAt(double hand_x, double other_x) {
    return {{Sphere{0.05}, Sphere{0.05}},
            {placedAt(hand_x, 0.0, 0.5), placedAt(other_x, 0.5, 0.5)}};
  }
  const EvidenceCheck::Findings& find(double now, double hand_by) {
    return check_.find(map_, at(now), bodyAt(0.3, 0.3), bodyAt(0.3 + hand_by, 0.3));
  }
  /// Whatever is seen of directions that `chosen` picks by their azimuth.
  template <typename Chosen>
  void lookOnly(const LookImage::Passes& passes, Chosen&& chosen) {
    for (int row = 0; row < map_.looks.grid().rows(); ++row) {
      for (int column = 0; column < map_.looks.grid().columns(); ++column) {
        const Vector3 middle = map_.looks.grid().middle(row, column);
        if (chosen(std::atan2(middle.y(), middle.x()))) map_.looks.edit(row, column) = passes;
      }
    }
  }
  void lookEverywhere(const LookImage::Passes& passes) {
    lookOnly(passes, [](double) { return true; });
  }

  /// Of a robot whose sliders go from 0.3 m on to these ends.
  Causes judge(double now, const std::vector<double>& end) {
    const std::vector<Pose> roots{Pose::Identity()};
    PoseCheck here(test::checked(model_), 1.5), ahead(here);
    here.place({0.3, 0.3}, roots);
    ahead.place(end, roots);
    const JointSnapshot joints{at(now), at(now), {0.3, 0.3}, {0.0, 0.0}};
    CommandedTrajectories commanded(model_, {});
    const PoseFindings nothing;
    const Braking braking;
    Causes causes;
    check_.judge(
        {at(now), map_, joints, commanded, here, ahead, nothing, nothing, braking, true, 1.0},
        causes);
    return causes;
  }

  const std::shared_ptr<const RobotModel> model_ = test::sliderModel();
  EvidenceCheck::Config config_;
  CuboidMap map_ = test::emptyMap();
  EvidenceCheck check_{test::checked(model_), config_};
};

TEST_F(EvidenceCheckTest, WhatWasLookedAtJustNowIsSeen) {
  const auto& found = find(10.5, 0.2);
  ASSERT_EQ(found.links.size(), 2U);
  EXPECT_EQ(found.unseen_fraction, 0.0);
  for (const LinkEvidence& link : found.links) {
    EXPECT_EQ(link.unseen_fraction, 0.0);
    EXPECT_EQ(link.old_fraction, 0.0);
    EXPECT_EQ(link.lost_fraction, 0.0);
  }
  EXPECT_NEAR(found.links[0].age_s.value_or(-1.0), 0.0, 1e-9);
  EXPECT_TRUE(check_.unseenPlaces().empty());
}

TEST_F(EvidenceCheckTest, ARobotAtRestGoesThroughNothing) {
  lookEverywhere({});
  const auto& found = find(10.5, 0.0);
  EXPECT_EQ(found.unseen_fraction, 0.0);
  EXPECT_EQ(found.links[0].new_volume_m3, 0.0);
}

TEST_F(EvidenceCheckTest, WhereNobodyLookedAllThatALinkGoesThroughIsUnseen) {
  lookEverywhere({});
  const auto& found = find(10.5, 0.2);
  EXPECT_EQ(found.unseen_fraction, 1.0);
  EXPECT_EQ(found.links[0].unseen_fraction, 1.0);
  EXPECT_EQ(found.links[1].new_volume_m3, 0.0) << "it stands still";
  // Halfway and at the end it is altogether where it is not now.
  EXPECT_NEAR(found.links[0].new_volume_m3, 4.0 / 3.0 * M_PI * std::pow(0.05, 3), 1e-5);
  EXPECT_FALSE(check_.unseenPlaces().empty());
}

/// Both links go through what nobody saw, one of them further.
TEST_F(EvidenceCheckTest, TheLinkMostOfWhoseWayIsUnseenIsNamed) {
  lookEverywhere({});
  for (const std::size_t further : {0U, 1U}) {
    std::vector<double> end{0.34, 0.34};
    end[further] = 0.6;
    const Causes causes = judge(10.5, end);
    ASSERT_EQ(causes.size(), 1U);
    EXPECT_EQ(causes[0].reason, Reason::kUnseenAhead);
    const bool is_hand = model_->variables()[further].name == "slide";
    EXPECT_EQ(causes[0].link, is_hand ? "hand" : "other");
  }
}

TEST_F(EvidenceCheckTest, WhereAnotherPartOfTheRobotIsNowIsNothingNew) {
  lookEverywhere({});
  Body now = bodyAt(0.3, 0.3), end = bodyAt(0.42, 0.3);
  now.poses[1] = end.poses[1] = placedAt(0.42, 0.0, 0.5);
  now.shapes[1] = end.shapes[1] = Sphere{0.06};
  const auto& found = check_.find(map_, at(10.5), now, end);
  // At the way's end it is inside of the other; halfway a part of it is neither here nor there.
  EXPECT_LT(found.links[0].new_volume_m3, 0.5 * 4.0 / 3.0 * M_PI * std::pow(0.05, 3));
}

TEST_F(EvidenceCheckTest, BehindASurfaceAndBehindTheRobotNothingIsSeen) {
  for (const auto end : {Seen::kSurface, Seen::kRobot, Seen::kUnclear}) {
    const LookImage::Pass pass{500, 500, 700, end};
    lookEverywhere({pass, pass});
    EXPECT_EQ(find(10.5, 0.2).unseen_fraction, 1.0) << static_cast<int>(end);
  }
}

TEST_F(EvidenceCheckTest, AShareOfTheDirectionsMakesAShareOfTheVolume) {
  lookOnly({}, [](double azimuth) { return azimuth > 0.0; });
  EXPECT_NEAR(find(10.5, 0.2).unseen_fraction, 0.5, 0.12);
}

TEST_F(EvidenceCheckTest, EvidenceGrowsOldAndThenTooOld) {
  const auto& fresh = find(10.5 + 1.49 * kPeriod, 0.0);
  EXPECT_EQ(fresh.links[0].old_fraction, 0.0);
  EXPECT_NEAR(fresh.links[0].age_s.value_or(-1.0), 1.49, 1e-9);
  const auto& old = find(10.5 + 1.51 * kPeriod, 0.0);
  EXPECT_EQ(old.links[0].old_fraction, 1.0);
  EXPECT_EQ(old.links[0].lost_fraction, 0.0);
  EXPECT_EQ(find(10.5 + 2.51 * kPeriod, 0.0).links[0].lost_fraction, 1.0);
}

TEST_F(EvidenceCheckTest, OldEvidenceSlowsTheRobotDownAndLostEvidenceStopsIt) {
  const std::vector<double> stands{0.3, 0.3};
  EXPECT_TRUE(judge(10.5 + 1.49 * kPeriod, stands).empty());
  const Causes old = judge(10.5 + 1.51 * kPeriod, stands);
  ASSERT_EQ(old.size(), 1U);
  EXPECT_EQ(old[0].reason, Reason::kEvidenceOld);
  EXPECT_EQ(old[0].level, Level::kSlow);
  const Causes lost = judge(10.5 + 2.51 * kPeriod, stands);
  ASSERT_EQ(lost.size(), 1U);
  EXPECT_EQ(lost[0].reason, Reason::kEvidenceOld);
  EXPECT_EQ(lost[0].level, Level::kStop);
}

TEST_F(EvidenceCheckTest, WhatIsUnseenSlowsTheRobotDownOrStopsItWhereThatIsWanted) {
  lookEverywhere({});
  for (const bool stops : {false, true}) {
    config_.unseen_stops = stops;
    check_ = EvidenceCheck(test::checked(model_), config_);
    const Causes causes = judge(10.5, {0.6, 0.6});
    ASSERT_EQ(causes.size(), 1U);
    EXPECT_EQ(causes[0].reason, Reason::kUnseenAhead);
    EXPECT_EQ(causes[0].level, stops ? Level::kStop : Level::kSlow);
  }
}

TEST_F(EvidenceCheckTest, TheAgeGoesOnGrowingUntilThePlaceIsLookedAtAgain) {
  EXPECT_NEAR(find(10.5 + 9.0 * kPeriod, 0.0).links[0].age_s.value_or(-1.0), 9.0, 1e-9);
}

TEST_F(EvidenceCheckTest, WhatWasNeverSeenHasNoAge) {
  lookEverywhere({});
  EXPECT_FALSE(find(10.5, 0.0).links[0].age_s);
  const LookImage::Pass before{500, 500, 100, Seen::kSurface};
  lookEverywhere({before, before});
  EXPECT_FALSE(find(10.5, 0.0).links[0].age_s) << "something stood before it";
}

TEST_F(EvidenceCheckTest, WhatIsTooOldWasNotSeen) {
  EXPECT_EQ(find(10.5 + 1.51 * kPeriod, 0.2).unseen_fraction, 1.0);
}

TEST_F(EvidenceCheckTest, ADirectionThatWasLookedInOnceOrFromElsewhereIsNoneThatTheSensorCovers) {
  const LookImage::Pass pass{500, 500, 9000, Seen::kNothing};
  LookImage::Pass moved = pass;
  moved.moved = true;
  for (const LookImage::Passes& passes :
       {LookImage::Passes{pass, {}}, LookImage::Passes{moved, moved}}) {
    lookEverywhere(passes);
    EXPECT_EQ(find(10.5, 0.2).unseen_fraction, 0.0) << "it is seen all the same";
    EXPECT_EQ(find(20.0, 0.0).links[0].lost_fraction, 0.0);
  }
}

TEST_F(EvidenceCheckTest, BesideDirectionsThatAreLookedInADirectionIsNotLost) {
  const LookImage::Pass newest{9000, 9000, 9000, Seen::kNothing};
  const LookImage::Pass before{8000, 8000, 9000, Seen::kNothing};
  int column = 0;
  lookOnly({newest, before}, [&column](double) { return ++column % 2 == 0; });
  EXPECT_EQ(find(19.0, 0.0).links[0].lost_fraction, 0.0);
}

TEST_F(EvidenceCheckTest, TheNextLookComesAPeriodAfterThatOfTheSameDirectionOfTheTilt) {
  // Looks at 10.0 s and 10.5 s.
  EXPECT_NEAR(*find(10.6, 0.0).links[0].next_look_s, 0.4, 1e-9);
  EXPECT_NEAR(*find(11.3, 0.0).links[0].next_look_s, 0.2, 1e-9);
  EXPECT_FALSE(find(12.0, 0.0).links[0].next_look_s) << "overdue";
}

TEST_F(EvidenceCheckTest, WithoutAPeriodAgesSayNothing) {
  map_.look_period = Duration::zero();
  const auto& found = find(100.0, 0.2);
  EXPECT_EQ(found.links[0].lost_fraction, 0.0);
  EXPECT_EQ(found.unseen_fraction, 0.0);
}

TEST_F(EvidenceCheckTest, LinksThatAreNotAskedForArePassedOver) {
  EvidenceCheck::Config config;
  config.links = {"oth*"};
  EvidenceCheck check(test::checked(model_), config);
  const auto& found = check.find(map_, at(10.5), bodyAt(0.3, 0.3), bodyAt(0.5, 0.3));
  ASSERT_EQ(found.links.size(), 1U);
  EXPECT_EQ(model_->links()[found.links[0].link], "other");
  config.links = {"nobody"};
  EXPECT_THROW(EvidenceCheck(test::checked(model_), config), ConfigError);
}

TEST_F(EvidenceCheckTest, TheSensorsOwnHousingIsPassedOver) {
  map_.viewpoint = Vector3(0.3, 0.0, 0.5);
  map_.looks.begin(at(10.0), map_.viewpoint);
  const auto& found = check_.find(map_, at(10.5), bodyAt(0.3, 0.3), bodyAt(0.32, 0.3));
  EXPECT_EQ(found.links[0].new_volume_m3, 0.0);
}

TEST_F(EvidenceCheckTest, WhatIsOutOfRangeIsRefusedByItsName) {
  const auto refused = [this](auto member, double value, const std::string& name) {
    EvidenceCheck::Config config;
    config.*member = value;
    try {
      EvidenceCheck check(test::checked(model_), config);
      ADD_FAILURE() << name;
    } catch (const ConfigError& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  };
  refused(&EvidenceCheck::Config::margin_m, -1.0, "evidence_margin_m");
  refused(&EvidenceCheck::Config::slow_periods, 0.5, "evidence_slow_periods");
  refused(&EvidenceCheck::Config::stop_periods, 1.2, "evidence_stop_periods");
  refused(&EvidenceCheck::Config::old_fraction_max, 1.2, "evidence_old_fraction_max");
  refused(&EvidenceCheck::Config::unseen_fraction_max, -0.1, "unseen_fraction_max");
  refused(&EvidenceCheck::Config::unseen_volume_min_m3, -0.1, "unseen_volume_min_m3");
  refused(&EvidenceCheck::Config::slow_scale, 1.1, "unseen_slow_scale");
}

}  // namespace
}  // namespace tccm
