#include "simulation/robot/dual_arm.h"

#include <gtest/gtest.h>

#include "robot/kinematics.h"

namespace tccm::simulation {
namespace {

std::vector<double> zeros(const RobotModel& model) {
  return std::vector<double>(model.variables().size(), 0.0);
}

TEST(DualArmTest, Has26PrimitivesAnd19Joints) {
  const auto model = dualArm();
  EXPECT_EQ(model->shapes().size(), 26U);
  EXPECT_EQ(model->variables().size(), 19U);
}

TEST(DualArmTest, TiltAxisIsAt1515MmAndPositiveLooksDown) {
  const auto model = dualArm();
  Kinematics kinematics(model);
  std::vector<double> joints = zeros(*model);
  kinematics.update(joints, {Pose::Identity()});
  EXPECT_NEAR(kinematics.linkPoses()[linkIndex(*model, "laser_tilt_link")].translation().z(), 1.515,
              1e-9);
  joints[variableIndex(*model, "laser_tilt_joint")] = 0.5;
  kinematics.update(joints, {Pose::Identity()});
  const Pose& T_fixed_laser = kinematics.linkPoses()[linkIndex(*model, "laser_link")];
  EXPECT_LT((T_fixed_laser.linear() * Vector3::UnitX()).z(), -0.4);
}

TEST(DualArmTest, OnlyItsHousingContainsTheSensor) {
  const auto model = dualArm();
  Kinematics kinematics(model);
  kinematics.update(zeros(*model), {Pose::Identity()});
  const Vector3 sensor = kinematics.linkPoses()[linkIndex(*model, "laser_link")].translation();
  for (std::size_t i = 0; i < model->shapes().size(); ++i) {
    const double away =
        distance(model->shapes()[i].shape, kinematics.shapePoses()[i].inverse() * sensor);
    EXPECT_EQ(away == 0.0, model->linkOf(i) == "laser_link") << model->linkOf(i);
  }
}

TEST(DualArmTest, NeighbouringPrimitivesCoverTheArmWithoutGaps) {
  const auto model = dualArm();
  Kinematics kinematics(model);
  kinematics.update(zeros(*model), {Pose::Identity()});
  const auto& links = kinematics.linkPoses();
  const Vector3 shoulder = links[linkIndex(*model, "right_shoulder_pitch_link")].translation();
  const Vector3 palm_end = links[linkIndex(*model, "right_palm_link")] * Vector3(0.0, 0.0, -0.09);
  for (double u = 0.0; u <= 1.0; u += 0.002) {
    const Vector3 p = shoulder + u * (palm_end - shoulder);
    double least = 1.0;
    for (std::size_t i = 0; i < model->shapes().size(); ++i) {
      least = std::min(
          least, distance(model->shapes()[i].shape, kinematics.shapePoses()[i].inverse() * p));
    }
    EXPECT_LT(least, 1e-9) << u;
  }
}

}  // namespace
}  // namespace tccm::simulation
