/// MoveIt's collision tests of the Panda against obstacles of its surroundings, and random ones:
/// what collides with the exact meshes in FCL collides with the primitives too. MoveIt's tests of
/// collisions of the robot with itself do not apply, since the robot is checked against the map
/// alone.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <set>

#include "check/pose_check.h"
#include "ros/resources.h"
#include "support/checked_robot.h"
#include "support/cuboid_scene.h"
#include "support/exact_robot.h"
#include "support/fcl_overlap.h"
#include "support/random.h"

namespace tccm {
namespace {

using test::ExactRobot;
using test::JointPositions;
using test::placedAt;
using test::Random;

using Links = std::set<std::string>;
using Solids = std::vector<fcl::CollisionObjectd>;

fcl::CollisionObjectd solidOf(const PlacedShape& shape) {
  return {std::visit(test::ToFcl{}, shape.shape), shape.pose};
}

Solids solidsOf(const CuboidMap& map) {
  Solids solids;
  for (const Cuboid& cuboid : map.cuboids) {
    const UprightBox box = map.box(cuboid);
    const Vector3 half = 0.5 * box.sizes(), centre = box.center();
    solids.push_back(solidOf({Box{half}, placedAt(centre.x(), centre.y(), centre.z())}));
  }
  return solids;
}

Grid::Config gridAround(const Vector3& corner, int cells) {
  Grid::Config grid;
  grid.origin_x_m = corner.x() - cells * grid.cell_size_m;
  grid.origin_y_m = corner.y() - cells * grid.cell_size_m;
  grid.size_x_m = grid.size_y_m = 3.0;
  grid.height_min_m = -1.5;
  return grid;
}

/// An upright box whose edges are whole cells, cut into exactly its cells.
CuboidMap mapOfBox(const Vector3& centre, double edge) {
  const Vector3 half = Vector3::Constant(0.5 * edge);
  const UprightBox box(centre - half, centre + half);
  CuboidMap map = test::emptyMap(gridAround(box.min(), 50));
  test::addBlock(map, box);
  return map;
}

/// The heights of a column about p_fixed's x and y where a convex shape may be, in slices of the
/// cells' size; its min lies above its max where the shape is nowhere.
Eigen::AlignedBox1d heightsOf(const PlacedShape& shape, const UprightBox& around, Vector3 p_fixed,
                              double slice) {
  const double half_diagonal = 0.5 * std::sqrt(3.0) * slice;
  const Pose T_shape_fixed = shape.pose.inverse();
  Eigen::AlignedBox1d heights;
  for (p_fixed.z() = around.min().z(); p_fixed.z() < around.max().z() + slice;
       p_fixed.z() += slice) {
    if (distance(shape.shape, T_shape_fixed * p_fixed) > half_diagonal) continue;
    heights.extend(Eigen::Matrix<double, 1, 1>(p_fixed.z() - 0.5 * slice));
    heights.extend(Eigen::Matrix<double, 1, 1>(p_fixed.z() + 0.5 * slice));
  }
  return heights;
}

/// Cuboids that cover a convex shape.
CuboidMap mapOver(const PlacedShape& shape, Random& random) {
  const UprightBox around = bounds(shape.shape, shape.pose);
  const Vector3 shift(random.uniform(0.0, 0.02), random.uniform(0.0, 0.02), 0.0);
  const Grid::Config grid = gridAround(around.min() - shift, 1);
  CuboidMap map = test::emptyMap(grid);
  for (CellIndex cell = 0; cell < map.grid.cells(); ++cell) {
    const Eigen::Vector2d centre = map.grid.centre(cell);
    const Vector3 column(centre.x(), centre.y(), around.center().z());
    if (around.exteriorDistance(column) > grid.cell_size_m) continue;
    const Eigen::AlignedBox1d heights = heightsOf(shape, around, column, grid.cell_size_m);
    if (heights.isEmpty()) continue;
    Cuboid cuboid;
    cuboid.cell = cell;
    cuboid.bottom = map.grid.heightFloor(heights.min().x());
    cuboid.top = map.grid.heightCeil(heights.max().x());
    cuboid.points = 1;
    map.cuboids.push_back(cuboid);
  }
  indexCells(map);
  return map;
}

bool includes(const Links& all, const Links& some) {
  return std::includes(all.begin(), all.end(), some.begin(), some.end());
}

/// What geometry alone decides: neither padding nor support.
CheckedRobot::Config bareConfig() {
  CheckedRobot::Config config;
  config.collision_use.expansion = {1.0, 0.0};
  config.collision.support_points = 1;
  config.collision.contacts_max = 100000;
  config.check_occlusion = false;
  return config;
}

/// Fitted once for all tests.
std::shared_ptr<const RobotModel> pandaModel() {
  static const auto model = std::make_shared<const RobotModel>(
      test::kPanda.urdf(), RobotModel::Config(),
      RobotResources{resourceReader(test::kPanda.packages()), {}, {}});
  return model;
}

class PandaCollisionTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!test::kPanda.isThere()) GTEST_SKIP() << "no robot " << test::kPanda.folder;
    exact_ = std::make_unique<ExactRobot>(test::kPanda);
    model_ = pandaModel();
    remake(bareConfig());
  }

  void remake(const CheckedRobot::Config& config) {
    check_ = std::make_unique<PoseCheck>(test::checked(model_, config), 1.5);
  }

  void place(const JointPositions& positions) {
    exact_->place(positions);
    positions_.clear();
    for (const JointVariable& variable : model_->variables()) {
      const auto found = positions.find(variable.name);
      positions_.push_back(found == positions.end() ? 0.0 : found->second);
    }
  }

  /// The links that touch the map by their primitives.
  [[nodiscard]] Links touching(const CuboidMap& map) {
    check_->place(positions_, {Pose::Identity()});
    check_->check(map, findings_);
    Links links;
    for (const Contact& contact : findings_.contacts) links.insert(model_->linkOf(contact.shape));
    EXPECT_EQ(findings_.collision, !links.empty());
    return links;
  }

  /// Both answers for a box of the map; the links that touch it by their meshes come first.
  [[nodiscard]] std::pair<Links, Links> touchingBox(const Vector3& centre, double edge) {
    const CuboidMap map = mapOfBox(centre, edge);
    const Vector3 half = Vector3::Constant(0.5 * edge);
    const Solids box{solidOf({Box{half}, placedAt(centre.x(), centre.y(), centre.z())})};
    const Links exact = exact_->touching(box);
    EXPECT_EQ(exact, exact_->touching(solidsOf(map))) << "the map is the box";
    const Links ours = touching(map);
    EXPECT_TRUE(includes(ours, exact));
    return {exact, ours};
  }

  std::unique_ptr<ExactRobot> exact_;
  std::shared_ptr<const RobotModel> model_;
  std::unique_ptr<PoseCheck> check_;
  std::vector<double> positions_;
  PoseFindings findings_;
};

/// As MoveIt's tests have it.
const JointPositions kHome{{"panda_joint2", -0.785},
                           {"panda_joint4", -2.356},
                           {"panda_joint6", 1.571},
                           {"panda_joint7", 0.785}};
const Vector3 kInTheArm(0.0, 0.0, 0.3);
const Vector3 kInFrontOfTheHand(0.43, 0.0, 0.55);

TEST_F(PandaCollisionTest, RobotWorldCollision1ASmallBoxInTheArmIsTouched) {
  place(kHome);
  EXPECT_FALSE(touchingBox(kInTheArm, 0.1).first.empty());
}

TEST_F(PandaCollisionTest, RobotWorldCollision2ALargeBoxInTheArmHasManyContacts) {
  place(kHome);
  const auto [exact, ours] = touchingBox(kInTheArm, 0.4);
  EXPECT_GE(exact.size(), 3U);
  EXPECT_GE(findings_.contacts.size(), 3U);
}

TEST_F(PandaCollisionTest, PaddingTestTheBoxBeforeTheHandIsTouchedWithTheHandPadded) {
  place(kHome);
  EXPECT_TRUE(touching(test::emptyMap()).empty());
  CheckedRobot::Config padded = bareConfig();
  padded.collision_use.exceptions = {{{"panda_hand"}, std::nullopt, 0.08}};
  remake(padded);
  EXPECT_EQ(touching(mapOfBox(kInFrontOfTheHand, 0.1)).count("panda_hand"), 1U);
  remake(bareConfig());
  const auto [exact, ours] = touchingBox(kInFrontOfTheHand, 0.1);
  EXPECT_TRUE(exact.empty());
  EXPECT_TRUE(ours.empty());
}

TEST_F(PandaCollisionTest, DistanceWorldTheBoxBeforeTheHandIsAsFarAsMoveItSays) {
  place(kHome);
  const CuboidMap map = mapOfBox(kInFrontOfTheHand, 0.1);
  EXPECT_NEAR(exact_->distance(solidsOf(map)), 0.029, 0.01);
}

TEST_F(PandaCollisionTest, ContinuousCollisionWorldTheBoxIsTouchedOnTheWayAndAtNeitherEnd) {
  JointPositions end = kHome;
  end["panda_joint2"] = 0.05;
  end["panda_joint4"] = -1.6;
  constexpr int kSteps = 50;
  int touched = 0;
  for (int step = 0; step <= kSteps; ++step) {
    JointPositions between = kHome;
    for (auto& [joint, position] : between) {
      position += step * (end.at(joint) - position) / kSteps;
    }
    place(between);
    const auto [exact, ours] = touchingBox(kInFrontOfTheHand, 0.1);
    const bool at_an_end = step == 0 || step == kSteps;
    EXPECT_FALSE(at_an_end && !(exact.empty() && ours.empty())) << step;
    touched += !exact.empty();
  }
  EXPECT_GT(touched, 0);
}

/// Anywhere within the joints' limits.
JointPositions randomPositions(const urdf::ModelInterface& urdf, Random& random) {
  JointPositions positions;
  for (const auto& [name, joint] : urdf.joints_) {
    if (joint->type == urdf::Joint::FIXED || joint->mimic) continue;
    positions[name] = random.uniform(joint->limits->lower, joint->limits->upper);
  }
  return positions;
}

/// An upright box, another, or a ball of 2 to 25 cm, near one of the links.
PlacedShape randomObstacle(const ExactRobot& robot, Random& random) {
  const auto half = [&] { return random.uniform(0.01, 0.125); };
  PlacedShape obstacle{Box{{half(), half(), half()}}};
  const int kind = random.integer(0, 2);
  if (kind == 0) obstacle.shape = Sphere{half()};
  if (kind == 1) obstacle.pose.linear() = random.rotation();
  const int link = random.integer(0, static_cast<int>(robot.size()) - 1);
  obstacle.pose.translation() = robot.centre(static_cast<std::size_t>(link)) + random.point(0.25);
  return obstacle;
}

/// How often answers differ, over scenes.
struct Tally {
  int touched = 0;       ///< meshes are
  int only_ours = 0;     ///< primitives are, and no mesh is
  double false_m = 0.0;  ///< the furthest that the mesh of a link falsely named was from the map
};

TEST_F(PandaCollisionTest, WhatTouchesTheMeshesTouchesThePrimitivesInRandomPoses) {
  constexpr int kScenes = 2000;
  Random random(7);
  Tally tally;
  for (int scene = 0; scene < kScenes; ++scene) {
    place(randomPositions(exact_->urdf(), random));
    const PlacedShape obstacle = randomObstacle(*exact_, random);
    const CuboidMap map = mapOver(obstacle, random);
    const Solids solids = solidsOf(map);
    const Links exact = exact_->touching(solids), ours = touching(map);
    ASSERT_TRUE(includes(exact, exact_->touching({solidOf(obstacle)}))) << "the map covers it";
    ASSERT_TRUE(includes(ours, exact)) << "scene " << scene;
    tally.touched += !exact.empty();
    tally.only_ours += exact.empty() && !ours.empty();
    for (const std::string& link : ours) {
      if (exact.count(link) > 0) continue;
      tally.false_m = std::max(tally.false_m, exact_->distance(link, solids));
    }
  }
  EXPECT_GT(tally.touched, kScenes / 3);
  EXPECT_LT(tally.only_ours, kScenes / 10);
  EXPECT_LT(tally.false_m, 0.05);
}

}  // namespace
}  // namespace tccm
