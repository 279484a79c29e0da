#include "scan/cloud_body_filter.h"

#include <gtest/gtest.h>

#include "support/random.h"

namespace tccm {
namespace {

using test::Random;

/// A body of several shapes at several times, and a sensor that moves a little meanwhile.
struct Scene {
  std::vector<BodySample> samples;
  std::vector<CloudPlace> places;
  std::vector<Time> times;  ///< of the places
};

Pose moved(const Pose& pose, const Vector3& by, double angle) {
  Pose moved = pose;
  moved.pretranslate(by);
  moved.rotate(Eigen::AngleAxisd(angle, Vector3::UnitZ()));
  return moved;
}

Scene sceneOf(Random& random, int shapes, int samples) {
  Scene scene;
  const Pose T_fixed_sensor = random.pose(0.5);
  Body body;
  for (int i = 0; i < shapes; ++i) {
    body.shapes.push_back(random.shape(static_cast<std::size_t>(random.integer(0, 3))));
    Pose pose = random.pose(1.5);
    if (i == 0 && random.chance(0.3)) pose.translation() = T_fixed_sensor.translation();
    body.poses.push_back(pose);
    body.paddings_m.push_back(random.uniform(0.0, 0.06));
  }
  const Vector3 way = random.point(0.05);
  for (int k = 0; k < samples; ++k) {
    BodySample sample{Time(fromSeconds(0.01 * k)), body};
    for (Pose& pose : sample.body.poses) pose = moved(pose, k * way, 0.02 * k);
    scene.samples.push_back(sample);
    for (int i = 0; i < 4; ++i) {
      scene.places.push_back(
          {moved(T_fixed_sensor, 0.01 * k * random.point(1.0), random.uniform(-0.02, 0.02)),
           static_cast<std::size_t>(k)});
      scene.times.push_back(sample.stamp);
    }
  }
  return scene;
}

/// Most of them near the body, before it or behind.
Vector3 pointNear(const Scene& scene, std::size_t place, Random& random) {
  if (random.chance(0.2)) return random.point(3.0);
  const Body& body = scene.samples[scene.places[place].sample].body;
  const auto i =
      static_cast<std::size_t>(random.integer(0, static_cast<int>(body.shapes.size()) - 1));
  const double reach = 1.3 * boundingRadius(body.shapes[i]) + 0.05;
  const Vector3 near = body.poses[i].translation() + random.point(reach);
  const Vector3 viewpoint = scene.places[place].T_fixed_sensor.translation();
  return viewpoint + random.uniform(0.7, 1.6) * (near - viewpoint);
}

struct Outcome {
  std::size_t differences = 0, self = 0, shadow = 0, passed_over = 0;
};

/// Every point by both filters.
Outcome compare(const Scene& scene, const BodyFilter& filter, const RangeNoise& noise,
                CloudBodyFilter& drawn, Random& random) {
  Outcome outcome;
  drawn.draw(filter, noise, scene.samples, scene.places);
  for (std::size_t k = 0; k < scene.places.size(); ++k) {
    const CloudPlace& place = scene.places[k];
    for (int i = 0; i < 60; ++i) {
      const Eigen::Vector3f p =
          (place.T_fixed_sensor.inverse() * pointNear(scene, k, random)).cast<float>();
      const float range = p.norm();
      AssembledScan scan;
      scan.beams.resize(1);
      scan.beams[0].stamp = scene.times[k];
      scan.beams[0].p_fixed = place.T_fixed_sensor * p.cast<double>();
      scan.beams[0].viewpoint = place.T_fixed_sensor.translation();
      scan.beams[0].kind = BeamKind::kReturn;
      BodyFilter exact = filter;
      exact.range_tolerance_m =
          std::max(filter.range_tolerance_m, 5.0 * static_cast<double>(noise.at(range)));
      exact.apply(scene.samples, scan);
      const bool may_meet = drawn.mayMeet(p, range);
      const BeamKind kind = may_meet ? drawn.classify(p, range, k) : BeamKind::kReturn;
      outcome.differences += kind != scan.beams[0].kind ? 1 : 0;
      outcome.self += kind == BeamKind::kSelf ? 1 : 0;
      outcome.shadow += kind == BeamKind::kShadow ? 1 : 0;
      outcome.passed_over += may_meet ? 0 : 1;
    }
  }
  return outcome;
}

TEST(CloudBodyFilterTest, WhatIsDrawnGivesWhatComparingEachPointWithEachShapeGives) {
  CloudBodyFilter drawn;
  Outcome all;
  for (unsigned seed = 0; seed < 300; ++seed) {
    Random random(seed);
    const Scene scene = sceneOf(random, random.integer(1, 26), random.integer(1, 6));
    BodyFilter filter;
    filter.range_tolerance_m = random.uniform(0.0, 0.1);
    filter.grazing_m = random.uniform(0.0, 0.03);
    filter.shadow_depth_m = random.uniform(0.0, 0.5);
    const RangeNoise noise{random.uniform(0.0, 0.01), random.uniform(0.0, 0.01)};
    const Outcome outcome = compare(scene, filter, noise, drawn, random);
    EXPECT_EQ(outcome.differences, 0U) << seed;
    all.self += outcome.self;
    all.shadow += outcome.shadow;
    all.passed_over += outcome.passed_over;
  }
  EXPECT_GT(all.self, 5000U);
  EXPECT_GT(all.shadow, 500U);
  EXPECT_GT(all.passed_over, 5000U);
}

TEST(CloudBodyFilterTest, ABodyOfMoreShapesThanAWordHasBitsIsFilteredToo) {
  CloudBodyFilter drawn;
  for (unsigned seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const Scene scene = sceneOf(random, 150, 2);
    EXPECT_EQ(compare(scene, {}, {}, drawn, random).differences, 0U) << seed;
  }
}

TEST(CloudBodyFilterTest, WithoutABodyNothingIsMet) {
  CloudBodyFilter drawn;
  drawn.draw({}, {}, {}, {CloudPlace()});
  EXPECT_FALSE(drawn.mayMeet({1.0F, 0.0F, 0.0F}, 1.0F));
  EXPECT_TRUE(drawn.selfCounts().empty());
}

TEST(DirectionCubeTest, EachPointLiesInItsPixel) {
  const DirectionCube cube(64);
  Random random(1);
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3f p = random.point(2.0).cast<float>();
    const auto pixel = static_cast<int>(cube.pixelOf(p));
    ASSERT_LT(pixel, static_cast<int>(cube.pixels()));
    const int face = pixel / (64 * 64), row = pixel / 64 % 64, column = pixel % 64;
    const Eigen::Vector3f middle =
        cube.direction(face, static_cast<float>(row) + 0.5F, static_cast<float>(column) + 0.5F);
    EXPECT_GE(middle.dot(p.normalized()), std::cos(cube.halfDiagonal(1) + 1e-4));
  }
}

}  // namespace
}  // namespace tccm
