#include "robot/kinematics.h"

#include <gtest/gtest.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <fstream>
#include <kdl/treefksolverpos_recursive.hpp>
#include <kdl_parser/kdl_parser.hpp>
#include <map>
#include <sstream>
#include <utility>

#include "support/near.h"
#include "support/random.h"
#include "support/shared_data.h"
#include "support/tiny_robot.h"

namespace tccm {
namespace {

using namespace test::urdf_text;
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

  /// The link's pose in the root that transforms have to place, and that root.
  std::pair<std::string, Pose> linkPose(const std::string& link,
                                        const std::map<std::string, double>& positions) {
    urdf::LinkConstSharedPtr root = urdf_->getLink(link);
    while (root->parent_joint && root->parent_joint->type != urdf::Joint::PLANAR &&
           root->parent_joint->type != urdf::Joint::FLOATING) {
      root = root->getParent();
    }
    return {root->name, inBase(root->name, positions).inverse() * inBase(link, positions)};
  }

 private:
  Pose inBase(const std::string& link, const std::map<std::string, double>& positions) {
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

  double position(const std::string& joint, const std::map<std::string, double>& positions) const {
    const auto& mimic = urdf_->getJoint(joint)->mimic;
    if (mimic) return mimic->multiplier * position(mimic->joint_name, positions) + mimic->offset;
    const auto found = positions.find(joint);
    return found == positions.end() ? 0.0 : found->second;
  }

  urdf::ModelInterfaceSharedPtr urdf_;
  KDL::Tree tree_;
};

/// A file of primitives that puts a ball on every link, so that all of them are placed.
RobotResources ballOnEveryLink(const urdf::ModelInterface& urdf) {
  std::string file = "links:\n";
  for (const auto& entry : urdf.links_) {
    file += "  " + entry.first + ": [{shape: sphere, radius: 0.05, xyz: [0.1, 0.2, 0.3]}]\n";
  }
  RobotResources resources;
  resources.read = [file](const std::string& /*uri*/) { return file; };
  return resources;
}

/// Every link of the URDF and every shape is where KDL has it, in random poses.
void expectKdlsPoses(const std::string& text, unsigned seed) {
  constexpr double kRounding = 1e-9;
  Oracle oracle(text);
  RobotModel::Config config;
  config.primitives_file = "balls.yaml";
  const auto model =
      std::make_shared<const RobotModel>(text, config, ballOnEveryLink(oracle.urdf()));
  ASSERT_EQ(model->links().size(), oracle.urdf().links_.size());
  Kinematics kinematics(model);
  Random random(seed);
  for (int i = 0; i < 20; ++i) {
    std::map<std::string, double> by_name;
    std::vector<double> positions;
    for (const JointVariable& variable : model->variables()) {
      positions.push_back(random.uniform(-3.0, 3.0));
      by_name[variable.name] = positions.back();
    }
    std::vector<Pose> roots;
    for (std::size_t k = 0; k < model->roots().size(); ++k) roots.push_back(random.pose(2.0));
    kinematics.update(positions, roots);
    for (std::size_t k = 0; k < model->links().size(); ++k) {
      const auto [root, T_root_link] = oracle.linkPose(model->links()[k], by_name);
      const std::vector<std::string> names = model->rootLinks();
      const auto found = std::find(names.begin(), names.end(), root);
      ASSERT_NE(found, names.end()) << root;
      const Pose expected = roots[static_cast<std::size_t>(found - names.begin())] * T_root_link;
      EXPECT_TRUE(test::isNearly(kinematics.linkPoses()[k], expected, kRounding))
          << model->links()[k];
      EXPECT_TRUE(test::isNearly(LinkChain(*model, k).place(positions, roots), expected, kRounding))
          << model->links()[k] << " alone";
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
  kinematics.update({}, {T_fixed_root});
  EXPECT_TRUE(test::isNearly(kinematics.shapePoses()[0], T_fixed_root, 0.0));
}

TEST(KinematicsTest, ASlidIsAsFarAsItsPosition) {
  Kinematics kinematics(test::sliderModel());
  kinematics.update({0.25, -0.5}, {Pose::Identity()});
  EXPECT_TRUE(test::isNearly(Vector3(kinematics.shapePoses()[0].translation()),
                             Vector3(0.25, 0.0, 0.5), 1e-12));
  EXPECT_TRUE(test::isNearly(Vector3(kinematics.shapePoses()[1].translation()),
                             Vector3(-0.5, 0.5, 0.5), 1e-12));
}

TEST(KinematicsTest, AnUpdateLeavesNothingOfTheOneBeforeWhicheverJointsMove) {
  const auto model = test::modelOf(everyJointUrdf());
  Kinematics used(model);
  std::vector<LinkChain> used_chains;
  for (std::size_t k = 0; k < model->links().size(); ++k) used_chains.emplace_back(*model, k);
  Random random(2);
  std::vector<double> positions(model->variables().size());
  std::vector<Pose> roots{Pose::Identity()};
  for (int i = 0; i < 50; ++i) {
    for (double& position : positions) {
      if (random.chance(0.3)) position = random.uniform(-2.0, 2.0);
    }
    if (random.chance(0.2)) roots[0] = random.pose(1.0);
    Kinematics fresh(model);
    used.update(positions, roots);
    fresh.update(positions, roots);
    for (std::size_t k = 0; k < model->links().size(); ++k) {
      EXPECT_TRUE(test::isNearly(used.linkPoses()[k], fresh.linkPoses()[k], 0.0));
      EXPECT_TRUE(test::isNearly(used_chains[k].place(positions, roots),
                                 LinkChain(*model, k).place(positions, roots), 0.0));
    }
    for (std::size_t k = 0; k < model->shapes().size(); ++k) {
      EXPECT_TRUE(test::isNearly(used.shapePoses()[k], fresh.shapePoses()[k], 0.0));
    }
  }
}

TEST(KinematicsTest, TheSimulatedRobotIsPlacedAsByKdl) {
  const auto text = textOf(std::string(TCCM_SOURCE_DIR) + "/simulation/robot/dual_arm.urdf");
  ASSERT_TRUE(text);
  expectKdlsPoses(*text, 3);
}

class RobotKinematicsTest : public ::testing::TestWithParam<const char*> {};

TEST_P(RobotKinematicsTest, EveryLinkIsPlacedAsByKdl) {
  const auto text = textOf(test::sharedDataFolder() + "/robots/" + GetParam());
  if (!text) GTEST_SKIP() << "robots/" << GetParam() << " is not in the shared data";
  expectKdlsPoses(*text, 4);
}

INSTANTIATE_TEST_SUITE_P(SharedData, RobotKinematicsTest,
                         ::testing::Values("pr2_moveit/pr2.urdf", "panda_moveit/panda.urdf",
                                           "panda_primitives/panda_collision.urdf",
                                           "baxter/baxter.urdf", "ur5/ur5_robot.urdf",
                                           "nextage/NextageOpen.urdf",
                                           "guardian_v7_tilt/guardian_tracks.urdf"));

}  // namespace
}  // namespace tccm
