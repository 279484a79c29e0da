/// Boxes that are turned anyhow, in frames that stand anywhere, against FCL.

#include <fcl/narrowphase/collision.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>

#include "check/keep_out.h"
#include "check/pose_check.h"
#include "geometry/distance.h"
#include "support/fcl_overlap.h"
#include "support/random.h"
#include "support/tiny_robot.h"

namespace tccm {
namespace {

using test::Random;

bool touchByFcl(const Shape& shape, const Pose& T_fixed_shape, const Box& box,
                const Pose& T_fixed_box) {
  const fcl::CollisionObjectd region(test::ToFcl{}(box), T_fixed_box.linear(),
                                     T_fixed_box.translation());
  const fcl::CollisionObjectd placed(std::visit(test::ToFcl{}, shape), T_fixed_shape.linear(),
                                     T_fixed_shape.translation());
  fcl::CollisionRequestd request;
  request.gjk_solver_type = fcl::GST_LIBCCD;
  fcl::CollisionResultd result;
  return fcl::collide(&placed, &region, request, result) > 0;
}

/// Random boxes in the fixed frame and in that of a base that stands anywhere.
class KeepOutGeometryTest : public ::testing::Test {
 protected:
  void makeRegions(Random& random, int count) {
    regions_ = std::make_unique<KeepOut>(KeepOut::Config(), *model_, "map");
    regions_->take(*model_, body_);
    const Pose T_fixed_base = random.pose(0.5);
    T_fixed_boxes_.clear();
    boxes_.clear();
    for (int i = 0; i < count; ++i) {
      const bool is_of_base = random.chance(0.5);
      KeepOutRegion region{std::to_string(i), is_of_base ? "base" : "", Box{}, random.pose(0.4)};
      for (int k = 0; k < 3; ++k) region.box.half_extents[k] = 0.5 * random.size();
      regions_->set(region, *model_, "map");
      boxes_.push_back(region.box);
      T_fixed_boxes_.push_back(is_of_base ? T_fixed_base * region.T_frame_box : region.T_frame_box);
    }
    regions_->place({T_fixed_base}, true);
  }
  /// So near to one of the regions that either answer is frequent.
  [[nodiscard]] Pose poseNear(Random& random, const Shape& shape, std::size_t region) const {
    Pose pose = random.pose(0.0);
    const double reach = boundingRadius(shape);
    const Vector3 half = boxes_[region].half_extents.array() + 1.3 * reach;
    pose.translation() = T_fixed_boxes_[region] * random.pointIn({-half, half});
    return pose;
  }

  const std::shared_ptr<const RobotModel> model_ = test::sliderModel();
  const UsedBody body_{*model_, LinkUse(), kCollisionKeys};
  std::unique_ptr<KeepOut> regions_;
  std::vector<Box> boxes_;
  std::vector<Pose> T_fixed_boxes_;
};

TEST_F(KeepOutGeometryTest, WhatTouchesAgreesWithFclForEveryKindOfPrimitive) {
  constexpr double kTouching = 1e-5;  // [m]; FCL stops at about 1e-6
  for (std::size_t kind = 0; kind < test::kShapeKinds; ++kind) {
    Random random(40 + static_cast<unsigned>(kind));
    constexpr int kPairs = 8000;
    int touching = 0, wrong = 0;
    for (int i = 0; i < kPairs; ++i) {
      if (i % 20 == 0) makeRegions(random, 4);
      const Shape shape = random.shape(kind);
      const auto region = static_cast<std::uint32_t>(random.integer(0, 3));
      const Pose pose = poseNear(random, shape, region);
      const bool ours = regions_->touches(region, shape, pose);
      touching += ours;
      EXPECT_EQ(ours, regions_->distanceTo(region, shape, pose) == 0.0 ||
                          regions_->distanceTo(region, shape, pose) < 1e-9);
      const auto byFcl = [&](double growth) {
        const Box grown{boxes_[region].half_extents.array() + growth};
        return touchByFcl(shape, pose, grown, T_fixed_boxes_[region]);
      };
      if (ours != byFcl(0.0) && byFcl(-kTouching) == byFcl(kTouching)) ++wrong;
    }
    EXPECT_EQ(wrong, 0) << kind;
    EXPECT_GT(touching, kPairs / 8) << kind;
    EXPECT_LT(touching, kPairs * 7 / 8) << kind;
  }
}

TEST_F(KeepOutGeometryTest, TheNearestIsTheOneWhosePointsComeNearest) {
  Random random(44);
  constexpr int kShapes = 2000;
  int found = 0;
  for (int i = 0; i < kShapes; ++i) {
    if (i % 10 == 0) makeRegions(random, 5);
    const Shape shape = random.shape(static_cast<std::size_t>(i) % test::kShapeKinds);
    const Pose pose = random.pose(0.6);
    std::vector<double> distances;
    for (std::uint32_t k = 0; k < 5; ++k) {
      distances.push_back(regions_->distanceTo(k, shape, pose));
      // No point of the box is nearer.
      for (int n = 0; n < 20; ++n) {
        const Vector3 half = boxes_[k].half_extents;
        const Vector3 p_fixed = T_fixed_boxes_[k] * random.pointIn({-half, half});
        EXPECT_GE(distance(shape, pose.inverse() * p_fixed), distances.back() - 2e-6);
      }
      // Of a ball or capsule all that is within a distance is one of them again.
      if (shape.index() < 2 || distances.back() == 0.0) continue;
      const auto grown = [&](double by) { return expanded(shape, {1.0, distances.back() + by}); };
      EXPECT_TRUE(touchByFcl(grown(1e-5), pose, boxes_[k], T_fixed_boxes_[k]));
      EXPECT_FALSE(touchByFcl(grown(-1e-5), pose, boxes_[k], T_fixed_boxes_[k]));
    }
    const auto least = std::min_element(distances.begin(), distances.end());
    const double nearer_than_m = random.uniform(0.0, 0.5);
    const auto nearest = regions_->nearest(shape, pose, 0, nearer_than_m);
    ASSERT_EQ(nearest.has_value(), *least < nearer_than_m) << *least;
    if (!nearest) continue;
    ++found;
    EXPECT_NEAR(nearest->distance_m, *least, 1e-6);
    const std::vector<std::uint32_t> but{nearest->region};
    const auto next = regions_->nearest(shape, pose, 0, nearer_than_m, &but);
    EXPECT_TRUE(!next || next->region != nearest->region);
    distances[nearest->region] = std::numeric_limits<double>::infinity();
    EXPECT_EQ(next.has_value(),
              *std::min_element(distances.begin(), distances.end()) < nearer_than_m);
  }
  EXPECT_GT(found, kShapes / 4);
}

}  // namespace
}  // namespace tccm
