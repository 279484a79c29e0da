/// A check of a robot that may move takes no memory from the heap once it has run for a while, with
/// and without a commanded trajectory: an allocation may take arbitrarily long.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "check/checker_config.h"
#include "support/counted_allocations.h"
#include "support/table_scene.h"

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

  /// Near the arms, turned, and in both frames.
  void setRegions() {
    for (int i = 0; i < 8; ++i) {
      KeepOutRegion region{std::to_string(i), i % 2 == 0 ? "" : "base_link",
                           Box{Vector3(0.05, 0.3, 0.5)}};
      region.T_frame_box.translation() = Vector3(1.05, 0.2 * (i - 4), 1.0);
      region.T_frame_box.rotate(Eigen::AngleAxisd(0.1 * i, Vector3::UnitZ()));
      checker_->setKeepOut(region);
    }
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
    test::allocations = 0;
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
      test::is_counting = true;
      const Verdict& verdict = checker_->check(now);
      test::is_counting = false;
      EXPECT_EQ(verdict.reason, Reason::kClear) << time_s_ << " s: " << verdict.detail;
      follows_ = follows_ || verdict.follows_trajectory;
      hiding_ = std::max(hiding_, verdict.now.occluding_cuboids.size());
    }
    return test::allocations;
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

TEST_F(CheckAllocatesNothingTest, WhileTheRobotMovesBetweenRegionsToKeepOutOf) {
  setRegions();
  allocationsOver(kWarm);
  EXPECT_EQ(allocationsOver(3.0 * kPeriod), 0);
}

TEST_F(CheckAllocatesNothingTest, WhileTheRobotMovesBeforeSeveralSensors) {
  checker_ = std::make_unique<Checker>(model_, config(3));
  checker_->setRootPose(0, Time(), Pose::Identity(), true);
  allocationsOver(kWarm);
  EXPECT_EQ(allocationsOver(3.0 * kPeriod), 0);
}

TEST_F(CheckAllocatesNothingTest, WhileExemptionsMoveAndTheirFramesComeAndGo) {
  const Time begin(fromSeconds(kStart));
  const std::string frames[] = {"", "left_palm_link", "cup"};
  for (const std::string& frame : frames) {
    Exemption exemption{
        "in '" + frame + "'", "left_palm_link", {Sphere{0.2}, Pose::Identity()}, {}};
    exemption.frame = frame;
    checker_->addExemption(begin, exemption, 50.0);
  }
  allocationsOver(kWarm);
  std::size_t fresh = 0, old = 0;
  for (int i = 0; i < 3; ++i) {
    checker_->setExemptFrame("cup", Time(fromSeconds(kStart + time_s_)), Pose::Identity(), false);
    EXPECT_EQ(allocationsOver(0.3), 0);
    for (const Exemption& one : checker_->exemptions()) {
      fresh += one.frame == "cup" && one.state == Exemption::State::kInForce ? 1 : 0;
    }
    EXPECT_EQ(allocationsOver(0.7), 0);
    for (const Exemption& one : checker_->exemptions()) {
      old += one.state == Exemption::State::kTransformOld ? 1 : 0;
    }
  }
  EXPECT_EQ(fresh, 3U);
  EXPECT_EQ(old, 3U);
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
