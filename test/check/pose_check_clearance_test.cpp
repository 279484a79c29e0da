#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "check/pose_check.h"
#include "geometry/distance.h"
#include "simulation/robot/dual_arm.h"
#include "support/checked_robot.h"
#include "support/cuboid_scene.h"
#include "support/tiny_robot.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using test::addBlock;
using test::collisionOf;
using test::linkOf;
using test::Random;

constexpr double kRounding = 1e-9;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRadius = 0.2;
constexpr double kPeriods = 1.5;

const std::vector<Pose> kAtOrigin{Pose::Identity()};

CollisionCheck::Config everyCuboid() {
  CollisionCheck::Config config;
  config.support_points = 1;
  return config;
}

/// The slider robot: balls of 50 mm at (slide, 0, 0.5) and (glide, 0.5, 0.5).
class PoseCheckClearanceTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::vector<double> at(double slide, double glide) const {
    std::vector<double> positions(2);
    positions[simulation::variableIndex(*model_, "slide")] = slide;
    positions[simulation::variableIndex(*model_, "glide")] = glide;
    return positions;
  }
  /// Of both links; leastClearance() has to say the same.
  void look(double slide, double glide, double radius_m = kRadius) {
    PoseCheck check(test::checked(model_, use_, collision_), kPeriods);
    check.place(at(slide, glide), kAtOrigin);
    result_ = check.findClearances(map_, radius_m);
    double least = kInfinity;
    for (const LinkClearance& entry : result_) least = std::min(least, entry.distance_m);
    EXPECT_EQ(check.leastClearance(map_, radius_m), least);
  }
  [[nodiscard]] const LinkClearance& of(const std::string& link) const {
    for (const LinkClearance& entry : result_) {
      if (model_->links()[entry.link] == link) return entry;
    }
    throw std::out_of_range(link);
  }
  /// The hand's, with the other far away.
  double hand(double slide, double radius_m = kRadius) {
    look(slide, 9.0, radius_m);
    return of("hand").distance_m;
  }
  void addWall(double x, double y) {
    addBlock(map_, {Vector3(x, y - 0.2, 0.3), Vector3(x + 0.1, y + 0.2, 0.7)});
  }

  std::shared_ptr<const RobotModel> model_ = test::sliderModel();
  LinkUse use_{Expansion{1.0, 0.04}};
  CollisionCheck::Config collision_ = everyCuboid();
  CuboidMap map_ = test::emptyMap();
  std::vector<LinkClearance> result_;
};

TEST_F(PoseCheckClearanceTest, IsTheDistanceOfThePrimitiveWithoutPadding) {
  addWall(0.8, 0.0);
  EXPECT_NEAR(hand(0.6), 0.15, kRounding);
  EXPECT_NEAR(hand(0.7), 0.05, kRounding);
  EXPECT_NEAR(hand(0.745), 0.005, kRounding);
  EXPECT_NEAR(hand(1.0), 0.05, kRounding) << "on the far side";
}

TEST_F(PoseCheckClearanceTest, InContactItIsZero) {
  addWall(0.8, 0.0);
  EXPECT_EQ(hand(0.751), 0.0);
  EXPECT_EQ(hand(0.85), 0.0) << "altogether inside";
}

TEST_F(PoseCheckClearanceTest, BeyondTheRadiusItIsInfinite) {
  addWall(0.8, 0.0);
  EXPECT_NEAR(hand(0.551), 0.199, kRounding);
  EXPECT_EQ(hand(0.549), kInfinity);
  EXPECT_EQ(hand(0.7, 0.049), kInfinity);
  EXPECT_NEAR(hand(0.7, 0.051), 0.05, kRounding);
  EXPECT_NEAR(hand(0.1, 1.0), 0.65, kRounding);
  map_ = test::emptyMap();
  EXPECT_EQ(hand(0.7), kInfinity) << "an empty map";
}

/// 30 mm along each of two axes, or of three.
TEST_F(PoseCheckClearanceTest, ToEdgesAndCornersItIsStraight) {
  addBlock(map_, {Vector3(0.8, 0.08, 0.58), Vector3(0.82, 0.1, 0.6)});
  EXPECT_NEAR(hand(0.72), std::sqrt(3.0) * 0.08 - 0.05, kRounding);
  EXPECT_NEAR(hand(0.81), std::sqrt(2.0) * 0.08 - 0.05, kRounding);
}

TEST_F(PoseCheckClearanceTest, TheNearestCuboidIsNamed) {
  addWall(0.8, 0.0);
  addBlock(map_, {Vector3(0.6, -0.1, 0.62), Vector3(0.62, -0.08, 0.7)});
  look(0.7, 9.0);
  const UprightBox nearest = map_.box(map_.cuboids[of("hand").cuboid]);
  EXPECT_NEAR(nearest.min().x(), 0.8, kRounding);
  EXPECT_NEAR(distance(Sphere{0.05}, test::placedAt(0.7, 0.0, 0.5), nearest), of("hand").distance_m,
              kRounding);
}

TEST_F(PoseCheckClearanceTest, EveryLinkHasItsOwn) {
  addWall(0.8, 0.0);
  addWall(0.4, 0.5);
  look(0.7, 0.32);
  EXPECT_EQ(result_.size(), 2U);
  EXPECT_NEAR(of("hand").distance_m, 0.05, kRounding);
  EXPECT_NEAR(of("other").distance_m, 0.03, kRounding);
  look(0.7, 0.0);
  EXPECT_NEAR(of("hand").distance_m, 0.05, kRounding);
  EXPECT_EQ(of("other").distance_m, kInfinity);
}

TEST_F(PoseCheckClearanceTest, NothingIsLeftOfTheCallBefore) {
  addWall(0.8, 0.0);
  PoseCheck check(test::checked(model_, use_, collision_), kPeriods);
  check.place(at(0.7, 9.0), kAtOrigin);
  result_ = check.findClearances(map_, kRadius);
  EXPECT_NEAR(of("hand").distance_m, 0.05, kRounding);
  check.place(at(0.6, 9.0), kAtOrigin);
  result_ = check.findClearances(map_, kRadius);
  EXPECT_NEAR(of("hand").distance_m, 0.15, kRounding);
  check.place(at(0.1, 9.0), kAtOrigin);
  result_ = check.findClearances(map_, kRadius);
  EXPECT_EQ(of("hand").distance_m, kInfinity);
}

TEST_F(PoseCheckClearanceTest, LinksThatAreNotCheckedForCollisionHaveNone) {
  addWall(0.4, 0.5);
  use_.links = {"hand"};
  look(0.7, 0.32);
  ASSERT_EQ(result_.size(), 1U);
  EXPECT_EQ(of("hand").distance_m, kInfinity);
}

TEST_F(PoseCheckClearanceTest, OfALinkOfTwoPrimitivesTheNearerCounts) {
  model_ = test::modelOf(
      test::robotOf(linkOf("base", collisionOf(test::sphereOf("0.05"), "0.3 0 0.5") +
                                       collisionOf(test::sphereOf("0.05"), "0.5 0 0.5"))));
  addBlock(map_, {Vector3(0.66, -0.02, 0.4), Vector3(0.7, 0.02, 0.6)});
  addBlock(map_, {Vector3(0.12, -0.02, 0.4), Vector3(0.16, 0.02, 0.6)});
  PoseCheck check(test::checked(model_, use_, collision_), kPeriods);
  check.place({}, kAtOrigin);
  const auto& found = check.findClearances(map_, kRadius);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].distance_m, 0.09, kRounding);
  EXPECT_LT(map_.box(map_.cuboids[found[0].cuboid]).max().x(), 0.2) << "that of the first";
}

TEST_F(PoseCheckClearanceTest, ACuboidWithoutSupportIsPassedOver) {
  addBlock(map_, {Vector3(0.76, 0.0, 0.49), Vector3(0.78, 0.02, 0.51)}, 2);
  addWall(0.9, 0.0);
  EXPECT_NEAR(hand(0.7), 0.01, kRounding);
  collision_.support_points = 3;
  EXPECT_NEAR(hand(0.7), 0.15, kRounding);
  collision_.support_points = 2;
  EXPECT_NEAR(hand(0.7), 0.01, kRounding);
  collision_.support_points = 3;
  addBlock(map_, {Vector3(0.76, 0.02, 0.52), Vector3(0.78, 0.04, 0.54)}, 1);
  EXPECT_NEAR(hand(0.7), 0.01, kRounding) << "its neighbour lends it one";
}

TEST_F(PoseCheckClearanceTest, TheRootsPoseMovesTheWholeRobot) {
  addWall(0.8, 0.0);
  PoseCheck check(test::checked(model_, use_, collision_), kPeriods);
  check.place(at(0.4, 0.0), {test::placedAt(0.3, 0.0, 0.0)});
  EXPECT_NEAR(check.leastClearance(map_, kRadius), 0.05, kRounding);
}

TEST_F(PoseCheckClearanceTest, WrongLinksAndValuesAreRefused) {
  use_.links = {"foot"};
  EXPECT_THROW(test::checked(model_, use_, collision_), ConfigError);
  collision_.support_points = 0;
  EXPECT_THROW(test::checked(model_, LinkUse(), collision_), ConfigError);
}

/// Counted anew over all cuboids.
bool isSupported(const CuboidMap& map, const Cuboid& cuboid, int points) {
  return static_cast<int>(supportOf(map, cuboid, CollisionCheck::Config{}.support_height_m)) >=
         points;
}

struct Nearest {
  double distance_m = kInfinity;
  std::size_t pairs = 0;  ///< within the radius
};

/// Of each link over all of its primitives and all cuboids.
std::vector<Nearest> nearestOfAll(const RobotModel& model, const std::vector<Pose>& poses,
                                  const CuboidMap& map, int support_points, double radius_m) {
  std::vector<Nearest> links(model.links().size());
  for (const Cuboid& cuboid : map.cuboids) {
    if (!isSupported(map, cuboid, support_points)) continue;
    for (std::size_t i = 0; i < model.shapes().size(); ++i) {
      const LinkShape& shape = model.shapes()[i];
      const double metres = distance(shape.shape, poses[i], map.box(cuboid));
      if (metres >= radius_m) continue;
      Nearest& nearest = links[shape.link];
      nearest.distance_m = std::min(nearest.distance_m, metres);
      ++nearest.pairs;
    }
  }
  return links;
}

/// In random poses of the robot, anywhere over, beside and in the map.
void expectWhatBruteForceFinds(const std::shared_ptr<const RobotModel>& model,
                               const Grid::Config& grid, double share, unsigned seed, int scenes) {
  constexpr double kExact = 2e-6;  // what distance() promises, twice
  Random random(seed);
  std::size_t touching = 0, near = 0, far = 0;
  for (int scene = 0; scene < scenes; ++scene) {
    const CuboidMap map = test::randomMap(random, grid, share);
    std::vector<double> positions;
    for (const JointVariable& variable : model->variables()) {
      positions.push_back(
          random.uniform(variable.lower.value_or(-3.0), variable.upper.value_or(3.0)));
    }
    const std::vector<Pose> root{random.pose(0.3)};
    CollisionCheck::Config collision;
    collision.support_points = random.integer(1, 4);
    const double radius_m = random.chance(0.2) ? 0.02 : random.uniform(0.02, 0.4);
    PoseCheck check(test::checked(model, LinkUse({1.0, 0.04}), collision), kPeriods);
    const Posture& posture = check.place(positions, root);
    const std::vector<Nearest> expected =
        nearestOfAll(*model, posture.T_fixed_shapes, map, collision.support_points, radius_m);
    double least = kInfinity;
    for (const LinkClearance& entry : check.findClearances(map, radius_m)) {
      const Nearest& nearest = expected[entry.link];
      least = std::min(least, entry.distance_m);
      if (std::abs(nearest.distance_m - radius_m) < kExact) continue;
      if (nearest.pairs == 0) {
        EXPECT_EQ(entry.distance_m, kInfinity) << scene << " " << model->links()[entry.link];
        ++far;
        continue;
      }
      EXPECT_NEAR(entry.distance_m, nearest.distance_m, kExact)
          << scene << " " << model->links()[entry.link];
      double to_named = kInfinity;
      for (std::size_t i = 0; i < model->shapes().size(); ++i) {
        if (model->shapes()[i].link != entry.link) continue;
        to_named = std::min(to_named, distance(model->shapes()[i].shape, posture.T_fixed_shapes[i],
                                               map.box(map.cuboids[entry.cuboid])));
      }
      EXPECT_NEAR(to_named, entry.distance_m, kExact) << "that is how far its cuboid is";
      ++(nearest.distance_m == 0.0 ? touching : near);
    }
    const double told = check.leastClearance(map, radius_m);
    if (std::isinf(least)) {
      EXPECT_EQ(told, least) << scene;
    } else {
      EXPECT_NEAR(told, least, kExact) << scene;
    }
  }
  EXPECT_GT(touching, 30U);
  EXPECT_GT(near, 30U);
  EXPECT_GT(far, 30U);
}

TEST(ClearanceCheckRandomTest, OfASmallRobotItIsTheLeastOverAllCuboids) {
  RobotModel::Config config;
  config.capsule_links = {"fore"};
  const auto model = test::modelOf(
      test::robotOf(
          linkOf("base", collisionOf("<cylinder radius=\"0.04\" length=\"0.2\"/>", "0 0 0.1")) +
          linkOf("upper", collisionOf("<box size=\"0.16 0.05 0.04\"/>", "0.08 0 0") +
                              collisionOf(test::sphereOf("0.04"), "0.16 0 0")) +
          linkOf("fore", collisionOf("<cylinder radius=\"0.02\" length=\"0.12\"/>", "0 0 0.06")) +
          test::jointOf("turn", "continuous", "base", "upper",
                        "<origin xyz=\"0 0 0.2\"/>" + test::axisOf("0 1 1")) +
          test::jointOf("bend", "continuous", "upper", "fore",
                        "<origin xyz=\"0.16 0 0\"/>" + test::axisOf("0 1 0"))),
      config);
  Grid::Config grid;
  grid.origin_x_m = grid.origin_y_m = -0.3;
  grid.size_x_m = grid.size_y_m = 0.6;
  grid.height_max_m = 0.6;
  expectWhatBruteForceFinds(model, grid, 0.3, 1, 200);
  expectWhatBruteForceFinds(model, grid, 0.02, 2, 500);
}

TEST(ClearanceCheckRandomTest, OfTheDualArmRobotItIsTheLeastOverAllCuboids) {
  Grid::Config grid;
  grid.origin_x_m = grid.origin_y_m = -0.6;
  grid.size_x_m = grid.size_y_m = 1.2;
  grid.height_min_m = 0.3;
  expectWhatBruteForceFinds(simulation::dualArm(), grid, 0.05, 3, 40);
}

}  // namespace
}  // namespace tccm
