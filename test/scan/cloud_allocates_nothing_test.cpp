/// A cloud on its way through the stage allocates nothing once clouds of its size have been
/// there: an allocation may take arbitrarily long.

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "support/depth_view.h"

namespace {

std::atomic<bool> is_counting{false};
std::atomic<int> allocations{0};

void* allocated(std::size_t size) {
  if (is_counting) ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t size) { return allocated(size); }
void* operator new[](std::size_t size) { return allocated(size); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }

namespace tccm {
namespace {

int allocationsOf(const Cloud& cloud) {
  const test::DepthView view;
  CloudStage stage({}, view.model());
  view.tellJoints(stage);
  const PosePath T_fixed_sensor = view.sensorPath();
  const auto T_fixed_roots = view.rootPaths();
  EXPECT_EQ(stage.assemble(cloud, T_fixed_sensor, T_fixed_roots), "");
  allocations = 0;
  is_counting = true;
  for (int i = 0; i < 5; ++i) {
    static_cast<void>(stage.assemble(cloud, T_fixed_sensor, T_fixed_roots));
  }
  is_counting = false;
  return allocations;
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
