#include "nodelets/status_conversions.h"

#include <gtest/gtest.h>
#include <ros/serialization.h>

#include <cmath>
#include <limits>

#include "ros/conversions.h"
#include "support/cuboid_scene.h"
#include "support/look_around.h"
#include "support/random.h"
#include "support/tiny_robot.h"

namespace tccm {
namespace {

using tccm_monitor::LinkStatus;

Time at(double seconds) { return Time(fromSeconds(seconds)); }

/// Empty surroundings, seen from above.
CuboidMap emptyScene() {
  CuboidMap map = test::emptyMap();
  map.stamp = at(100.0);
  map.viewpoint = Vector3(0.0, 0.0, 2.0);
  test::lookAround(map);
  return map;
}

/// With a cuboid where the hand is at x = 0.5 m.
CuboidMap sceneWithCuboid() {
  CuboidMap map = emptyScene();
  test::addCuboid(map, *map.grid.cellOf(Vector3(0.5, 0.01, 0.5)), 0.45, 0.55);
  test::lookAround(map);
  return map;
}

/// All bytes of a message: what is not known is like itself there.
std::vector<std::uint8_t> bytesOf(const tccm_monitor::MonitorStatus& status) {
  const ros::SerializedMessage message = ros::serialization::serializeMessage(status);
  return {message.buf.get(), message.buf.get() + message.num_bytes};
}

class VerdictConversionTest : public ::testing::Test {
 protected:
  VerdictConversionTest() : checker_(test::sliderModel(), {}) {}

  /// The verdict on a map, for hands at x and 0.3 m beside it.
  const Verdict& judge(const CuboidMap& map, double x, double velocity) {
    checker_.startAnew();
    const Time now = map.stamp + fromSeconds(0.01);
    checker_.setRootPose(0, Time(), Pose::Identity(), true);
    for (const double before : {0.04, 0.0}) {
      checker_.addJoints(now, now - fromSeconds(before), {"slide", "glide"},
                         {x - before * velocity, 0.3}, {velocity, 0.0});
    }
    checker_.setMap(now, std::make_shared<const CuboidMap>(map));
    return checker_.check(now);
  }
  /// What is said of a link at the present pose, or at the one ahead.
  static LinkStatus entryOf(const tccm_monitor::MonitorStatus& status, const std::string& link,
                            bool ahead = false) {
    for (const LinkStatus& entry : status.links) {
      if (entry.link == link && (entry.ahead != 0) == ahead) return entry;
    }
    ADD_FAILURE() << "nothing is said of " << link;
    return {};
  }
  tccm_monitor::MonitorStatus statusOf(const Verdict& verdict) {
    return tccm::statusOf(verdict, checker_);
  }

  Checker checker_;
};

TEST_F(VerdictConversionTest, AClearVerdictIsOK) {
  const CuboidMap map = emptyScene();
  const auto status = statusOf(judge(map, 0.2, 0.0));
  EXPECT_EQ(status.level, tccm_monitor::MonitorStatus::OK);
  EXPECT_EQ(status.reason, "CLEAR");
  EXPECT_EQ(status.detail, "");
  EXPECT_TRUE(status.known);
  EXPECT_FALSE(status.stop || status.collision || status.occlusion);
  EXPECT_EQ(status.serial, 1U);
  EXPECT_EQ(toTime(status.map_stamp), map.stamp);
  EXPECT_EQ(toTime(status.joints_stamp), map.stamp + fromSeconds(0.01));
  EXPECT_EQ(toTime(status.header.stamp), map.stamp + fromSeconds(0.01));
  EXPECT_TRUE(status.flagged.empty());
}

TEST_F(VerdictConversionTest, ACollisionNamesLinkAndCuboid) {
  const CuboidMap map = sceneWithCuboid();
  const auto status = statusOf(judge(map, 0.5, 0.0));
  EXPECT_EQ(status.level, tccm_monitor::MonitorStatus::STOP);
  EXPECT_EQ(status.reason, "COLLISION");
  EXPECT_EQ(status.link, "hand");
  EXPECT_TRUE(status.stop && status.collision && status.known);
  ASSERT_GE(status.flagged.size(), 1U);
  EXPECT_EQ(status.flagged[0].cell, map.cuboids[0].cell);
  EXPECT_FLOAT_EQ(status.flagged[0].bottom, 0.45F);
  EXPECT_FLOAT_EQ(status.flagged[0].top, 0.55F);
  EXPECT_EQ(status.flagged[0].col, tccm_monitor::Cuboid::COLLISION);
  ASSERT_GE(status.links.size(), 1U);
  for (const auto& link : status.links) EXPECT_EQ(link.collision, link.link == "hand");
}

TEST_F(VerdictConversionTest, ACollisionAheadIsSaidOfThePoseAheadAlone) {
  const auto status = statusOf(judge(sceneWithCuboid(), 0.25, 0.5));
  EXPECT_EQ(status.reason, "COLLISION_AHEAD");
  for (const auto& link : status.links) {
    EXPECT_EQ(link.collision, link.ahead && link.link == "hand");
  }
}

TEST_F(VerdictConversionTest, WithoutAMapTheStatusSaysSo) {
  tccm_monitor::MonitorStatus status = statusOf(checker_.check(at(100.0)));
  EXPECT_TRUE(status.stop);
  EXPECT_FALSE(status.known);
  EXPECT_EQ(status.reason, "INIT");
  EXPECT_TRUE(status.map_stamp.isZero());
  EXPECT_TRUE(std::isnan(status.unseen_fraction));
  EXPECT_TRUE(std::isnan(status.governed_scale));
  EXPECT_TRUE(status.links.empty());
  status = statusOf(checker_.check(at(101.0)));
  EXPECT_EQ(status.level, tccm_monitor::MonitorStatus::FAULT);
}

TEST_F(VerdictConversionTest, WhatIsKnownOfALinksWayIsSaidAtItsPresentPose) {
  const auto status = statusOf(judge(emptyScene(), 0.2, 0.3));
  EXPECT_EQ(status.unseen_fraction, 0.0F);
  EXPECT_EQ(status.governed_scale, 1.0F);
  const LinkStatus hand = entryOf(status, "hand");
  EXPECT_EQ(hand.way_unseen_fraction, 0.0F);
  EXPECT_NEAR(hand.evidence_age, 0.01F, 1e-4F) << "looked at 10 ms before the check";
  EXPECT_NEAR(hand.next_look, 0.49F, 1e-4F) << "half a period later, on the other stroke";
  const LinkStatus ahead = entryOf(status, "hand", true);
  EXPECT_EQ(ahead.visible_fraction, 1.0F);
  EXPECT_TRUE(std::isnan(ahead.way_unseen_fraction));
  EXPECT_TRUE(std::isnan(ahead.evidence_age));
  EXPECT_TRUE(std::isnan(ahead.next_look));
}

TEST_F(VerdictConversionTest, OfAWayThatWasNeverSeenNoAgeIsSaidAndNoLookIsDue) {
  CuboidMap map = emptyScene();
  map.looks.clear();
  const auto status = statusOf(judge(map, 0.2, 0.3));
  EXPECT_EQ(status.level, tccm_monitor::MonitorStatus::SLOW);
  EXPECT_EQ(status.reason, "UNSEEN_AHEAD");
  EXPECT_EQ(status.unseen_fraction, 1.0F);
  const LinkStatus hand = entryOf(status, "hand");
  EXPECT_EQ(hand.way_unseen_fraction, 1.0F);
  EXPECT_TRUE(std::isnan(hand.evidence_age));
  EXPECT_EQ(hand.next_look, std::numeric_limits<float>::infinity());
  EXPECT_EQ(hand.unseen_fraction, 1.0F);
  EXPECT_EQ(hand.visible_fraction, 0.0F);
  EXPECT_EQ(entryOf(status, "other").way_unseen_fraction, 0.0F) << "it goes nowhere";
}

TEST_F(VerdictConversionTest, TheAgeGoesOnGrowingWhereTheSensorLooksNoMore) {
  CuboidMap map = emptyScene();
  map.stamp += fromSeconds(1.99);
  auto status = statusOf(judge(map, 0.2, 0.0));
  EXPECT_EQ(status.level, tccm_monitor::MonitorStatus::SLOW);
  EXPECT_EQ(status.reason, "EVIDENCE_OLD");
  EXPECT_NEAR(entryOf(status, "hand").evidence_age, 2.0F, 1e-4F);
  EXPECT_EQ(entryOf(status, "hand").next_look, std::numeric_limits<float>::infinity());
  map.stamp += fromSeconds(1.0);
  status = statusOf(judge(map, 0.2, 0.0));
  EXPECT_EQ(status.level, tccm_monitor::MonitorStatus::STOP);
  EXPECT_NEAR(entryOf(status, "hand").evidence_age, 3.0F, 1e-4F);
}

TEST_F(VerdictConversionTest, TheSharesOfASilhouetteAddUpToOne) {
  CuboidMap map = emptyScene();
  test::addBlock(map, UprightBox(Vector3(0.1, -0.2, 1.0), Vector3(0.4, 0.0, 1.1)));
  test::lookAround(map);
  const LinkStatus hand = entryOf(statusOf(judge(map, 0.5, 0.0)), "hand");
  EXPECT_GT(hand.occluded_fraction, 0.2F);
  EXPECT_GT(hand.visible_fraction, 0.1F);
  EXPECT_EQ(hand.unseen_fraction, 0.0F);
  EXPECT_NEAR(hand.occluded_fraction + hand.visible_fraction, 1.0F, 1e-5F);
  EXPECT_TRUE(hand.occlusion);
}

TEST_F(VerdictConversionTest, HeldCuboidsAreCountedAmongTheMaps) {
  CuboidMap map = emptyScene();
  for (const double x : {0.9, 1.0, 1.1}) {
    test::addCuboid(map, *map.grid.cellOf(Vector3(x, 0.01, 0.5)), 0.2, 0.25);
  }
  map.cuboids[0].held = map.cuboids[2].held = true;
  const auto status = statusOf(judge(map, 0.2, 0.0));
  EXPECT_EQ(status.cuboids, 3U);
  EXPECT_EQ(status.held, 2U);
}

TEST_F(VerdictConversionTest, ExemptionsSayWhereTheyAreAndWhyTheyAreNotInForce) {
  const CuboidMap map = emptyScene();
  judge(map, 0.2, 0.0);
  Exemption exemption{"gripper", "hand", {Sphere{0.1}, Pose::Identity()}, {}};
  exemption.region.pose.translation().x() = 0.25;
  exemption.frame = "hand";
  checker_.addExemption(map.stamp, exemption, 1.0);
  exemption.link = "other";
  exemption.frame = "cup";
  exemption.with_goal = true;
  checker_.addExemption(map.stamp, exemption, 1.0);
  checker_.reportGoal(map.stamp, "gripper", "1", true);
  const Verdict& verdict = checker_.check(map.stamp + fromSeconds(0.01));
  const auto status = statusOf(verdict);
  ASSERT_EQ(status.exemptions.size(), 2U);
  const auto& in_force = status.exemptions[0];
  EXPECT_EQ(in_force.owner, "gripper");
  EXPECT_EQ(in_force.link, "hand");
  EXPECT_EQ(in_force.frame, "hand");
  EXPECT_FALSE(in_force.with_goal);
  EXPECT_EQ(in_force.why_not, "");
  EXPECT_EQ(in_force.until, toRos(map.stamp + fromSeconds(1.0)));
  EXPECT_NEAR(in_force.region.pose.position.x, 0.25, 1e-9);
  EXPECT_NEAR(in_force.pose.position.x, 0.45, 1e-9);
  EXPECT_NEAR(in_force.pose.position.z, 0.5, 1e-9);
  const auto& other = status.exemptions[1];
  EXPECT_EQ(other.frame, "cup");
  EXPECT_TRUE(other.with_goal);
  EXPECT_NE(other.why_not.find("'cup'"), std::string::npos) << other.why_not;
  EXPECT_EQ(other.pose, geometry_msgs::Pose()) << "it is not known";
}

TEST_F(VerdictConversionTest, AMapThatWentThroughAMessageGivesTheVeryVerdict) {
  test::Random random(2);
  std::size_t collisions = 0, occlusions = 0;
  for (int i = 0; i < 300; ++i) {
    const Grid::Config grid{random.uniform(-0.1, 0.2), -0.3, 0.8, 1.0, 0.0, 2.0, 0.02, 0.001};
    CuboidMap map = test::randomMap(random, grid, random.uniform(0.0, 0.2));
    map.stamp = at(100.0 + i);
    map.viewpoint = Vector3(random.uniform(-0.5, 0.0), random.uniform(-0.5, 0.5), 0.7);
    test::lookAround(map);
    tccm_monitor::CuboidMap message;
    toMessage(map, "base", message);
    CuboidMap back;
    ASSERT_EQ(fromMessage(message, back), "");
    const double x = random.uniform(-0.3, 0.9), velocity = random.uniform(-0.5, 0.5);
    const auto direct = statusOf(judge(map, x, velocity));
    const auto through = statusOf(judge(back, x, velocity));
    ASSERT_EQ(bytesOf(direct), bytesOf(through));
    collisions += direct.collision ? 1 : 0;
    occlusions += direct.occlusion ? 1 : 0;
  }
  EXPECT_GT(collisions, 20U);
  EXPECT_GT(occlusions, 20U);
  EXPECT_LT(collisions, 300U);
}

}  // namespace
}  // namespace tccm
