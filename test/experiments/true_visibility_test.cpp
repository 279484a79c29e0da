#include "experiments/true_visibility.h"

#include <gtest/gtest.h>

#include "simulation/world.h"

namespace tccm::simulation {
namespace {

constexpr double kFine = 0.001;  // [rad]

/// A plate of 200 x 200 mm across the way from the sensor, 1 m ahead and 1 m below it.
const Vector3 kSensor(0.0, 0.0, 1.5);

Body plateAt(double range, double half_width, double aside = 0.0) {
  const Vector3 look = Vector3(1.0, 0.0, -1.0).normalized();
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(M_PI / 4.0, Vector3::UnitY()).toRotationMatrix();
  pose.translation() = kSensor + range * look + Vector3(0.0, aside, 0.0);
  return {{Box{Vector3(1e-4, half_width, half_width)}}, {pose}};
}

TrueLinkVisibility seen(const Body& links, const Body& scene, double margin_m = 0.05) {
  TrueVisibility::Config config;
  config.resolution_rad = kFine;
  config.margin_m = margin_m;
  return TrueVisibility(config)
      .find(kSensor, links, std::vector<std::uint32_t>(links.shapes.size(), 7), scene)
      .front();
}

TEST(TrueVisibilityTest, APlateAloneIsSeenWholeAndTakesUpItsSolidAngle) {
  const TrueLinkVisibility link = seen(plateAt(2.0, 0.1), {});
  EXPECT_EQ(link.link, 7U);
  EXPECT_EQ(link.visible_fraction, 1.0);
  EXPECT_EQ(link.in_range, 1.0);
  EXPECT_NEAR(link.silhouette_sr, 0.2 * 0.2 / 4.0, 1e-4);
}

TEST(TrueVisibilityTest, AnObstacleHalfwayHidesFourTimesItsOwnArea) {
  const TrueLinkVisibility link = seen(plateAt(2.0, 0.1), plateAt(1.0, 0.025));
  EXPECT_NEAR(link.visible_fraction, 0.75, 0.01);
}

TEST(TrueVisibilityTest, AnObstacleBesideOrBehindHidesNothing) {
  EXPECT_EQ(seen(plateAt(2.0, 0.1), plateAt(1.0, 0.025, 0.2)).visible_fraction, 1.0);
  EXPECT_EQ(seen(plateAt(2.0, 0.1), plateAt(2.2, 0.5)).visible_fraction, 1.0);
}

TEST(TrueVisibilityTest, WhatLiesInFrontByLessThanTheMarginHidesNothing) {
  EXPECT_EQ(seen(plateAt(2.0, 0.1), plateAt(1.96, 0.5)).visible_fraction, 1.0);
  EXPECT_EQ(seen(plateAt(2.0, 0.1), plateAt(1.94, 0.5)).visible_fraction, 0.0);
  EXPECT_EQ(seen(plateAt(2.0, 0.1), plateAt(1.96, 0.5), 0.0).visible_fraction, 0.0);
}

TEST(TrueVisibilityTest, ALinkBehindAnotherShowsOnlyWhereItIsTheNearest) {
  Body links = plateAt(2.0, 0.1);
  const Body nearer = plateAt(1.0, 0.025);
  links.shapes.push_back(nearer.shapes.front());
  links.poses.push_back(nearer.poses.front());
  TrueVisibility::Config config;
  config.resolution_rad = kFine;
  const auto found = TrueVisibility(config).find(kSensor, links, {3, 4}, plateAt(1.5, 0.5));
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NEAR(found[0].silhouette_sr, 0.75 * 0.01, 1e-4);
  EXPECT_EQ(found[0].visible_fraction, 0.0);
  EXPECT_EQ(found[1].visible_fraction, 1.0);
}

TEST(TrueVisibilityTest, OfALinkAtTheTiltsEdgeOnlyAPartIsInRange) {
  TrueVisibility::Config config;
  config.resolution_rad = kFine;
  config.tilt.amplitude_rad = 0.025;
  const auto found = TrueVisibility(config).find(kSensor, plateAt(2.0, 0.1), {0}, {});
  EXPECT_NEAR(found.front().in_range, 0.5, 0.02);
}

TEST(TrueVisibilityTest, RaysThatAreTooFarApartAreRefused) {
  TrueVisibility::Config config;
  config.resolution_rad = 1.0;
  EXPECT_ANY_THROW(TrueVisibility{config});
}

}  // namespace
}  // namespace tccm::simulation
