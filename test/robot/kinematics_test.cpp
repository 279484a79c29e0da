#include "tccm_monitor/robot/kinematics.h"

#include <gtest/gtest.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <fstream>
#include <kdl/treefksolverpos_recursive.hpp>
#include <kdl_parser/kdl_parser.hpp>
#include <map>
#include <sstream>

#include "support/near.h"
#include "support/random.h"
#include "support/shared_data.h"
#include "support/tiny_robot.h"

namespace tccm {
namespace {

using test::axisOf;
using test::ballLink;
using test::jointOf;
using test::limitOf;
using test::linkOf;
using test::Random;

Pose toPose(const KDL::Frame& frame) {
  Pose pose = Pose::Identity();
  for (int row = 0; row < 3; ++row) {
    pose.translation()[row] = frame.p(row);
    for (int column = 0; column < 3; ++column) pose.matrix()(row, column) = frame.M(row, column);
  }
  return pose;
}

/// KDL's answer for the same robot. KDL knows no mimics: their positions are worked out here.
class Oracle {
 public:
  explicit Oracle(const std::string& text) : urdf_(urdf::parseURDF(text)) {
    if (!kdl_parser::treeFromUrdfModel(*urdf_, tree_)) throw std::runtime_error("no KDL tree");
  }

  [[nodiscard]] const urdf::ModelInterface& urdf() const { return *urdf_; }

  Pose linkPose(const std::string& link, const std::map<std::string, double>& positions) {
    KDL::JntArray joints(tree_.getNrOfJoints());
    for (const auto& [name, element] : tree_.getSegments()) {
      if (element.segment.getJoint().getType() == KDL::Joint::None) continue;
      joints(element.q_nr) = position(element.segment.getJoint().getName(), positions);
    }
    KDL::Frame frame;
    KDL::TreeFkSolverPos_recursive solver(tree_);
    EXPECT_GE(solver.JntToCart(joints, frame, link), 0) << link;
    return toPose(frame);
  }

 private:
  double position(const std::string& joint, const std::map<std::string, double>& positions) const {
    const auto& mimic = urdf_->getJoint(joint)->mimic;
    if (mimic) return mimic->multiplier * position(mimic->joint_name, positions) + mimic->offset;
    const auto found = positions.find(joint);
    return found == positions.end() ? 0.0 : found->second;
  }

  urdf::ModelInterfaceSharedPtr urdf_;
  KDL::Tree tree_;
};

/// Links whose collision elements are all primitives.
std::vector<std::string> primitiveLinks(const urdf::ModelInterface& urdf) {
  std::vector<std::string> links;
  for (const auto& [name, link] : urdf.links_) {
    bool primitive = !link->collision_array.empty();
    for (const auto& collision : link->collision_array) {
      primitive = primitive && collision->geometry->type != urdf::Geometry::MESH;
    }
    if (primitive) links.push_back(name);
  }
  return links;
}

/// Every link and shape of random poses is where KDL has it.
void expectKdlsPoses(const std::string& text, unsigned seed) {
  constexpr double kRounding = 1e-9;
  Oracle oracle(text);
  RobotModel::Config config;
  config.monitored_links = primitiveLinks(oracle.urdf());
  const auto model = test::modelOf(text, config);
  ASSERT_FALSE(model->shapes().empty());
  Kinematics kinematics(model);
  Random random(seed);
  for (int i = 0; i < 20; ++i) {
    std::map<std::string, double> by_name;
    std::vector<double> positions;
    for (const JointVariable& variable : model->variables()) {
      positions.push_back(random.uniform(-3.0, 3.0));
      by_name[variable.name] = positions.back();
    }
    const Pose T_fixed_root = random.pose(2.0);
    kinematics.update(positions, T_fixed_root);
    for (std::size_t k = 0; k < model->links().size(); ++k) {
      const Pose expected = T_fixed_root * oracle.linkPose(model->links()[k], by_name);
      EXPECT_TRUE(test::isNearly(kinematics.linkPoses()[k], expected, kRounding))
          << model->links()[k];
    }
    for (std::size_t k = 0; k < model->shapes().size(); ++k) {
      const LinkShape& shape = model->shapes()[k];
      EXPECT_TRUE(test::isNearly(kinematics.shapePoses()[k],
                                 kinematics.linkPoses()[shape.link] * shape.T_link_shape,
                                 kRounding));
    }
  }
}

std::optional<std::string> textOf(const std::string& path) {
  std::ifstream file(path);
  if (!file) return std::nullopt;
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Two branches; every kind of joint, oblique axes that are not of length 1, and mimics of mimics.
std::string everyJointUrdf() {
  const std::string origin = "<origin xyz=\"0.1 -0.2 0.3\" rpy=\"0.4 -0.5 0.6\"/>";
  return test::robotOf(
      ballLink("base") + ballLink("a") + ballLink("b") + linkOf("c") + ballLink("d") +
      ballLink("e") + ballLink("f") + ballLink("g") +
      jointOf("turn", "revolute", "base", "a", origin + axisOf("1 2 -2") + limitOf("-3", "3")) +
      jointOf("spin", "continuous", "a", "b", origin + axisOf("0 0 -1")) +
      jointOf("weld", "fixed", "b", "c", origin) +
      jointOf("push", "prismatic", "c", "d", origin + axisOf("0 3 4") + limitOf("-3", "3")) +
      jointOf("follow", "revolute", "d", "e",
              axisOf("1 0 0") + limitOf("-3", "3") +
                  "<mimic joint=\"turn\" multiplier=\"-1.5\" offset=\"0.2\"/>") +
      jointOf("trail", "prismatic", "base", "f",
              origin + axisOf("0 1 1") + limitOf("-3", "3") +
                  "<mimic joint=\"follow\" multiplier=\"0.5\" offset=\"-0.1\"/>") +
      jointOf("other", "revolute", "f", "g", origin + axisOf("0 1 0") + limitOf("-3", "3")));
}

TEST(KinematicsTest, EveryKindOfJointIsPlacedAsByKdl) { expectKdlsPoses(everyJointUrdf(), 1); }

TEST(KinematicsTest, ARobotWithoutJointsIsWhereItsRootIs) {
  const auto model = test::modelOf(test::robotOf(ballLink("base")));
  Kinematics kinematics(model);
  const Pose T_fixed_root = Random(1).pose(1.0);
  kinematics.update({}, T_fixed_root);
  EXPECT_TRUE(test::isNearly(kinematics.shapePoses()[0], T_fixed_root, 0.0));
}

TEST(KinematicsTest, ASlidIsAsFarAsItsPosition) {
  Kinematics kinematics(test::sliderModel());
  kinematics.update({0.25, -0.5}, Pose::Identity());
  EXPECT_TRUE(test::isNearly(Vector3(kinematics.shapePoses()[0].translation()),
                             Vector3(0.25, 0.0, 0.5), 1e-12));
  EXPECT_TRUE(test::isNearly(Vector3(kinematics.shapePoses()[1].translation()),
                             Vector3(-0.5, 0.5, 0.5), 1e-12));
}

TEST(KinematicsTest, AnUpdateLeavesNothingOfTheOneBefore) {
  const auto model = test::modelOf(everyJointUrdf());
  Kinematics used(model), fresh(model);
  Random random(2);
  std::vector<double> positions(model->variables().size());
  for (int i = 0; i < 5; ++i) {
    for (double& position : positions) position = random.uniform(-2.0, 2.0);
    used.update(positions, Pose::Identity());
  }
  fresh.update(positions, Pose::Identity());
  for (std::size_t k = 0; k < model->links().size(); ++k) {
    EXPECT_TRUE(test::isNearly(used.linkPoses()[k], fresh.linkPoses()[k], 0.0));
  }
}

TEST(KinematicsTest, TheSimulatedRobotIsPlacedAsByKdl) {
  const auto text = textOf(std::string(TCCM_SOURCE_DIR) + "/simulation/robot/dual_arm.urdf");
  ASSERT_TRUE(text);
  expectKdlsPoses(*text, 3);
}

class RobotKinematicsTest : public ::testing::TestWithParam<const char*> {};

TEST_P(RobotKinematicsTest, LinksWithPrimitivesArePlacedAsByKdl) {
  const auto text = textOf(test::sharedDataFolder() + "/robots/" + GetParam());
  if (!text) GTEST_SKIP() << "robots/" << GetParam() << " is not in the shared data";
  expectKdlsPoses(*text, 4);
}

INSTANTIATE_TEST_SUITE_P(SharedData, RobotKinematicsTest,
                         ::testing::Values("pr2_moveit/pr2.urdf", "baxter/baxter.urdf",
                                           "ur5/ur5_robot.urdf",
                                           "panda_primitives/panda_collision.urdf"));

}  // namespace
}  // namespace tccm
