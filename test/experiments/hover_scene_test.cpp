#include "experiments/hover_scene.h"

#include <gtest/gtest.h>

#include <set>

#include "experiments/robot_part.h"
#include "robot/kinematics.h"
#include "simulation/robot/dual_arm.h"

namespace tccm::simulation {
namespace {

/// The arm of one scene anywhere along its path.
class ArmOnPath {
 public:
  explicit ArmOnPath(const HoverScene& scene)
      : scene_(scene), arm_(model_, hoveringLinks(), 0.01), things_(bodyOf(scene.things), 0.01) {}

  [[nodiscard]] double clearanceAt(double way_m) {
    kinematics_.update(scene_.path.positions(way_m), {Pose::Identity()});
    arm_.moveTo(kinematics_.linkPoses());
    return clearance(arm_.body(), things_);
  }
  [[nodiscard]] Vector3 palmAt(double way_m) {
    kinematics_.update(scene_.path.positions(way_m), {Pose::Identity()});
    return kinematics_.linkPoses()[linkIndex(*model_, "right_palm_link")].translation();
  }

 private:
  std::shared_ptr<const RobotModel> model_ = dualArm();
  const HoverScene& scene_;
  Kinematics kinematics_{model_};
  RobotPart arm_;
  SampledBody things_;
};

TEST(HoverSceneTest, TheHandHoversTheGapOverTheObjectAndMeetsItWhereItSays) {
  const auto model = dualArm();
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const HoverScene scene = hoverScene(model, {}, seed);
    ArmOnPath arm(scene);
    EXPECT_GE(scene.gap_m, 0.06);
    EXPECT_LE(scene.gap_m, 0.12);
    // The gap is the hand's; the forearm may be a little nearer.
    EXPECT_NEAR(arm.clearanceAt(scene.hover_m), scene.gap_m, 5e-3) << seed;
    EXPECT_GT(arm.clearanceAt(scene.touch_m - 3e-3), 0.0) << seed;
    EXPECT_EQ(arm.clearanceAt(scene.touch_m + 3e-3), 0.0) << seed;
    EXPECT_GE(scene.path.length(), scene.touch_m + 0.01);
  }
}

TEST(HoverSceneTest, OnItsWayThereTheHandKeepsTheGap) {
  const auto model = dualArm();
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const HoverScene scene = hoverScene(model, {}, seed);
    ArmOnPath arm(scene);
    for (double way = 0.0; way < scene.hover_m; way += 0.03) {
      EXPECT_GT(arm.clearanceAt(way), 0.9 * scene.gap_m - 2e-3) << seed << " " << scene.approach;
    }
  }
}

TEST(HoverSceneTest, FromHoveringTheHandGoesStraightDown) {
  const HoverScene scene = hoverScene(dualArm(), {}, 3);
  ArmOnPath arm(scene);
  const Vector3 hover = arm.palmAt(scene.hover_m);
  for (double way = scene.hover_m; way < scene.path.length(); way += 0.01) {
    const Vector3 below = hover - Vector3(0.0, 0.0, way - scene.hover_m);
    EXPECT_LT((arm.palmAt(way) - below).norm(), 3e-3);
  }
}

TEST(HoverSceneTest, TheSameSeedGivesTheSameAndAllKindsAreDrawn) {
  const auto model = dualArm();
  std::set<std::string> objects, approaches;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const HoverScene scene = hoverScene(model, {}, seed);
    objects.insert(scene.object);
    approaches.insert(scene.approach);
  }
  EXPECT_EQ(objects.size(), 5U);
  EXPECT_EQ(approaches.size(), 4U);
  const HoverScene once = hoverScene(model, {}, 7);
  const HoverScene again = hoverScene(model, {}, 7);
  EXPECT_EQ(once.gap_m, again.gap_m);
  EXPECT_EQ(once.path.positions(once.hover_m), again.path.positions(again.hover_m));
  EXPECT_NE(once.gap_m, hoverScene(model, {}, 8).gap_m);
}

TEST(HoverSceneTest, ARangeThatEndsBeforeItBeginsIsRefused) {
  HoverRanges ranges;
  ranges.gap_max_m = 0.05;
  EXPECT_ANY_THROW((void)hoverScene(dualArm(), ranges, 1));
}

}  // namespace
}  // namespace tccm::simulation
