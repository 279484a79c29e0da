#include "simulation/mount.h"

#include <gtest/gtest.h>

#include <cmath>

#include "robot/kinematics.h"
#include "simulation/robot/dual_arm.h"
#include "support/error_of.h"

namespace tccm::simulation {
namespace {

/// With all joints at 0: the arms hang down.
Pose poseOf(const Mount& mount) {
  const auto model = dualArm();
  Kinematics kinematics(model);
  kinematics.update(std::vector<double>(model->variables().size(), 0.0), {Pose::Identity()});
  return kinematics.linkPoses()[linkIndex(*model, mount.link)] * mount.T_link_sensor;
}

TEST(MountTest, EachPlaceOfTheCameraIsOnTheRobotAndUpright) {
  for (const std::string& place : cameraPlaces()) {
    const Pose T_fixed_camera = poseOf(cameraMount(place));
    EXPECT_TRUE(isRigid(T_fixed_camera)) << place;
    EXPECT_NEAR(T_fixed_camera.linear().determinant(), 1.0, 1e-9);
    if (place == "wrist") continue;
    EXPECT_NEAR(T_fixed_camera.linear().col(0).z(), 0.0, 1e-9) << place;  // right is level
    EXPECT_LT(T_fixed_camera.linear().col(1).z(), -0.5) << place;         // down is down
  }
}

TEST(MountTest, CamerasLookAtTheTableAndTheOneOnTheWristAlongTheHand) {
  const Vector3 table(0.7, 0.0, 0.75);
  for (const std::string place : {"chest", "head", "side"}) {
    const Vector3 p_camera = poseOf(cameraMount(place)).inverse() * table;
    EXPECT_GT(p_camera.z(), 0.3) << place;
    EXPECT_LT(std::abs(p_camera.x()) / p_camera.z(), 0.7) << place;
    EXPECT_LT(std::abs(p_camera.y()) / p_camera.z(), 0.6) << place;
  }
  EXPECT_LT(poseOf(cameraMount("wrist")).linear().col(2).z(), -0.9);  // it hangs down
}

TEST(MountTest, TheLidarIsAboveTheHeadAndLooksDownAhead) {
  const Pose T_fixed_lidar = poseOf(lidarMount());
  EXPECT_GT(T_fixed_lidar.translation().z(), 1.6);
  EXPECT_LT(T_fixed_lidar.linear().col(0).z(), -0.5);
}

TEST(MountTest, SensorsGoByTheirNames) {
  using Kinds = std::vector<SensorKind>;
  EXPECT_EQ(sensorKinds({"laser"}), Kinds{SensorKind::kLaser});
  EXPECT_EQ(sensorKinds({"lidar", "camera"}), (Kinds{SensorKind::kLidar, SensorKind::kCamera}));
  for (const std::string& known : sensorNames()) EXPECT_EQ(name(sensorKind(known)), known);
}

TEST(MountTest, RefusesSensorsAndPlacesThatThereAreNot) {
  EXPECT_EQ(test::errorOf([] { static_cast<void>(sensorKinds({"radar"})); }),
            "sensors: radar is none of laser, camera, lidar");
  EXPECT_EQ(test::errorOf([] {
              static_cast<void>(sensorKinds({"laser", "laser"}));
            }),
            "sensors: laser is named twice");
  EXPECT_EQ(test::errorOf([] { static_cast<void>(sensorKinds({})); }),
            "sensors: name one at least of laser, camera, lidar");
  EXPECT_EQ(test::errorOf([] { static_cast<void>(cameraMount("knee")); }),
            "camera: knee is none of chest, wrist, head, side");
}

}  // namespace
}  // namespace tccm::simulation
