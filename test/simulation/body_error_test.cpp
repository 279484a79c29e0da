#include "simulation/body_error.h"

#include <gtest/gtest.h>

#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

const std::vector<LinkShape> kDescribed = {{0, Sphere{0.05}, Pose::Identity()},
                                           {1, Capsule{0.04, 0.1}, Pose::Identity()}};

TEST(BodyErrorTest, ThickerAndThinnerMoveEverySurfaceByTheError) {
  const auto thicker = trueShapes(kDescribed, {BodyError::Kind::kThicker, 0.005}, 1);
  const auto thinner = trueShapes(kDescribed, {BodyError::Kind::kThinner, 0.005}, 1);
  for (std::size_t i = 0; i < kDescribed.size(); ++i) {
    const Vector3 outside(0.2, 0.0, 0.0);
    const double described = distance(kDescribed[i].shape, outside);
    EXPECT_NEAR(distance(thicker[i].shape, outside), described - 0.005, 1e-12);
    EXPECT_NEAR(distance(thinner[i].shape, outside), described + 0.005, 1e-12);
    EXPECT_TRUE(thicker[i].pose.isApprox(Pose::Identity()));
  }
}

TEST(BodyErrorTest, DisplacedMovesEachPrimitiveAsFarAndEachElsewhere) {
  const auto displaced = trueShapes(kDescribed, {BodyError::Kind::kDisplaced, 0.005}, 1);
  for (const PlacedShape& placed : displaced) {
    EXPECT_NEAR(placed.pose.translation().norm(), 0.005, 1e-12);
  }
  EXPECT_GT((displaced[0].pose.translation() - displaced[1].pose.translation()).norm(), 1e-4);
}

TEST(BodyErrorTest, NothingGetsThinnerThanNothing) {
  EXPECT_THROW(trueShapes(kDescribed, {BodyError::Kind::kThinner, 0.06}, 1), ConfigError);
  EXPECT_THROW(static_cast<void>(bodyErrorKind("bent")), ConfigError);
}

}  // namespace
}  // namespace tccm::simulation
