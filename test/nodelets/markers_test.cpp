#include "nodelets/markers.h"

#include <gtest/gtest.h>
#include <sensor_msgs/image_encodings.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include "ros/conversions.h"
#include "support/cuboid_scene.h"
#include "support/look_around.h"
#include "support/tiny_robot.h"

namespace tccm {
namespace {

using visualization_msgs::Marker;

class RobotMarkerTest : public ::testing::Test {
 protected:
  /// The hand is at x = 0.5 m.
  const Verdict& judge(const CuboidMap& map, double velocity = 0.0) {
    const Time now = map.stamp + fromSeconds(0.01);
    checker_.setRootPose(0, Time(), Pose::Identity(), true);
    for (const double before : {0.04, 0.0}) {
      checker_.addJoints(now, now - fromSeconds(before), {"slide", "glide"},
                         {0.5 - before * velocity, 0.3}, {velocity, 0.0});
    }
    checker_.setMap(now, std::make_shared<const CuboidMap>(map));
    return checker_.check(now);
  }
  visualization_msgs::MarkerArray draw(const Verdict& verdict) {
    cause_.follow(verdict, checker_.map());
    return toMarkers(verdict, cause_, checker_, "odom");
  }
  std::vector<Marker> draw(const Verdict& verdict, const std::string& name) {
    std::vector<Marker> drawn;
    for (const Marker& marker : draw(verdict).markers) {
      if (marker.ns == name) drawn.push_back(marker);
    }
    return drawn;
  }
  static CuboidMap scene() {
    CuboidMap map = test::emptyMap();
    map.stamp = Time(fromSeconds(100.0));
    map.viewpoint = Vector3(0.0, 0.0, 1.9);
    test::lookAround(map);
    return map;
  }
  Checker checker_{test::sliderModel(), {}};
  StopCause cause_;
};

TEST_F(RobotMarkerTest, EachPrimitiveIsDrawnNowAndAheadWhereItIs) {
  const auto markers = draw(judge(scene())).markers;
  // Two balls: now, ahead, as drawn for occlusion, and the age of what is known; and the text.
  ASSERT_EQ(markers.size(), 9U);
  const Marker& hand = markers.front();
  EXPECT_EQ(hand.type, Marker::SPHERE);
  EXPECT_EQ(hand.header.frame_id, "odom");
  EXPECT_NEAR(hand.pose.position.x, 0.5, 1e-9);
  EXPECT_NEAR(hand.pose.position.z, 0.5, 1e-9);
  EXPECT_NEAR(hand.scale.x, 2.0 * (0.05 + 0.03), 1e-9) << "as it is checked: padded";
  EXPECT_EQ(std::count_if(markers.begin(), markers.end(),
                          [](const Marker& m) { return m.ns == "ahead"; }),
            2);
  EXPECT_EQ(markers.back().type, Marker::TEXT_VIEW_FACING);
  EXPECT_EQ(markers.back().text, "OK CLEAR\nspeed 0 %") << "it rises from there";
}

TEST_F(RobotMarkerTest, WhatIsTouchedFirstAndWhatIsExemptAreShown) {
  CuboidMap map = scene();
  const CellIndex cell = *map.grid.cellOf(Vector3(0.5, 0.01, 0.5));
  test::addCuboid(map, cell, 0.45, 0.55);
  const PlacedShape region{Box{Vector3(0.1, 0.2, 0.3)}, Pose(Eigen::Translation3d(0.7, -0.9, 0.5))};
  judge(map);
  checker_.addExemption(map.stamp + fromSeconds(0.01), {"gripper", "hand", region, {}}, 1.0);
  std::map<std::string, Marker> by_namespace;
  for (const Marker& marker : draw(judge(map)).markers) by_namespace[marker.ns] = marker;
  ASSERT_EQ(by_namespace.count("first contact"), 1U);
  const Marker& first = by_namespace["first contact"];
  EXPECT_NEAR(first.pose.position.x, map.grid.centre(cell).x(), 1e-9);
  EXPECT_NEAR(first.pose.position.z, 0.5, 1e-9);
  EXPECT_NEAR(first.scale.z, 0.11, 1e-6);
  ASSERT_EQ(by_namespace.count("flagged cuboids"), 1U);
  const Marker& flagged = by_namespace["flagged cuboids"];
  ASSERT_EQ(flagged.points.size(), 72U) << "it alone, touched now and ahead";
  ASSERT_EQ(flagged.colors.size(), flagged.points.size());
  EXPECT_GT(flagged.colors[0].r, 0.3F) << "magenta";
  EXPECT_LT(flagged.colors[0].g, 0.1F);
  ASSERT_EQ(by_namespace.count("exemptions"), 1U);
  EXPECT_NEAR(by_namespace["exemptions"].pose.position.y, -0.9, 1e-9);
  EXPECT_NEAR(by_namespace["exemptions"].scale.z, 0.6, 1e-9);
  EXPECT_NE(by_namespace["status"].text.find("hand 0 mm clear"), std::string::npos)
      << by_namespace["status"].text;
}

TEST_F(RobotMarkerTest, RegionsInForceAreShownWhereTheyAreNow) {
  const CuboidMap map = scene();
  judge(map);
  Exemption exemption{"gripper", "hand", {Box{Vector3(0.1, 0.2, 0.3)}, Pose::Identity()}, {}};
  exemption.region.pose.translation().x() = 0.25;
  exemption.frame = "hand";
  checker_.addExemption(map.stamp, exemption, 1.0);
  exemption.link = "other";
  exemption.frame = "cup";  // which nobody has seen
  checker_.addExemption(map.stamp, exemption, 1.0);
  exemption.owner = "docking";
  exemption.frame = "";
  exemption.with_goal = true;
  checker_.addExemption(map.stamp, exemption, 1.0);
  std::vector<Marker> hand = draw(judge(map), "now"), regions = draw(judge(map), "exemptions");
  ASSERT_FALSE(hand.empty());
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_NEAR(regions[0].pose.position.x, hand[0].pose.position.x + 0.25, 1e-9);
  EXPECT_NEAR(regions[0].pose.position.z, hand[0].pose.position.z, 1e-9);
}

TEST_F(RobotMarkerTest, ThePrimitivesOfEachUseHaveANamespaceAndIdsOfTheirOwn) {
  const auto markers = draw(judge(scene())).markers;
  std::map<std::string, std::set<int>> ids;
  for (const Marker& marker : markers) {
    EXPECT_TRUE(ids[marker.ns].insert(marker.id).second) << marker.ns << ' ' << marker.id;
    EXPECT_EQ(marker.action, Marker::ADD);
  }
  EXPECT_EQ(ids.size(), 5U);
  EXPECT_EQ(ids["now"].size(), 2U);
  EXPECT_EQ(ids["ahead"].size(), 2U);
  EXPECT_EQ(ids["occlusion"].size(), 2U);
  EXPECT_EQ(ids["evidence age"].size(), 2U);
  EXPECT_EQ(ids["status"].size(), 1U);
  const auto unpadded = std::find_if(markers.begin(), markers.end(),
                                     [](const Marker& m) { return m.ns == "occlusion"; });
  EXPECT_NEAR(unpadded->scale.x, 2.0 * 0.05, 1e-9);
}

TEST_F(RobotMarkerTest, WhatTheHandHoldsIsDrawnWithIt) {
  AttachedObject mug{"mug", "hand", {Capsule{0.03, 0.05}}};
  mug.primitive.pose.translation().x() = 0.12;
  checker_.attach(mug);
  const auto markers = draw(judge(scene())).markers;
  const auto cylinder = std::find_if(markers.begin(), markers.end(), [](const Marker& m) {
    return m.type == Marker::CYLINDER && m.ns == "now";
  });
  ASSERT_NE(cylinder, markers.end());
  EXPECT_NEAR(cylinder->pose.position.x, 0.62, 1e-9);
  EXPECT_NEAR(cylinder->scale.x, 2.0 * (0.03 + 0.03), 1e-9);
  EXPECT_EQ(
      std::count_if(markers.begin(), markers.end(), [](const Marker& m) { return m.ns == "now"; }),
      5)
      << "two balls, and a capsule's three parts";
}

TEST_F(RobotMarkerTest, RegionsToKeepOutOfAreTranslucentBoxesWithTheirNamesInTheirOwnFrames) {
  checker_.setKeepOut({"near", "", Box{Vector3(0.1, 0.2, 0.3)}, test::placedAt(0.7, 0.0, 0.5)});
  checker_.setKeepOut({"far", "base", Box{Vector3(0.1, 0.2, 0.3)}, test::placedAt(5.0, 0.0, 0.5)});
  const Verdict& verdict = judge(scene());
  const std::vector<Marker> boxes = draw(verdict, "keep out");
  ASSERT_EQ(boxes.size(), 2U);
  EXPECT_EQ(boxes[0].type, Marker::CUBE);
  EXPECT_EQ(boxes[0].header.frame_id, "odom");
  EXPECT_EQ(boxes[1].header.frame_id, "base");
  EXPECT_NEAR(boxes[0].pose.position.x, 0.7, 1e-9);
  EXPECT_NEAR(boxes[0].scale.z, 0.6, 1e-9);
  EXPECT_LT(boxes[0].color.a, 0.5F);
  EXPECT_EQ(boxes[0].color.b, boxes[1].color.b);
  const std::vector<Marker> names = draw(verdict, "keep out names");
  ASSERT_EQ(names.size(), 2U);
  EXPECT_EQ(names[0].text, "near");
  EXPECT_EQ(names[1].text, "far");
  EXPECT_EQ(names[1].header.frame_id, "base");
}

TEST_F(RobotMarkerTest, ARegionThatALinkIsInIsMagentaAndSoIsThePrimitive) {
  checker_.setKeepOut({"near", "", Box{Vector3(0.1, 0.2, 0.3)}, test::placedAt(0.6, 0.0, 0.5)});
  const Verdict& verdict = judge(scene());
  for (const char* name : {"keep out", "now", "ahead"}) {
    const Marker marker = draw(verdict, name).front();
    EXPECT_GT(marker.color.b, 0.7F) << name;
    EXPECT_LT(marker.color.g, 0.1F) << name;
  }
}

TEST_F(RobotMarkerTest, RegionsShowBeforeTheRobotCanBePlaced) {
  checker_.setKeepOut({"near", "", Box{Vector3(0.1, 0.2, 0.3)}, test::placedAt(0.6, 0.0, 0.5)});
  const Verdict& verdict = checker_.check(Time(fromSeconds(100.0)));
  EXPECT_FALSE(verdict.placed);
  EXPECT_EQ(draw(verdict, "keep out").size(), 1U);
}

TEST(SelfFilterMarkersTest, TheBodyIsDrawnAsFarAsItIsFilteredOut) {
  BodySample sample;
  sample.stamp = Time(fromSeconds(7.0));
  sample.body.shapes = {Sphere{0.05}, Box{Vector3(0.1, 0.2, 0.3)}, Capsule{0.03, 0.1}};
  sample.body.poses = {test::placedAt(1.0, 0.0, 0.0), test::placedAt(0.0, 2.0, 0.0),
                       test::placedAt(0.0, 0.0, 3.0)};
  sample.body.paddings_m = {0.06, 0.0, 0.01};
  const auto markers = toMarkers(sample, "odom").markers;
  ASSERT_EQ(markers.size(), 5U);
  std::set<int> ids;
  for (const Marker& marker : markers) {
    EXPECT_EQ(marker.ns, "self filter");
    EXPECT_EQ(marker.header.frame_id, "odom");
    EXPECT_EQ(marker.header.stamp, ros::Time(7.0));
    EXPECT_GT(marker.lifetime, ros::Duration(0.0)) << "a body that is not placed any more vanishes";
    EXPECT_TRUE(ids.insert(marker.id).second);
  }
  EXPECT_EQ(markers[0].type, Marker::SPHERE);
  EXPECT_NEAR(markers[0].scale.x, 0.22, 1e-9);
  EXPECT_NEAR(markers[0].pose.position.x, 1.0, 1e-9);
  EXPECT_EQ(markers[1].type, Marker::CUBE);
  EXPECT_NEAR(markers[1].scale.z, 0.6, 1e-9);
  EXPECT_NEAR(markers[1].pose.position.y, 2.0, 1e-9);
  EXPECT_EQ(markers[2].type, Marker::CYLINDER);
  EXPECT_NEAR(markers[2].scale.x, 0.08, 1e-9);
  EXPECT_NEAR(markers[2].scale.z, 0.2, 1e-9);
  EXPECT_NEAR(markers[4].pose.position.z, 3.1, 1e-9);
}

TEST(SelfFilterMarkersTest, ABodyWithoutPaddingsIsDrawnAsItIs) {
  BodySample sample;
  sample.body.shapes = {Sphere{0.05}};
  sample.body.poses = {Pose::Identity()};
  const auto drawn = toMarkers(sample, "odom");
  ASSERT_EQ(drawn.markers.size(), 1U);
  EXPECT_NEAR(drawn.markers[0].scale.x, 0.1, 1e-9);
}

TEST_F(RobotMarkerTest, WhatTouchesTheMapIsMagentaAndTheTextSaysWhy) {
  CuboidMap map = scene();
  test::addCuboid(map, *map.grid.cellOf(Vector3(0.5, 0.01, 0.5)), 0.45, 0.55);
  const auto markers = draw(judge(map)).markers;
  EXPECT_GT(markers[0].color.b, 0.5F);
  EXPECT_LT(markers[0].color.g, 0.2F);
  EXPECT_GT(markers[1].color.g, 0.5F) << "the other ball touches nothing";
  EXPECT_EQ(markers.back().text.rfind("STOP COLLISION\n", 0), 0U) << markers.back().text;
}

TEST_F(RobotMarkerTest, ARobotThatCouldNotBePlacedIsNotDrawn) {
  const auto markers = draw(checker_.check(Time(fromSeconds(100.0)))).markers;
  ASSERT_EQ(markers.size(), 1U);
  EXPECT_EQ(markers[0].text.rfind("STOP INIT", 0), 0U);
}

TEST_F(RobotMarkerTest, TheUnseenWayAheadIsShownAsPlacesAndAsAShare) {
  EXPECT_TRUE(draw(judge(scene(), 0.3), "unseen ahead").empty());
  CuboidMap map = scene();
  map.looks.clear();
  const Verdict& verdict = judge(map, 0.3);
  const auto unseen = draw(verdict, "unseen ahead");
  ASSERT_EQ(unseen.size(), 1U);
  EXPECT_EQ(unseen[0].type, Marker::CUBE_LIST);
  EXPECT_EQ(unseen[0].header.frame_id, "odom");
  EXPECT_LT(unseen[0].color.a, 1.0F);
  EXPECT_EQ(unseen[0].points.size(), checker_.evidence().unseenPlaces().size());
  ASSERT_FALSE(unseen[0].points.empty());
  for (const auto& p : unseen[0].points) {
    EXPECT_GT(p.x, 0.5) << "where the hand goes";
    EXPECT_NEAR(p.y, 0.0, 0.1);
  }
  const std::string text = draw(verdict, "status").at(0).text;
  EXPECT_NE(text.find(", 100 % unseen"), std::string::npos) << text;
}

TEST_F(RobotMarkerTest, WhatBroughtAStopAboutIsShownUntilItEnds) {
  CuboidMap map = scene();
  test::addCuboid(map, *map.grid.cellOf(Vector3(0.5, 0.01, 0.5)), 0.45, 0.55);
  const Verdict verdict = judge(map);
  ASSERT_TRUE(verdict.collision);
  const std::string found = draw(verdict, "status").at(0).text;
  EXPECT_TRUE(draw(verdict, "cause of the stop").empty()) << "the finding itself is shown";
  const std::size_t touched = draw(verdict, "flagged cuboids").at(0).points.size();

  Verdict slow = verdict;
  slow.level = Level::kSlow;
  slow.stop = false;
  draw(slow);
  draw(verdict);
  Verdict after = verdict;
  after.reason = Reason::kReleasing;
  after.detail = "clear for 0.2 s of 0.5 s";
  after.now.contacts.clear();
  after.ahead.contacts.clear();
  after.first_contact.reset();
  const std::string text = draw(after, "status").at(0).text;
  EXPECT_EQ(text.find("STOP COLLISION\n" + verdict.detail), 0U) << text;
  EXPECT_EQ(found.find("STOP COLLISION\n" + verdict.detail), 0U) << found;
  EXPECT_NE(text.find("\nnow RELEASING\n"), std::string::npos) << text;
  EXPECT_GE(draw(after, "cause of the stop").at(0).points.size(), touched);

  slow.reason = Reason::kMovingOut;
  EXPECT_TRUE(draw(slow, "cause of the stop").empty());
  EXPECT_EQ(draw(after, "status").at(0).text, text) << "to move out of it is no end of it";

  after.level = Level::kOk;
  after.reason = Reason::kClear;
  after.stop = false;
  EXPECT_TRUE(draw(after, "cause of the stop").empty());
  after.level = Level::kStop;
  after.reason = Reason::kReleasing;
  after.stop = true;
  EXPECT_TRUE(draw(after, "cause of the stop").empty()) << "of this stop nothing is known";
  EXPECT_EQ(draw(after, "status").at(0).text.find("STOP RELEASING"), 0U);
}

TEST_F(RobotMarkerTest, ALongTextStaysInTheViewInShortLines) {
  Verdict verdict = judge(scene());
  verdict.detail =
      "right_inner_finger_link_of_the_second_arm: something that has appeared is "
      "within 150 mm";
  const std::string text = draw(verdict, "status").at(0).text;
  std::istringstream lines(text);
  std::string line, all;
  while (std::getline(lines, line)) {
    EXPECT_TRUE(line.size() <= 44 || line.find(' ') == std::string::npos) << line;
    all += line + " ";
  }
  EXPECT_NE(all.find(verdict.detail), std::string::npos) << "no word is lost: " << text;
}

TEST_F(RobotMarkerTest, AtEachLinkTheAgeOfWhatIsKnownIsWrittenFromGreenToRed) {
  CuboidMap map = scene();
  const auto fresh = draw(judge(map), "evidence age");
  ASSERT_EQ(fresh.size(), 2U);
  EXPECT_EQ(fresh[0].text, "0.0 s");
  EXPECT_NEAR(fresh[0].pose.position.x, 0.5, 1e-9);
  EXPECT_GT(fresh[0].color.g, 0.9F);
  EXPECT_LT(fresh[0].color.r, 0.1F);
  map.stamp += fromSeconds(2.99);
  const auto old = draw(judge(map), "evidence age");
  ASSERT_EQ(old.size(), 2U);
  EXPECT_EQ(old[0].text, "3.0 s");
  EXPECT_LT(old[0].color.g, 0.1F) << "older than evidence_stop_periods";
  EXPECT_GT(old[0].color.r, 0.9F);
  map.looks.clear();
  EXPECT_EQ(draw(judge(map), "evidence age").at(0).text, "?");
}

TEST_F(RobotMarkerTest, TheOcclusionImageShowsLinksAndWhatHidesThem) {
  CuboidMap map = scene();
  judge(map);
  sensor_msgs::Image image = toImage(checker_.checkHere().occlusion().picture());
  ASSERT_EQ(image.encoding, sensor_msgs::image_encodings::RGB8);
  ASSERT_EQ(image.data.size(), std::size_t{3} * image.width * image.height);
  const auto pixels = [&image](bool blue) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < image.data.size(); i += 3) {
      const bool lit = image.data[i + 2] > 0;
      if (lit && (image.data[i + 2] > image.data[i]) == blue) ++count;
    }
    return count;
  };
  EXPECT_GT(pixels(false), 0U);
  EXPECT_EQ(pixels(true), 0U);
  test::addBlock(map, UprightBox(Vector3(0.2, -0.2, 1.0), Vector3(0.4, 0.2, 1.1)));
  test::lookAround(map);
  EXPECT_EQ(judge(map).reason, Reason::kOcclusion);
  image = toImage(checker_.checkHere().occlusion().picture());
  EXPECT_GT(pixels(true), 0U);
}

}  // namespace
}  // namespace tccm
