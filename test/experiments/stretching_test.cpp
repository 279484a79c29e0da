#include "experiments/stretching.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "experiments/exact_clearance.h"
#include "experiments/robot_part.h"
#include "simulation/robot/dual_arm.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

class StretchingTest : public ::testing::Test {
 protected:
  StretchingTest() {
    World table = scene("table");
    table.erase(std::remove_if(table.begin(), table.end(),
                               [](const SceneObject& object) { return object.name == "floor"; }),
                table.end());
    scene_ = bodyOf(table);
  }

  /// Of both arms, at most half a second before or after each place of the path, by FCL.
  [[nodiscard]] double leastClearance(const ArmPath& path, const StretchConfig& config) {
    double least = 1e9;
    for (double way = 0.0; way <= path.length(); way += 0.05) {
      for (const double later_s : {-config.horizon_s, 0.0, config.horizon_s}) {
        std::vector<double> joints = path.positions(way);
        const std::vector<double> slopes = path.slopes(way);
        for (std::size_t j = 0; j < joints.size(); ++j) {
          joints[j] += later_s * config.speed_mps * slopes[j];
        }
        kinematics_.update(joints, {Pose::Identity()});
        arms_.moveTo(kinematics_.linkPoses());
        least = std::min(least, exactClearance(arms_.body().body(), scene_));
      }
    }
    return least;
  }

  std::shared_ptr<const RobotModel> model_ = dualArm();
  Kinematics kinematics_{model_};
  RobotPart arms_{model_, {"left_*", "right_*"}, 0.02};
  Body scene_;
};

TEST_F(StretchingTest, TheArmKeepsClearAndMostlyNoMoreThanItMust) {
  int tight = 0;
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    const StretchConfig config{seed, 0.25, 0.08};
    const ArmPath path = stretchOver(model_, scene("table"), config);
    EXPECT_GT(path.length(), 0.1);
    const double least = leastClearance(path, config);
    EXPECT_GT(least, 0.077) << seed;  // from points 30 mm apart: up to 2 mm too large
    tight += least < 0.1;
  }
  EXPECT_GE(tight, 3) << "the others go as low as the arm can";
}

TEST_F(StretchingTest, TheSameSeedGivesTheSamePathAndAnotherAnother) {
  const auto endOf = [this](std::uint64_t seed) {
    const ArmPath path = stretchOver(model_, scene("empty"), {seed, 0.25, 0.08});
    return path.positions(path.length());
  };
  EXPECT_EQ(endOf(5), endOf(5));
  EXPECT_NE(endOf(5), endOf(6));
}

TEST_F(StretchingTest, ASceneThatFillsTheSpaceLeavesNoWay) {
  const World block = {{"block", Box{Vector3(2.0, 2.0, 2.0)}, at(0.0, 0.0, 1.0), {}}};
  EXPECT_THROW(static_cast<void>(stretchOver(model_, block, {1, 0.25, 0.08})), ConfigError);
}

}  // namespace
}  // namespace tccm::simulation
