/// A laser above and a camera beside the slider robot: one answer of both.

#include <gtest/gtest.h>

#include <string>

#include "support/checker_fixture.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using test::at;
using test::kScanPeriod;
using test::kStart;

constexpr std::size_t kLaser = 0, kCamera = 1;

class SeveralSensorsTest : public test::CheckerFixture {
 protected:
  SeveralSensorsTest() { remakeWithCamera(true); }

  void remakeWithCamera(bool required) {
    config_.inputs.sensors = {{"laser", true}, {"camera", required}};
    remake();
  }

  /// As the camera sees it: from the side, with what it looked at.
  static CuboidMap seenByCamera(const CuboidMap& map) {
    CuboidMap seen = map;
    seen.viewpoint = Vector3(0.5, -1.6, 0.6);
    test::lookAround(seen);
    return seen;
  }

  void setMapOf(std::size_t sensor, double now, const CuboidMap& map, double stamp) {
    auto copy = std::make_shared<CuboidMap>(map);
    copy->stamp = at(stamp);
    copy->serial = ++serial_;
    test::refreshLooks(*copy);
    checker_->setMap(at(now), copy, sensor);
  }
  void feedRobot(double now, double slide, double velocity) {
    setRoot(now);
    addJoints(now, slide, velocity);
  }
  /// Both sensors, for as long as a stop takes to be released.
  const Verdict& runBoth(double from, double to, const CuboidMap& laser, const CuboidMap& camera,
                         double slide = 0.0, double velocity = 0.0) {
    for (double now = from; now < to; now += kScanPeriod) {
      feedRobot(now, slide, velocity);
      setMapOf(kLaser, now, laser, now);
      setMapOf(kCamera, now, camera, now);
      check(now);
    }
    return check(to - 0.5 * kScanPeriod);
  }
  /// The laser goes on alone.
  const Verdict& runLaser(double from, double to, const CuboidMap& laser, double slide = 0.0) {
    for (double now = from; now < to; now += kScanPeriod) {
      feedRobot(now, slide, 0.0);
      setMapOf(kLaser, now, laser, now);
      check(now);
    }
    return check(to - 0.5 * kScanPeriod);
  }
  [[nodiscard]] static bool names(const Verdict& verdict, const std::string& sensor) {
    return verdict.detail.find("'" + sensor + "'") != std::string::npos;
  }

  const CuboidMap clear_to_camera_ = seenByCamera(clear_);
  const CuboidMap post_to_camera_ = seenByCamera(post_);
  static constexpr double kAtThePost = 0.75;
};

TEST_F(SeveralSensorsTest, WithNothingNearAllIsClear) {
  EXPECT_EQ(runBoth(kStart, kStart + 2.0, clear_, clear_to_camera_).reason, Reason::kClear);
}

TEST_F(SeveralSensorsTest, AContactWithEithersMapIsAContact) {
  // Neither has looked since the other saw the post.
  const auto touch = [&](const CuboidMap& laser, const CuboidMap& camera) {
    remake();
    const double now = kStart;
    feedRobot(now, kAtThePost, 0.0);
    setMapOf(kLaser, now, laser, now);
    setMapOf(kCamera, now, camera, now);
    return check(now).reason;
  };
  EXPECT_EQ(touch(post_, post_to_camera_), Reason::kCollision);
  EXPECT_EQ(touch(post_, clear_to_camera_), Reason::kCollision);
  EXPECT_EQ(touch(clear_, post_to_camera_), Reason::kCollision);
  EXPECT_EQ(touch(clear_, clear_to_camera_), Reason::kClear);
}

TEST_F(SeveralSensorsTest, WhatHasAppearedToOneStopsTheRobotUntilThatOneFails) {
  remakeWithCamera(false);
  CuboidMap appeared = post_to_camera_;
  for (Cuboid& cuboid : appeared.cuboids) cuboid.appeared = true;
  appeared.appeared = static_cast<std::uint32_t>(appeared.cuboids.size());
  const double near = 0.64;  // 110 mm before the post
  const Verdict& verdict = runBoth(kStart, kStart + 1.0, clear_, appeared, near);
  EXPECT_EQ(verdict.reason, Reason::kApproached);
  EXPECT_FALSE(verdict.collision);
  EXPECT_EQ(runBoth(kStart + 1.0, kStart + 4.0, clear_, post_to_camera_, near).reason,
            Reason::kClear)
      << "it stands there";
  EXPECT_EQ(checker_->map()->appeared, 0U);
  EXPECT_EQ(runBoth(kStart + 4.0, kStart + 5.0, clear_, appeared, near).reason,
            Reason::kApproached);
  EXPECT_NE(runLaser(kStart + 5.0, kStart + 9.0, clear_, near).reason, Reason::kApproached);
}

TEST_F(SeveralSensorsTest, WhatASensorThatFailedHasLeftBehindHasNotAppeared) {
  remakeWithCamera(false);
  CuboidMap camera = post_to_camera_, laser = clear_;
  for (Cuboid& cuboid : camera.cuboids) cuboid.appeared = true;
  camera.appeared = static_cast<std::uint32_t>(camera.cuboids.size());
  camera.hold = fromSeconds(10.0);
  laser.looks.clear();  // it does not see the post's place
  runBoth(kStart, kStart + 1.0, laser, camera);
  EXPECT_EQ(checker_->map()->appeared, camera.cuboids.size());
  runLaser(kStart + 1.0, kStart + 4.0, laser);
  ASSERT_EQ(checker_->map()->cuboids.size(), camera.cuboids.size());
  EXPECT_EQ(checker_->map()->appeared, 0U);
  for (const Cuboid& cuboid : checker_->map()->cuboids) EXPECT_NE(cuboid.held, cuboid.appeared);
}

TEST_F(SeveralSensorsTest, WhereOneLookedThroughWhatTheOtherSawTimeDecides) {
  CuboidMap old_post = post_;
  const auto reasonOfAge = [&](std::uint32_t unseen_ms) {
    for (Cuboid& cuboid : old_post.cuboids) cuboid.unseen_ms = unseen_ms;
    remake();
    feedRobot(kStart, kAtThePost, 0.0);
    setMapOf(kLaser, kStart, old_post, kStart);
    setMapOf(kCamera, kStart, clear_to_camera_, kStart - 0.01);
    return check(kStart).reason;
  };
  EXPECT_EQ(reasonOfAge(5), Reason::kCollision) << "seen after the camera looked";
  EXPECT_EQ(reasonOfAge(200), Reason::kClear) << "the camera looked through it since";
}

TEST_F(SeveralSensorsTest, ALookThatEndsAtAThingDoesNotOverruleIt) {
  CuboidMap old_post = post_;
  for (Cuboid& cuboid : old_post.cuboids) cuboid.unseen_ms = 400;
  feedRobot(kStart, kAtThePost, 0.0);
  setMapOf(kLaser, kStart, old_post, kStart);
  CuboidMap camera = post_to_camera_;  // it saw the post and, say, dropped its returns
  camera.cuboids.clear();
  indexCells(camera);
  setMapOf(kCamera, kStart, camera, kStart);
  EXPECT_EQ(reasonAt(kStart), Reason::kCollision);
}

TEST_F(SeveralSensorsTest, ARequiredSensorThatFailsIsAFaultThatNamesIt) {
  runBoth(kStart, kStart + 2.0, clear_, clear_to_camera_);
  const Verdict& verdict = runLaser(kStart + 2.0, kStart + 2.6, clear_);
  EXPECT_EQ(verdict.reason, Reason::kNoMap);
  EXPECT_EQ(verdict.level, Level::kFault);
  EXPECT_TRUE(names(verdict, "camera")) << verdict.detail;
  EXPECT_EQ(runBoth(kStart + 2.6, kStart + 5.0, clear_, clear_to_camera_).reason, Reason::kClear);
}

TEST_F(SeveralSensorsTest, EachFaultOfARequiredSensorNamesIt) {
  const auto verdictOn = [&](const ScanReport& report, const CuboidMap& camera) {
    remake();
    runBoth(kStart, kStart + 1.0, clear_, clear_to_camera_);
    for (double now = kStart + 1.0; now < kStart + 2.0; now += kScanPeriod) {
      feedRobot(now, 0.0, 0.0);
      setMapOf(kLaser, now, clear_, now);
      checker_->addScanReport(at(now), {at(now), ScanReport::Outcome::kWaiting}, kCamera);
      checker_->addScanReport(at(now), report, kCamera);
      if (report.dropped.empty()) setMapOf(kCamera, now, camera, now);
      check(now);
    }
    return check(kStart + 2.0);
  };
  const auto dropped = [](const std::string& why) {
    ScanReport report{at(kStart + 1.0), ScanReport::Outcome::kDropped, why};
    return report;
  };
  const ScanReport fine{at(kStart + 1.0), ScanReport::Outcome::kAssembled};
  CuboidMap overflowed = clear_to_camera_, stopped = clear_to_camera_, own = clear_to_camera_;
  overflowed.overflowed = true;
  stopped.tilt_stopped = true;
  own.self_share = 0.95;
  for (const auto& [verdict, reason] :
       {std::pair(verdictOn(dropped("blind"), clear_to_camera_), Reason::kBlind),
        std::pair(verdictOn(dropped("no_transform"), clear_to_camera_), Reason::kNoTransform),
        std::pair(verdictOn(dropped("frame_changed"), clear_to_camera_), Reason::kFrameChanged),
        std::pair(verdictOn(fine, overflowed), Reason::kMapOverflow),
        std::pair(verdictOn(fine, stopped), Reason::kSweepIncomplete),
        std::pair(verdictOn(fine, own), Reason::kBlind)}) {
    EXPECT_EQ(verdict.reason, reason) << name(verdict.reason);
    EXPECT_TRUE(names(verdict, "camera")) << verdict.detail;
  }
}

TEST_F(SeveralSensorsTest, OneThatIsNotRequiredMayGoAndIsNamedAside) {
  remakeWithCamera(false);
  EXPECT_EQ(runBoth(kStart, kStart + 2.0, clear_, clear_to_camera_).reason, Reason::kClear);
  EXPECT_EQ(checker_->inputs().outText(kCamera), "");
  EXPECT_EQ(runLaser(kStart + 2.0, kStart + 4.0, clear_).reason, Reason::kClear);
  EXPECT_NE(checker_->inputs().outText(kCamera).find("'camera'"), std::string::npos);
}

TEST_F(SeveralSensorsTest, OneThatIsNotRequiredNeedNotComeAtAll) {
  remakeWithCamera(false);
  EXPECT_EQ(runLaser(kStart, kStart + 2.0, clear_).reason, Reason::kClear);
  EXPECT_NE(checker_->inputs().outText(kCamera), "");
}

TEST_F(SeveralSensorsTest, WhatAFailedSensorSawIsHeldForAsLongAsItsMapperWould) {
  remakeWithCamera(false);
  CuboidMap blind_to_it = clear_;  // the laser does not look there
  blind_to_it.looks.clear();
  CuboidMap camera = post_to_camera_;
  camera.hold = fromSeconds(3.0);
  runBoth(kStart, kStart + 1.0, blind_to_it, camera);
  const auto touches = [&](double from, double to) {
    return runLaser(from, to, blind_to_it, kAtThePost).collision;
  };
  EXPECT_TRUE(touches(kStart + 1.0, kStart + 2.0));
  EXPECT_TRUE(checker_->map()->cuboids.front().held);
  EXPECT_TRUE(touches(kStart + 2.0, kStart + 3.9));
  EXPECT_FALSE(touches(kStart + 3.9, kStart + 4.2));
}

TEST_F(SeveralSensorsTest, WhatAFailedSensorSawGoesOnceAnotherLooksThroughIt) {
  remakeWithCamera(false);
  CuboidMap camera = post_to_camera_;
  camera.hold = fromSeconds(60.0);
  runBoth(kStart, kStart + 1.0, post_, camera);
  EXPECT_TRUE(runLaser(kStart + 1.0, kStart + 2.0, post_, kAtThePost).collision);
  EXPECT_FALSE(runLaser(kStart + 2.0, kStart + 4.0, clear_, kAtThePost).collision);
}

TEST_F(SeveralSensorsTest, WhatOnlyAFailedSensorSawGrowsOldByPlace) {
  remakeWithCamera(false);
  CuboidMap blind_to_it = clear_;
  blind_to_it.looks.clear();
  EXPECT_EQ(runBoth(kStart, kStart + 2.0, blind_to_it, clear_to_camera_).reason, Reason::kClear);
  const Verdict& later = runLaser(kStart + 2.0, kStart + 4.0, blind_to_it);
  EXPECT_EQ(later.reason, Reason::kEvidenceOld);
  EXPECT_EQ(later.level, Level::kSlow);
  EXPECT_EQ(runLaser(kStart + 4.0, kStart + 6.0, blind_to_it).level, Level::kStop);
}

TEST_F(SeveralSensorsTest, ALinkThatAFailedSensorSawIsHiddenOnceThatIsOld) {
  remakeWithCamera(false);
  EXPECT_FALSE(runBoth(kStart, kStart + 1.0, shelf_, clear_to_camera_).occlusion);
  EXPECT_TRUE(runLaser(kStart + 1.0, kStart + 4.0, shelf_).occlusion);
}

TEST_F(SeveralSensorsTest, WhatASensorSaysThatFailsIsNoEvidence) {
  remakeWithCamera(false);
  CuboidMap blind_to_it = clear_, failing = clear_to_camera_;
  blind_to_it.looks.clear();
  runBoth(kStart, kStart + 1.0, blind_to_it, clear_to_camera_);
  failing.self_share = 0.95;  // its looks go on
  EXPECT_EQ(runBoth(kStart + 1.0, kStart + 5.0, blind_to_it, failing).reason, Reason::kEvidenceOld);
  EXPECT_NE(checker_->inputs().outText(kCamera), "");
}

TEST_F(SeveralSensorsTest, ASensorThatWasNeverWholeHasSeenNothing) {
  remakeWithCamera(false);
  CuboidMap blind_to_it = clear_, filling = clear_to_camera_;
  blind_to_it.looks.clear();
  filling.complete = false;
  filling.look_period = Duration::zero();
  EXPECT_EQ(runBoth(kStart, kStart + 0.5, blind_to_it, filling, 0.0, 0.5).unseen_fraction, 1.0);
}

TEST_F(SeveralSensorsTest, WhatASensorSeesThatFailsIsAnObstacleAllTheSame) {
  remakeWithCamera(false);
  CuboidMap filling = post_to_camera_;
  filling.complete = false;
  filling.hold = fromSeconds(1.0);
  EXPECT_TRUE(runBoth(kStart, kStart + 0.5, clear_, filling, kAtThePost).collision);
}

TEST_F(SeveralSensorsTest, WhatASensorSawWhoseMapBeginsAnewIsAnObstacleAllTheSame) {
  remakeWithCamera(false);
  CuboidMap blind_to_it = clear_;
  blind_to_it.looks.clear();
  CuboidMap sees = post_to_camera_, begun = clear_to_camera_, cleared = clear_to_camera_;
  sees.hold = fromSeconds(1.0);
  begun.complete = cleared.complete = false;
  begun.hold = cleared.hold = sees.hold;
  cleared.looks.clear();
  runBoth(kStart, kStart + 0.5, blind_to_it, sees);
  EXPECT_TRUE(runBoth(kStart + 0.5, kStart + 1.3, blind_to_it, begun, kAtThePost).collision);
  EXPECT_FALSE(runBoth(kStart + 1.3, kStart + 1.7, blind_to_it, begun, kAtThePost).collision)
      << "no longer than it would be held";
  remakeWithCamera(false);
  runBoth(kStart, kStart + 0.5, blind_to_it, sees);
  EXPECT_FALSE(runBoth(kStart + 0.5, kStart + 1.0, blind_to_it, cleared, kAtThePost).collision)
      << "that is what clear_map is for";
}

TEST_F(SeveralSensorsTest, WhatASensorSawWhoseMapIsClearedIsNoEvidence) {
  remakeWithCamera(false);
  CuboidMap blind_to_it = clear_, cleared = clear_to_camera_;
  blind_to_it.looks.clear();
  cleared.looks.clear();
  cleared.complete = false;
  runBoth(kStart, kStart + 1.0, blind_to_it, clear_to_camera_);
  EXPECT_EQ(runBoth(kStart + 1.0, kStart + 1.1, blind_to_it, cleared, 0.0, 0.5).unseen_fraction,
            1.0);
}

TEST_F(SeveralSensorsTest, WhatASensorSawOfOtherCellsIsNoEvidence) {
  remakeWithCamera(false);
  CuboidMap blind_to_it = clear_;
  blind_to_it.looks.clear();
  runBoth(kStart, kStart + 1.0, blind_to_it, clear_to_camera_);
  Grid::Config lower = blind_to_it.grid.config();  // its mapper was started anew
  lower.height_min_m -= 0.1;
  blind_to_it.grid = Grid(lower);
  EXPECT_EQ(
      runBoth(kStart + 1.0, kStart + 1.1, blind_to_it, clear_to_camera_, 0.0, 0.5).unseen_fraction,
      1.0);
}

TEST_F(SeveralSensorsTest, NoLookOfAFailedSensorIsDue) {
  config_.governed_speed.appear_distance_m = 0.15;
  CuboidMap slow = clear_, quick = clear_to_camera_, elsewhere = clear_to_camera_;
  slow.look_period = fromSeconds(2.0);
  quick.look_period = fromSeconds(0.6);
  elsewhere.looks.clear();
  const auto scaleOnceFailed = [&](const CuboidMap& camera) {
    remakeWithCamera(false);
    runBoth(kStart, kStart + 0.3, slow, camera, 0.1, 0.5);
    for (double now = kStart + 0.3; now < kStart + 0.6; now += kScanPeriod) {
      feedRobot(now, 0.1, 0.5);
      setMapOf(kLaser, now, slow, now);
      check(now);
    }
    EXPECT_NE(checker_->inputs().outText(kCamera), "");
    return check(kStart + 0.6).governed_scale;
  };
  EXPECT_EQ(scaleOnceFailed(quick), scaleOnceFailed(elsewhere));
}

TEST_F(SeveralSensorsTest, EvidenceIsAsOldAsTheNewestLookAlsoWhereTheRobotItselfStands) {
  remakeWithCamera(false);
  CuboidMap at_the_robot = clear_;
  for (int row = 0; row < at_the_robot.looks.grid().rows(); ++row) {
    for (int column = 0; column < at_the_robot.looks.grid().columns(); ++column) {
      for (LookImage::Pass& pass : at_the_robot.looks.edit(row, column)) {
        pass.end = Seen::kRobot;
        pass.range_mm = 100;
      }
    }
  }
  runBoth(kStart, kStart + 2.0, at_the_robot, clear_to_camera_);
  EXPECT_EQ(runLaser(kStart + 2.0, kStart + 6.0, at_the_robot).reason, Reason::kClear);
}

TEST_F(SeveralSensorsTest, AQuestionIsAnsweredByTheNewestMaps) {
  runBoth(kStart, kStart + 2.0, clear_, clear_to_camera_);
  const double now = kStart + 2.0;
  const auto asked = [&] {
    return checker_->checkState(at(now), {"slide"}, {kAtThePost}).cause.reason;
  };
  EXPECT_EQ(asked(), Reason::kClear);
  setMapOf(kCamera, now, post_to_camera_, now);
  EXPECT_EQ(asked(), Reason::kCollision);
}

TEST_F(SeveralSensorsTest, WhatOneSawLatelyIsSeen) {
  CuboidMap blind_to_it = clear_;
  blind_to_it.looks.clear();
  const auto unseen = [&](const CuboidMap& laser, const CuboidMap& camera) {
    remake();
    return runBoth(kStart, kStart + 0.5, laser, camera, 0.0, 0.5).unseen_fraction;
  };
  CuboidMap camera_blind = clear_to_camera_;
  camera_blind.looks.clear();
  EXPECT_EQ(unseen(clear_, camera_blind), 0.0);
  EXPECT_EQ(unseen(blind_to_it, clear_to_camera_), 0.0);
  EXPECT_EQ(unseen(blind_to_it, camera_blind), 1.0);
}

TEST_F(SeveralSensorsTest, ALinkIsHiddenWhereNoSensorSeesIt) {
  CuboidMap wall = clear_;
  test::addBlock(wall, {Vector3(-0.3 + 0.3, -0.5, 0.2), Vector3(1.2, -0.46, 0.9)});
  const CuboidMap wall_to_camera = seenByCamera(wall);
  const auto hidden = [&](const CuboidMap& laser, const CuboidMap& camera) {
    remake();
    return runBoth(kStart, kStart + 0.5, laser, camera, 0.3).occlusion;
  };
  EXPECT_FALSE(hidden(clear_, clear_to_camera_));
  EXPECT_FALSE(hidden(shelf_, clear_to_camera_));
  EXPECT_FALSE(hidden(clear_, wall_to_camera));
  EXPECT_TRUE(hidden(shelf_, wall_to_camera));
  CuboidMap looks_elsewhere = clear_to_camera_;
  looks_elsewhere.looks.clear();
  EXPECT_TRUE(hidden(shelf_, looks_elsewhere));
}

TEST_F(SeveralSensorsTest, TheNextLookIsTheEarliestOfAny) {
  config_.governed_speed.appear_distance_m = 0.15;
  CuboidMap slow = clear_, quick = clear_to_camera_, quick_elsewhere = clear_to_camera_;
  slow.look_period = fromSeconds(2.0);
  quick.look_period = fromSeconds(0.6);
  quick_elsewhere.looks.clear();
  const auto scale = [&](const CuboidMap& laser, const CuboidMap& camera) {
    remake();
    return runBoth(kStart, kStart + 0.3, laser, camera, 0.1, 0.5).governed_scale;
  };
  const double alone = scale(slow, quick_elsewhere);
  EXPECT_LT(alone, 0.3);
  EXPECT_GT(scale(slow, quick), 1.5 * alone);
}

TEST_F(SeveralSensorsTest, MapsOfDifferentCellsAreAFault) {
  Grid::Config other;
  other.cell_size_m = 0.05;
  CuboidMap coarse = test::emptyMap(other);
  coarse.viewpoint = Vector3(0.5, -1.6, 0.6);
  coarse.window = fromSeconds(1.0);
  test::lookAround(coarse);
  const Verdict& verdict = runBoth(kStart, kStart + 1.0, clear_, coarse);
  EXPECT_EQ(verdict.reason, Reason::kNoMap);
  EXPECT_TRUE(names(verdict, "camera")) << verdict.detail;
}

TEST_F(SeveralSensorsTest, NamesThatSayNothingAreRefused) {
  const auto refused = [&](std::vector<SensorInput::Config> sensors) {
    config_.inputs.sensors = std::move(sensors);
    EXPECT_THROW(remake(), ConfigError);
  };
  refused({{"", true}});
  refused({{"laser", true}, {"laser", false}});
  refused({{"laser", false}, {"camera", false}});
}

}  // namespace
}  // namespace tccm
