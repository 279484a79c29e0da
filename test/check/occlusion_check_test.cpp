#include "check/occlusion_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "geometry/ray.h"
#include "support/cuboid_scene.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using test::placedAt;
using test::Random;

/// 4 x 4 m around the sensor at the origin, from 2 m below it to 2 m above.
CuboidMap mapAround() {
  Grid::Config grid;
  grid.origin_x_m = grid.origin_y_m = -2.0;
  grid.size_x_m = grid.size_y_m = 4.0;
  grid.height_min_m = -2.0;
  return test::emptyMap(grid);
}

/// Half a metre ahead, from one y to another and one height to another.
CuboidMap wall(double right, double left, double bottom, double top) {
  CuboidMap map = mapAround();
  test::addBlock(map, {Vector3(0.49, right, bottom), Vector3(0.53, left, top)});
  return map;
}

PoseFindings findingsOf(OcclusionCheck& check, const CuboidMap& map, const Body& body) {
  PoseFindings findings;
  check.find(map, body, findings);
  return findings;
}

/// What is hidden of a ball of 150 mm at that place.
double hiddenOfBall(const CuboidMap& map, const Pose& place,
                    const OcclusionCheck::Config& config = {}) {
  OcclusionCheck check(config, {0});
  return findingsOf(check, map, {{Sphere{0.15}}, {place}}).links[0].occluded_fraction;
}

TEST(OcclusionCheckTest, WithoutCuboidsEverythingIsVisible) {
  EXPECT_EQ(hiddenOfBall(mapAround(), placedAt(1, 0, 0)), 0.0);
}

TEST(OcclusionCheckTest, ABallBehindAWallIsHidden) {
  EXPECT_EQ(hiddenOfBall(wall(-0.5, 0.5, -0.5, 0.5), placedAt(1, 0, 0)), 1.0);
}

TEST(OcclusionCheckTest, ABallInFrontOfAWallIsVisible) {
  EXPECT_EQ(hiddenOfBall(wall(-0.5, 0.5, -0.5, 0.5), placedAt(0.3, 0, 0)), 0.0);
}

TEST(OcclusionCheckTest, ABallBehindTheSensorIsVisibleWhateverStandsAhead) {
  EXPECT_EQ(hiddenOfBall(wall(-1.0, 1.0, -1.0, 1.0), placedAt(-1, 0, 0)), 0.0);
}

TEST(OcclusionCheckTest, AWallThatEndsAtTheMiddleHidesAboutHalf) {
  OcclusionCheck::Config fine;
  fine.resolution_rad = 0.005;
  const Pose ahead = placedAt(1, 0, 0);
  EXPECT_NEAR(hiddenOfBall(wall(0.0, 0.5, -0.5, 0.5), ahead, fine), 0.5, 0.06);
  EXPECT_NEAR(hiddenOfBall(wall(-0.5, 0.0, -0.5, 0.5), ahead, fine), 0.5, 0.06);
  EXPECT_NEAR(hiddenOfBall(wall(-0.5, 0.5, -0.5, 0.0), ahead, fine), 0.5, 0.06);
  EXPECT_NEAR(hiddenOfBall(wall(-0.5, 0.5, 0.0, 0.5), ahead, fine), 0.5, 0.06);
}

TEST(OcclusionCheckTest, AWallNearerThanTheBallByLessThanTheMarginHidesNothing) {
  OcclusionCheck::Config config;
  config.margin_m = 0.3;
  const CuboidMap map = wall(-0.5, 0.5, -0.5, 0.5);
  EXPECT_EQ(hiddenOfBall(map, placedAt(0.8, 0, 0), config), 0.0) << "its rim is 0.79 m away";
  config.margin_m = 0.1;
  EXPECT_EQ(hiddenOfBall(map, placedAt(0.8, 0, 0), config), 1.0);
}

TEST(OcclusionCheckTest, AWallBelowOrBesideHidesNothing) {
  EXPECT_EQ(hiddenOfBall(wall(-0.5, 0.5, -0.9, -0.2), placedAt(1, 0, 0)), 0.0);
  EXPECT_EQ(hiddenOfBall(wall(0.2, 0.9, -0.5, 0.5), placedAt(1, 0, 0)), 0.0);
}

TEST(OcclusionCheckTest, AWallAcrossTheSeamHidesWhatLiesBehindIt) {
  CuboidMap map = mapAround();
  test::addBlock(map, {Vector3(-0.53, -0.4, -0.4), Vector3(-0.49, 0.4, 0.4)});
  EXPECT_EQ(hiddenOfBall(map, placedAt(-1, 0, 0)), 1.0);
  EXPECT_EQ(hiddenOfBall(map, placedAt(1, 0, 0)), 0.0);
}

TEST(OcclusionCheckTest, ATableStraightBelowHidesWhatLiesUnderIt) {
  CuboidMap map = mapAround();
  test::addBlock(map, {Vector3(-0.5, -0.5, -0.52), Vector3(0.5, 0.5, -0.5)});
  EXPECT_EQ(hiddenOfBall(map, placedAt(0.0, 0.0, -1.0)), 1.0);
  EXPECT_EQ(hiddenOfBall(map, placedAt(0.05, -0.03, -1.0)), 1.0);
  EXPECT_EQ(hiddenOfBall(map, placedAt(0.0, 0.0, 1.0)), 0.0);
}

TEST(OcclusionCheckTest, APrimitiveAroundTheViewpointHasNoSilhouetteAndIsVisible) {
  OcclusionCheck check({}, {3});
  const PoseFindings result =
      findingsOf(check, wall(-0.5, 0.5, -0.5, 0.5), {{Sphere{0.1}}, {placedAt(0, 0, 0)}});
  EXPECT_EQ(result.links[0].silhouette, 0.0);
  EXPECT_EQ(result.links[0].occluded_fraction, 0.0);
  EXPECT_FALSE(check.isOccluded(result.links[0]));
}

TEST(OcclusionCheckTest, ShapesOfALinkAreJudgedTogetherAndLinksApart) {
  OcclusionCheck check({}, {8, 5, 8});
  const Body body{{Sphere{0.1}, Sphere{0.1}, Sphere{0.1}},
                  {placedAt(1, 0, 0), placedAt(-1, 0, 0), placedAt(-1, -1, 0)}};
  const PoseFindings result = findingsOf(check, wall(-0.5, 0.5, -0.5, 0.5), body);
  ASSERT_EQ(result.links.size(), 2U);
  EXPECT_EQ(result.links[0].link, 8U);
  EXPECT_EQ(result.links[1].link, 5U);
  EXPECT_NEAR(result.links[0].occluded_fraction, 2.0 / 3.0, 0.07) << "1 m and 1.41 m away";
  EXPECT_EQ(result.links[1].occluded_fraction, 0.0);
  EXPECT_TRUE(result.occlusion);
}

TEST(OcclusionCheckTest, ALinkHiddenByTheRobotsOwnBodyIsNotCountedAsHiddenByCuboids) {
  OcclusionCheck check({}, {0, 1});
  const Body body{{Sphere{0.1}, Sphere{0.1}}, {placedAt(0.3, 0, 0), placedAt(1, 0, 0)}};
  const PoseFindings result = findingsOf(check, wall(-0.5, 0.5, -0.5, 0.5), body);
  EXPECT_EQ(result.links[0].occluded_fraction, 0.0);
  EXPECT_EQ(result.links[1].silhouette, 0.0);
  EXPECT_EQ(result.links[1].occluded_fraction, 0.0);
}

TEST(OcclusionCheckTest, TheCuboidsThatHideAreListed) {
  CuboidMap map = wall(-0.5, 0.5, -0.5, 0.5);
  const std::size_t front = map.cuboids.size();
  test::addBlock(map, {Vector3(1.5, -0.5, -0.5), Vector3(1.6, 0.5, 0.5)});
  OcclusionCheck check({}, {0});
  const PoseFindings result = findingsOf(check, map, {{Sphere{0.15}}, {placedAt(1, 0, 0)}});
  EXPECT_FALSE(result.occluding_cuboids.empty());
  EXPECT_LT(result.occluding_cuboids.size(), front) << "the wall is wider than the ball";
  for (const std::uint32_t k : result.occluding_cuboids) {
    EXPECT_LT(map.box(map.cuboids[k]).max().x(), 0.6);
  }
}

TEST(OcclusionCheckTest, ALinkIsOccludedFromTheHiddenFractionOnUnlessItShowsTooLittle) {
  OcclusionCheck::Config config;
  config.hidden_fraction = 0.25;
  config.silhouette_min_pixels = 4.0;
  const OcclusionCheck check(config, {0});
  EXPECT_TRUE(check.isOccluded({0, 10.0, 0.75, 0.25}));
  EXPECT_TRUE(check.isOccluded({0, 4.0, 0.0, 1.0}));
  EXPECT_FALSE(check.isOccluded({0, 10.0, 0.5, 0.24, 0.26}));
  EXPECT_FALSE(check.isOccluded({0, 3.9, 0.0, 1.0}));
}

/// A map whose looks go that far in every direction.
CuboidMap lookedThrough(CuboidMap map, double range, Seen end, LookImage::Pass before = {}) {
  map.looks.begin(Time(), map.viewpoint);
  for (int row = 0; row < map.looks.grid().rows(); ++row) {
    for (int column = 0; column < map.looks.grid().columns(); ++column) {
      const auto range_mm = static_cast<std::uint16_t>(1e3 * range);
      map.looks.edit(row, column) = {LookImage::Pass{1000, 1000, range_mm, end}, before};
    }
  }
  return map;
}

LinkVisibility visibilityOfBall(const CuboidMap& map) {
  OcclusionCheck check({}, {0});
  return findingsOf(check, map, {{Sphere{0.15}}, {placedAt(1, 0, 0)}}).links[0];
}

TEST(OcclusionCheckTest, WhereNobodyLookedNothingIsVisible) {
  const LinkVisibility ball = visibilityOfBall(mapAround());
  EXPECT_EQ(ball.visible_fraction, 0.0);
  EXPECT_EQ(ball.occluded_fraction, 0.0);
  EXPECT_EQ(ball.unseen_fraction, 1.0);
}

TEST(OcclusionCheckTest, TheNewestLookThatReachesALinkSeesItWhateverTheMapHolds) {
  const CuboidMap behind_wall = wall(-0.5, 0.5, -0.5, 0.5);
  const LinkVisibility ball = visibilityOfBall(lookedThrough(behind_wall, 3.0, Seen::kNothing));
  EXPECT_EQ(ball.visible_fraction, 1.0);
}

TEST(OcclusionCheckTest, ALookThatEndsBeforeALinkHidesItAlsoWhereTheMapHoldsNothing) {
  const LinkVisibility ball = visibilityOfBall(lookedThrough(mapAround(), 0.5, Seen::kSurface));
  EXPECT_EQ(ball.occluded_fraction, 1.0);
}

TEST(OcclusionCheckTest, BehindTheRobotItselfCuboidsHideAndTheRestIsUnseen) {
  const CuboidMap half = wall(0.0, 0.5, -0.5, 0.5);
  for (const auto end : {Seen::kRobot, Seen::kUnclear}) {
    const LinkVisibility ball = visibilityOfBall(lookedThrough(half, 0.4, end));
    EXPECT_NEAR(ball.occluded_fraction, 0.5, 0.15);
    EXPECT_NEAR(ball.unseen_fraction, 0.5, 0.15);
    EXPECT_NEAR(ball.visible_fraction, 0.0, 1e-12);
  }
}

TEST(OcclusionCheckTest, BehindTheRobotItselfTheLookBeforeCounts) {
  const LookImage::Pass before{200, 200, 3000, Seen::kNothing};
  const LinkVisibility ball =
      visibilityOfBall(lookedThrough(mapAround(), 0.4, Seen::kRobot, before));
  EXPECT_EQ(ball.visible_fraction, 1.0);
}

TEST(OcclusionCheckTest, LooksOlderThanSoManyTiltPeriodsSayNothing) {
  CuboidMap map = lookedThrough(mapAround(), 3.0, Seen::kNothing);  // at 1 s
  map.look_period = std::chrono::seconds(1);
  map.stamp = Time(std::chrono::milliseconds(2500));
  EXPECT_EQ(visibilityOfBall(map).visible_fraction, 1.0);
  map.stamp += std::chrono::milliseconds(1);
  EXPECT_EQ(visibilityOfBall(map).unseen_fraction, 1.0);
}

void expectSame(const PoseFindings& findings, const PoseFindings& expected) {
  EXPECT_EQ(findings.occluding_cuboids, expected.occluding_cuboids);
  EXPECT_EQ(findings.occlusion, expected.occlusion);
  ASSERT_EQ(findings.links.size(), expected.links.size());
  for (std::size_t i = 0; i < expected.links.size(); ++i) {
    EXPECT_EQ(findings.links[i].silhouette, expected.links[i].silhouette);
    EXPECT_EQ(findings.links[i].visible_fraction, expected.links[i].visible_fraction);
    EXPECT_EQ(findings.links[i].occluded_fraction, expected.links[i].occluded_fraction);
    EXPECT_EQ(findings.links[i].unseen_fraction, expected.links[i].unseen_fraction);
  }
}

/// Shapes that move now and then, or are elsewhere ahead, before walls that the sensor saw in part.
TEST(OcclusionCheckTest, OfTwoPosesAtOnceTheFindingsAreAsOfEachAlone) {
  Random random(7);
  const std::vector<std::uint32_t> links{0, 1, 2, 0, 1, 2};
  OcclusionCheck check({}, links);
  const CuboidMap map = lookedThrough(wall(-0.5, 0.5, -0.3, 0.3), 0.7, Seen::kRobot);
  Body body;
  for (std::size_t i = 0; i < links.size(); ++i) {
    body.shapes.push_back(random.shape(i % test::kShapeKinds));
    body.poses.push_back(random.pose(1.2));
  }
  std::size_t hiding = 0, differ = 0;
  for (int step = 0; step < 200; ++step) {
    Body ahead = body;
    for (std::size_t i = 0; i < links.size(); ++i) {
      if (random.chance(0.2)) body.poses[i] = random.pose(1.2);
      ahead.poses[i] = random.chance(0.3) ? random.pose(1.2) : body.poses[i];
    }
    PoseFindings here_findings, ahead_findings;
    check.find(map, body, here_findings, &ahead, &ahead_findings);
    OcclusionCheck alone({}, links), alone_ahead({}, links);
    expectSame(here_findings, findingsOf(alone, map, body));
    expectSame(ahead_findings, findingsOf(alone_ahead, map, ahead));
    hiding += here_findings.occluding_cuboids.size();
    differ += here_findings.links[0].silhouette != ahead_findings.links[0].silhouette ? 1 : 0;
  }
  EXPECT_GT(hiding, 100U);
  EXPECT_GT(differ, 50U);
}

TEST(OcclusionCheckTest, WithoutLinksNoneIsOccluded) {
  OcclusionCheck check({}, {});
  const PoseFindings result = findingsOf(check, wall(-0.5, 0.5, -0.5, 0.5), {});
  EXPECT_TRUE(result.links.empty());
  EXPECT_FALSE(result.occlusion);
}

TEST(OcclusionCheckTest, ValuesOutOfRangeAreRefused) {
  const auto refused = [](auto member, double value) {
    OcclusionCheck::Config config;
    config.*member = value;
    EXPECT_THROW(OcclusionCheck(config, {}), ConfigError) << value;
  };
  refused(&OcclusionCheck::Config::resolution_rad, 0.0);
  refused(&OcclusionCheck::Config::margin_m, -0.1);
  refused(&OcclusionCheck::Config::hidden_fraction, 0.0);
  refused(&OcclusionCheck::Config::hidden_fraction, 1.01);
  refused(&OcclusionCheck::Config::silhouette_min_pixels, NAN);
}

/// The first hit of a ray and what it belongs to.
struct Hit {
  double range = std::numeric_limits<double>::infinity();
  std::size_t shape = 0;
};

Hit firstHit(const Body& body, const Ray& ray) {
  Hit hit;
  for (std::size_t i = 0; i < body.shapes.size(); ++i) {
    const auto span = intersect(body.shapes[i], transformed(ray, body.poses[i].inverse()));
    if (span && span->enter < hit.range) hit = {span->enter, i};
  }
  return hit;
}

Body boxesOf(const CuboidMap& map, double grown) {
  Body boxes;
  for (const Cuboid& cuboid : map.cuboids) {
    const UprightBox box = map.box(cuboid);
    boxes.shapes.emplace_back(Box{(0.5 * box.sizes()).array() + grown});
    boxes.poses.push_back(placedAt(box.center().x(), box.center().y(), box.center().z()));
  }
  return boxes;
}

/// What rays through the body's silhouettes say is hidden of each shape, with the cuboids grown
/// [m].
std::vector<double> hiddenByRays(const CuboidMap& map, const Body& body, double margin,
                                 double grown) {
  constexpr int kRows = 300;
  const Body boxes = boxesOf(map, grown);
  std::vector<double> all(body.shapes.size(), 0.0), hidden(body.shapes.size(), 0.0);
  for (int row = 0; row < kRows; ++row) {
    const double elevation = (row + 0.5) * M_PI / kRows - 0.5 * M_PI;
    const double weight = std::cos(elevation);
    for (int column = 0; column < 2 * kRows; ++column) {
      const double azimuth = (column + 0.5) * M_PI / kRows;
      const Ray ray{map.viewpoint,
                    {weight * std::cos(azimuth), weight * std::sin(azimuth), std::sin(elevation)}};
      const Hit body_hit = firstHit(body, ray);
      if (std::isinf(body_hit.range)) continue;
      all[body_hit.shape] += weight;
      if (firstHit(boxes, ray).range + margin < body_hit.range) hidden[body_hit.shape] += weight;
    }
  }
  for (std::size_t i = 0; i < all.size(); ++i) hidden[i] = all[i] > 0.0 ? hidden[i] / all[i] : 0.0;
  return hidden;
}

/// The check may say hidden where a cuboid comes within a pixel, and never much less than rays do.
TEST(OcclusionCheckTest, LiesBetweenExactRaysAndRaysAtCuboidsGrownByAPixelInRandomScenes) {
  constexpr double kTolerance = 0.05;  // of the silhouette: pixels and rays sample it differently
  constexpr double kFarthest = 1.2;    // [m]
  Random random(4);
  const OcclusionCheck::Config config;
  Grid::Config grid;
  grid.origin_x_m = grid.origin_y_m = -1.0;
  grid.size_x_m = grid.size_y_m = 2.0;
  grid.cell_size_m = 0.04;
  int partly_hidden = 0;
  for (int scene = 0; scene < 25; ++scene) {
    CuboidMap map = test::emptyMap(grid);
    map.viewpoint = Vector3(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), 1.0);
    for (int k = 0; k < 25; ++k) {
      const Vector3 place = random.point(0.8);
      if ((place - map.viewpoint).head<2>().norm() < 0.15) continue;
      const double bottom = random.uniform(0.3, 1.3);
      test::addBlock(
          map, {Vector3(place.x(), place.y(), bottom),
                Vector3(place.x() + 0.09, place.y() + 0.09, bottom + random.uniform(0.05, 0.3))});
    }
    Body body;
    for (std::size_t i = 0; i < 4; ++i) {
      const Vector3 p = map.viewpoint + random.uniform(0.7, kFarthest - 0.3) * random.direction();
      body.shapes.push_back(expanded(random.shape(i), {1.0, 0.08}));
      body.poses.push_back(placedAt(p.x(), p.y(), p.z()));
      body.poses.back().linear() = random.rotation();
    }
    OcclusionCheck check(config, {0, 1, 2, 3});
    const PoseFindings result = findingsOf(check, map, body);
    const auto exact = hiddenByRays(map, body, config.margin_m, 0.0);
    const auto most =
        hiddenByRays(map, body, config.margin_m, 1.5 * config.resolution_rad * kFarthest);
    for (std::size_t i = 0; i < 4; ++i) {
      if (result.links[i].silhouette < 20.0) continue;
      const double hidden = result.links[i].occluded_fraction;
      EXPECT_GE(hidden, exact[i] - kTolerance) << scene << ": " << name(body.shapes[i]);
      EXPECT_LE(hidden, most[i] + kTolerance) << scene << ": " << name(body.shapes[i]);
      partly_hidden += exact[i] > 0.1 && exact[i] < 0.9;
    }
  }
  EXPECT_GT(partly_hidden, 10);
}

}  // namespace
}  // namespace tccm
