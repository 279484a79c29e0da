#include "experiments/visibility_scene.h"

#include <gtest/gtest.h>

#include <set>

#include "experiments/robot_part.h"
#include "robot/kinematics.h"
#include "simulation/robot/dual_arm.h"

namespace tccm::simulation {
namespace {

TEST(VisibilitySceneTest, ArmsKeepClearOfTheSceneAndOfTheObstacle) {
  const auto model = dualArm();
  Kinematics kinematics(model);
  RobotPart arms(model, {"left_*", "right_*"}, 0.02);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const VisibilityScene drawn = visibilityScene(model, 0.08, seed);
    kinematics.update(drawn.joints, {Pose::Identity()});
    arms.moveTo(kinematics.linkPoses());
    EXPECT_EQ(drawn.objects.empty(), drawn.obstacle == "none");
    World things = scene(drawn.scene);
    things.erase(things.begin());  // the floor
    things.insert(things.end(), drawn.objects.begin(), drawn.objects.end());
    if (things.empty()) continue;
    EXPECT_GT(clearance(arms.body(), {bodyOf(things), 0.05}), 0.07) << seed;
  }
}

TEST(VisibilitySceneTest, AllScenesAndObstaclesAreDrawnTheSameForTheSameSeed) {
  const auto model = dualArm();
  std::set<std::string> scenes, obstacles;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const VisibilityScene drawn = visibilityScene(model, 0.08, seed);
    scenes.insert(drawn.scene);
    obstacles.insert(drawn.obstacle);
  }
  EXPECT_EQ(scenes.size(), 3U);
  EXPECT_EQ(obstacles.size(), 4U);
  EXPECT_EQ(visibilityScene(model, 0.08, 5).joints, visibilityScene(model, 0.08, 5).joints);
  EXPECT_NE(visibilityScene(model, 0.08, 5).joints, visibilityScene(model, 0.08, 6).joints);
}

}  // namespace
}  // namespace tccm::simulation
