/// A check of a robot that may move takes no memory from the heap once it has run for a while, with
/// and without a commanded trajectory: an allocation may take arbitrarily long.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "check/checker_config.h"
#include "support/table_scene.h"

namespace {

std::atomic<bool> is_counting{false};
std::atomic<int> allocations{0};

void* allocated(std::size_t size) {
  if (is_counting) ++allocations;
  void* memory = std::malloc(size > 0 ? size : 1);
  if (!memory) throw std::bad_alloc();
  return memory;
}

}  // namespace

void* operator new(std::size_t size) { return allocated(size); }
void* operator new[](std::size_t size) { return allocated(size); }
void* operator new(std::size_t size, const std::nothrow_t& /*tag*/) noexcept {
  if (is_counting) ++allocations;
  return std::malloc(size > 0 ? size : 1);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t /*size*/) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t /*size*/) noexcept { std::free(memory); }
void operator delete(void* memory, const std::nothrow_t& /*tag*/) noexcept { std::free(memory); }

namespace tccm {
namespace {

constexpr double kStart = 100.0;   // [s]
constexpr double kWarm = 0.5;      // [s]
constexpr double kCycle = 0.025;   // [s]
constexpr double kPeriod = 2.0;    // [s] of the arms' swinging
constexpr double kSwing = 0.15;    // [rad]
constexpr double kOutwards = 0.2;  // [rad]

/// The dual-arm robot swings both arms over the table, apart and back; nothing touches.
class CheckAllocatesNothingTest : public ::testing::Test {
 protected:
  CheckAllocatesNothingTest() {
    for (const JointVariable& variable : model_->variables()) names_.push_back(variable.name);
    checker_->setRootPose(0, Time(), Pose::Identity(), true);
  }

  /// A link that is hidden in part stops nothing.
  /// @param sensors how many; all see the same.
  static Checker::Config config(int sensors = 1) {
    Checker::Config config;
    for (int i = 0; sensors > 1 && i < sensors; ++i) {
      config.inputs.sensors.push_back({"sensor" + std::to_string(i), i == 0});
    }
    config.pose.occlusion.hidden_fraction = config.evidence.unseen_fraction_max = 1.0;
    return config;
  }

  [[nodiscard]] std::vector<double> positionsAt(double time_s) const {
    std::vector<double> positions = test::armsAhead(*model_, -0.8);
    const double roll = kOutwards + 0.5 * kSwing * (1.0 - std::cos(2.0 * M_PI * time_s / kPeriod));
    positions[simulation::variableIndex(*model_, "left_shoulder_roll_joint")] = roll;
    positions[simulation::variableIndex(*model_, "right_shoulder_roll_joint")] = -roll;
    return positions;
  }

  /// Its points come thicker and thicker.
  [[nodiscard]] JointTrajectory trajectory(double duration_s) const {
    JointTrajectory trajectory;
    trajectory.names = names_;
    double time_s = 0.0;
    for (double step = 0.2; time_s < duration_s; step = std::max(0.93 * step, 0.01)) {
      trajectory.points.push_back({time_s, positionsAt(time_s), {}, {}});
      time_s += step;
    }
    return trajectory;
  }

  /// How often checks allocate while the robot moves, for as long. Maps have room for more cuboids,
  /// as a mapper's have.
  int allocationsOver(double duration_s) {
    constexpr std::size_t kRoom = 4000;
    allocations = 0;
    for (const double end_s = time_s_ + duration_s; time_s_ < end_s; time_s_ += kCycle) {
      const Time now(fromSeconds(kStart + time_s_));
      for (std::size_t i = 0; i < checker_->inputs().sensors().size(); ++i) {
        auto map = std::make_shared<CuboidMap>(map_);
        map->cuboids.reserve(kRoom);
        map->stamp = now;
        map->serial = ++serial_;
        test::refreshLooks(*map);
        checker_->setMap(now, std::move(map), i);
      }
      checker_->addJoints(now, now, names_, positionsAt(time_s_), {});
      is_counting = true;
      const Verdict& verdict = checker_->check(now);
      is_counting = false;
      EXPECT_EQ(verdict.reason, Reason::kClear) << time_s_ << " s: " << verdict.detail;
      follows_ = follows_ || verdict.follows_trajectory;
      hiding_ = std::max(hiding_, verdict.now.occluding_cuboids.size());
    }
    return allocations;
  }

  const std::shared_ptr<const RobotModel> model_ = simulation::dualArm();
  std::vector<std::string> names_;
  CuboidMap map_ = test::tableMap();
  std::unique_ptr<Checker> checker_ = std::make_unique<Checker>(model_, config());
  double time_s_ = 0.0;
  std::uint32_t serial_ = 0;
  bool follows_ = false;
  std::size_t hiding_ = 0;
};

TEST_F(CheckAllocatesNothingTest, WhileTheRobotMoves) {
  EXPECT_GT(allocationsOver(kWarm), 0) << "the first checks may";
  EXPECT_EQ(allocationsOver(3.0 * kPeriod), 0);
  EXPECT_FALSE(follows_);
}

TEST_F(CheckAllocatesNothingTest, WhileTheRobotMovesBeforeSeveralSensors) {
  checker_ = std::make_unique<Checker>(model_, config(3));
  checker_->setRootPose(0, Time(), Pose::Identity(), true);
  allocationsOver(kWarm);
  EXPECT_EQ(allocationsOver(3.0 * kPeriod), 0);
}

TEST_F(CheckAllocatesNothingTest, WhileItFollowsATrajectoryWhosePointsComeThickerAndThicker) {
  const Time before(fromSeconds(kStart) - std::chrono::milliseconds(10));
  checker_->addJoints(before, before, names_, positionsAt(0.0), {});
  ASSERT_EQ(checker_->command(Time(fromSeconds(kStart)), trajectory(4.0 * kPeriod)), "");
  allocationsOver(kWarm);
  EXPECT_EQ(allocationsOver(3.0 * kPeriod), 0);
  EXPECT_TRUE(follows_);
}

TEST_F(CheckAllocatesNothingTest, WhenSomethingComesToHideAPartOfAnArm) {
  allocationsOver(kWarm);
  EXPECT_EQ(hiding_, 0U);
  test::addBlock(map_, {Vector3(0.30, 0.16, 1.12), Vector3(0.32, 0.20, 1.14)}, 3);
  test::lookAround(map_);
  EXPECT_EQ(allocationsOver(3.0 * kPeriod), 0);
  EXPECT_GT(hiding_, 0U);
}

}  // namespace
}  // namespace tccm
