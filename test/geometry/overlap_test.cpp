#include "geometry/overlap.h"

#include <gtest/gtest.h>

#include "support/fcl_overlap.h"
#include "support/placed.h"
#include "support/random.h"

namespace tccm {
namespace {

using test::centred;
using test::grown;
using test::overlapsByFcl;
using test::placedAt;
using test::Random;

struct Pair {
  Shape shape;
  Pose T_fixed_shape;
  UprightBox box;
};

/// 20 x 20 mm cells from 5 mm flat to tall, and boxes of any size.
UprightBox randomBox(Random& random) {
  Vector3 half(0.01, 0.01, 0.5 * (random.chance(0.5) ? 0.005 : random.uniform(0.005, 0.8)));
  if (random.chance(0.25)) half = 0.5 * Vector3(random.size(), random.size(), random.size());
  const Vector3 centre = random.point(0.5);
  return {centre - half, centre + half};
}

/// Placed so that both answers are frequent and neither is obvious.
Pair randomPair(Random& random, std::size_t kind) {
  Pair pair{random.shape(kind), Pose::Identity(), randomBox(random)};
  pair.T_fixed_shape.linear() = random.mixedRotation();
  const double reach = boundingRadius(pair.shape) + 0.5 * pair.box.diagonal().norm();
  const UprightBox around(pair.box.min().array() - 0.5 * reach,
                          pair.box.max().array() + 0.5 * reach);
  pair.T_fixed_shape.translation() = random.pointIn(around);
  return pair;
}

/// FCL's iterative solver stops at about 1e-6; a pair that touches more narrowly than this may go
/// either way. [m]
constexpr double kTouching = 1e-5;

TEST(OverlapTest, AgreesWithFclOnRandomPairsOfEveryKind) {
  for (std::size_t kind = 0; kind < test::kShapeKinds; ++kind) {
    Random random(100 + static_cast<unsigned>(kind));
    constexpr int kPairs = 25000;
    int overlapping = 0, touching = 0, wrong = 0;
    for (int i = 0; i < kPairs; ++i) {
      const Pair pair = randomPair(random, kind);
      const bool ours = overlaps(pair.shape, pair.T_fixed_shape, pair.box);
      overlapping += ours;
      if (ours == overlapsByFcl(pair.shape, pair.T_fixed_shape, pair.box)) continue;
      const bool larger = overlaps(pair.shape, pair.T_fixed_shape, grown(pair.box, kTouching));
      const bool smaller = overlaps(pair.shape, pair.T_fixed_shape, grown(pair.box, -kTouching));
      if (larger != smaller) {
        ++touching;
      } else {
        ++wrong;
        EXPECT_LT(wrong, 5) << name(pair.shape) << " pair " << i << " ours: " << ours << "\n"
                            << pair.T_fixed_shape.matrix() << "\n"
                            << pair.box.min().transpose() << " .. " << pair.box.max().transpose();
      }
    }
    const std::string kind_name = name(random.shape(kind));
    EXPECT_EQ(wrong, 0) << kind_name;
    EXPECT_LT(touching, kPairs / 1000) << kind_name;
    EXPECT_GT(overlapping, kPairs / 8) << kind_name;
    EXPECT_LT(overlapping, kPairs * 7 / 8) << kind_name;
  }
}

/// A cylinder whose axis is parallel to the box's edges sees every corner twice in projection.
TEST(OverlapTest, CylindersAlongABoxEdgeThatHoldItsColumnAlwaysOverlap) {
  Random random(7);
  for (int i = 0; i < 50000; ++i) {
    const UprightBox box = randomBox(random);
    const Cylinder cylinder{random.uniform(1e-4, 0.005), random.uniform(0.001, 0.5)};
    Pose pose = Pose::Identity();
    pose.linear() = Eigen::AngleAxisd(random.uniform(-3.1, 3.1), Vector3::UnitZ()) *
                    random.axisRotation() *
                    Eigen::AngleAxisd(random.uniform(-3.1, 3.1), Vector3::UnitZ());
    pose.translation() = random.pointIn(box);
    ASSERT_TRUE(overlaps(cylinder, pose, box)) << "pair " << i;
  }
}

/// An inner point that shape and box share, found by sampling both, is proof of an overlap.
TEST(OverlapTest, EveryCommonPointFoundBySamplingMeansOverlap) {
  for (std::size_t kind = 0; kind < test::kShapeKinds; ++kind) {
    Random random(200 + static_cast<unsigned>(kind));
    int proven = 0;
    for (int i = 0; i < 2000; ++i) {
      const Pair pair = randomPair(random, kind);
      const UprightBox around = bounds(pair.shape, pair.T_fixed_shape).intersection(pair.box);
      if (around.isEmpty()) {
        ASSERT_FALSE(overlaps(pair.shape, pair.T_fixed_shape, pair.box));
        continue;
      }
      const Pose T_shape_fixed = pair.T_fixed_shape.inverse();
      bool found = false;
      for (int k = 0; k < 300 && !found; ++k) {
        found = distance(pair.shape, T_shape_fixed * random.pointIn(around)) == 0.0;
      }
      proven += found;
      if (found) {
        ASSERT_TRUE(overlaps(pair.shape, pair.T_fixed_shape, pair.box))
            << name(pair.shape) << " pair " << i;
      }
    }
    EXPECT_GT(proven, 300);
  }
}

/// Along one of the box's axes the distance is by how much the box may grow before they touch.
void expectDistance(const Shape& shape, const Pose& pose, const UprightBox& box, double expected) {
  constexpr double kRounding = 1e-9;
  EXPECT_FALSE(overlaps(shape, pose, grown(box, expected - kRounding))) << name(shape);
  EXPECT_TRUE(overlaps(shape, pose, grown(box, expected + kRounding))) << name(shape);
}

/// The values FCL's own tests state.
TEST(OverlapTest, BoxOf20x40x50NextToACubeOf10IsFreeAt15Point01AndTouchesAt15) {
  const Box box{{10.0, 20.0, 25.0}};
  const UprightBox cube = centred(10.0, 10.0, 10.0);
  EXPECT_TRUE(overlaps(box, placedAt(15.0, 0.0, 0.0), cube));
  EXPECT_FALSE(overlaps(box, placedAt(15.01, 0.0, 0.0), cube));
  expectDistance(box, placedAt(15.1, 0.0, 0.0), cube, 0.1);
}

/// Stated for two cylinders of radius 5 and length 10; a cube of 10 is as wide along x.
TEST(OverlapTest, CylinderOfRadius5At10Point1IsATenthAway) {
  expectDistance(Cylinder{5.0, 5.0}, placedAt(10.1, 0.0, 0.0), centred(10.0, 10.0, 10.0), 0.1);
  expectDistance(Cylinder{5.0, 5.0}, placedAt(0.0, 0.0, 10.1), centred(10.0, 10.0, 10.0), 0.1);
}

TEST(OverlapTest, CapsuleOfRadius2AndLength4BesideABoxOf1x2x4HasFclsDistances) {
  const Capsule capsule{2.0, 2.0};
  const UprightBox box = centred(1.0, 2.0, 4.0);
  expectDistance(capsule, placedAt(3.0, 0.0, 0.0), box, 0.5);
  expectDistance(capsule, placedAt(0.0, 0.0, 8.0), box, 2.0);
  const Eigen::Matrix3d along_x =
      Eigen::AngleAxisd(0.5 * M_PI, Vector3::UnitY()).toRotationMatrix();
  expectDistance(capsule, placedAt(-10.0, 0.0, 0.0, along_x), box, 5.5);
}

TEST(OverlapTest, SphereOfRadiusPoint7AboveABoxIsPoint07Away) {
  expectDistance(Sphere{0.7}, placedAt(0.15, 0.3, 1.8 + 0.77), centred(0.6, 1.2, 3.6), 0.07);
}

TEST(OverlapTest, TouchingCounts) {
  const UprightBox cube = centred(1.0, 1.0, 1.0);
  EXPECT_TRUE(overlaps(Sphere{0.5}, placedAt(1.0, 0.0, 0.0), cube));
  EXPECT_TRUE(overlaps(Capsule{0.5, 0.25}, placedAt(0.0, 0.0, 1.25), cube));
  EXPECT_TRUE(overlaps(Box{{0.5, 0.5, 0.5}}, placedAt(1.0, 1.0, 1.0), cube));
  EXPECT_TRUE(overlaps(Cylinder{0.5, 0.5}, placedAt(0.0, 0.0, 1.0), cube));
}

TEST(OverlapTest, OneInsideTheOtherOverlaps) {
  for (std::size_t kind = 0; kind < test::kShapeKinds; ++kind) {
    Random random(3);
    const Shape shape = random.shape(kind);
    const Pose pose = random.pose(0.001);
    EXPECT_TRUE(overlaps(shape, pose, centred(2.0, 2.0, 2.0))) << name(shape);
    EXPECT_TRUE(overlaps(shape, pose, centred(0.004, 0.004, 0.004))) << name(shape);
  }
}

/// Only an edge-edge axis separates these two boxes; their upright bounds overlap.
TEST(OverlapTest, CrossedBoxesThatOnlyAnEdgeAxisSeparatesAreFree) {
  const Eigen::Matrix3d tilted =
      (Eigen::AngleAxisd(0.25 * M_PI, Vector3::UnitZ()) *
       Eigen::AngleAxisd(std::acos(std::sqrt(1.0 / 3.0)), Vector3::UnitY()))
          .toRotationMatrix();
  const Box rod{{0.01, 0.01, 2.0}};
  const UprightBox cube = centred(1.0, 1.0, 1.0);
  EXPECT_FALSE(overlaps(rod, placedAt(0.75, -0.75, 0.0, tilted), cube));
  EXPECT_TRUE(overlaps(rod, placedAt(0.25, -0.25, 0.0, tilted), cube));
}

}  // namespace
}  // namespace tccm
