/// A cloud on its way through the stage allocates nothing once clouds of its size have been
/// there: an allocation may take arbitrarily long.

#include <gtest/gtest.h>

#include "support/counted_allocations.h"
#include "support/depth_view.h"

namespace tccm {
namespace {

int allocationsOf(const Cloud& cloud) {
  const test::DepthView view;
  CloudStage stage({}, view.model());
  view.tellJoints(stage);
  const PosePath T_fixed_sensor = view.sensorPath();
  const auto T_fixed_roots = view.rootPaths();
  EXPECT_EQ(stage.assemble(cloud, T_fixed_sensor, T_fixed_roots), "");
  test::allocations = 0;
  test::is_counting = true;
  for (int i = 0; i < 5; ++i) {
    static_cast<void>(stage.assemble(cloud, T_fixed_sensor, T_fixed_roots));
  }
  test::is_counting = false;
  return test::allocations;
}

TEST(CloudAllocatesNothingTest, ACamerasCloudsAllocateNothingAfterTheFirst) {
  EXPECT_EQ(allocationsOf(test::DepthView().camera(1).cloud), 0);
}

TEST(CloudAllocatesNothingTest, NorDoALidarsOrganisedOrNot) {
  Cloud cloud = test::DepthView().lidar(1).cloud;
  EXPECT_EQ(allocationsOf(cloud), 0);
  cloud.width *= cloud.height;
  cloud.height = 1;
  EXPECT_EQ(allocationsOf(cloud), 0);
}

}  // namespace
}  // namespace tccm
