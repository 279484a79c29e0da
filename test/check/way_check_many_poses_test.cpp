/// WayCheck against a brute force: every primitive at many poses, close to each other.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "check/way_check.h"
#include "geometry/overlap.h"
#include "simulation/robot/dual_arm.h"
#include "support/checked_robot.h"
#include "support/cuboid_scene.h"
#include "support/small_map.h"
#include "support/tiny_robot.h"

namespace tccm {
namespace {

using namespace test::urdf_text;
using test::Random;

constexpr double kRounding = 1e-9;
const std::vector<Pose> kAtOrigin{Pose::Identity()};

WayCheck wayCheck(const std::shared_ptr<const RobotModel>& model, double padding_m, double step_m) {
  CollisionCheck::Config collision;
  collision.support_points = 1;
  return {test::checked(model, LinkUse({1.0, padding_m}), collision), step_m};
}

/// An arm with a primitive of every kind that turns, bends and reaches over a small map.
std::shared_ptr<const RobotModel> smallArm() {
  RobotModel::Config config;
  config.capsule_links = {"fore"};
  return test::modelOf(
      robotOf(linkOf("base") +
              linkOf("upper", collisionOf("<box size=\"0.16 0.05 0.04\"/>", "0.08 0 0")) +
              linkOf("fore",
                     collisionOf("<cylinder radius=\"0.02\" length=\"0.12\"/>", "0 0.02 0.06")) +
              linkOf("rod", collisionOf("<cylinder radius=\"0.015\" length=\"0.2\"/>")) +
              linkOf("hand", collisionOf(test::sphereOf("0.03"))) +
              jointOf("turn", "continuous", "base", "upper",
                      "<origin xyz=\"0 0 0.25\"/>" + axisOf("0 0 1")) +
              jointOf("bend", "revolute", "upper", "fore",
                      "<origin xyz=\"0.16 0 0\"/>" + axisOf("0.3 1 0") + limitOf("-2.5", "2.5")) +
              jointOf("weld", "fixed", "fore", "rod", "<origin xyz=\"0 0 0.1\" rpy=\"1.2 0 0\"/>") +
              jointOf("reach", "prismatic", "fore", "hand",
                      "<origin xyz=\"0 0 0.12\"/>" + axisOf("0 0 1") + limitOf("0", "0.1"))),
      config);
}

Grid::Config smallGrid() { return test::smallGrid(0.6, 0.6, 0.6, -0.3); }

/// Up to three corners; some of it goes there and back.
JointPath randomWay(const RobotModel& model, Random& random) {
  const auto& variables = model.variables();
  JointPath path(variables.size());
  const int corners = random.integer(2, 4);
  double time_s = random.uniform(0.0, 2.0);
  std::vector<double> first;
  for (int i = 0; i < corners; ++i) {
    std::vector<double> positions;
    for (const JointVariable& variable : variables) {
      positions.push_back(
          random.uniform(variable.lower.value_or(-2.0), variable.upper.value_or(2.0)));
    }
    // Some of the joints rest.
    for (std::size_t v = 0; i > 0 && v < positions.size(); ++v) {
      if (random.chance(0.3)) positions[v] = first[v];
    }
    if (i == 0) first = positions;
    path.add(time_s, positions);
    time_s += random.uniform(0.1, 1.0);
  }
  return path;
}

/// The robot's primitives at instants of a way, by forward kinematics alone.
class Walker {
 public:
  Walker(std::shared_ptr<const RobotModel> model, const JointPath& path)
      : model_(std::move(model)), kinematics_(model_), path_(path) {}

  const std::vector<Pose>& posesAt(double time_s) {
    path_.positionsAt(time_s, positions_);
    kinematics_.update(positions_, kAtOrigin);
    return kinematics_.shapePoses();
  }
  /// Whether the shape, grown by that, overlaps a cuboid.
  bool overlapsAt(double time_s, std::size_t shape, double padding_m, const UprightBox& cuboid) {
    return overlaps(expanded(model_->shapes()[shape].shape, {1.0, padding_m}),
                    posesAt(time_s)[shape], cuboid);
  }
  /// The first of so many poses at which any shape, grown by that, overlaps any cuboid.
  std::optional<std::pair<double, std::size_t>> firstOverlap(const CuboidMap& map, int poses,
                                                             double padding_m) {
    std::vector<UprightBox> cuboids;
    for (const Cuboid& cuboid : map.cuboids) cuboids.push_back(map.box(cuboid));
    std::vector<Shape> shapes;
    for (const LinkShape& shape : model_->shapes()) {
      shapes.push_back(expanded(shape.shape, {1.0, padding_m}));
    }
    for (int k = 0; k <= poses; ++k) {
      const double time_s = path_.begin() + (path_.end() - path_.begin()) * k / poses;
      const std::vector<Pose>& at = posesAt(time_s);
      for (std::size_t i = 0; i < shapes.size(); ++i) {
        for (const UprightBox& cuboid : cuboids) {
          if (overlaps(shapes[i], at[i], cuboid)) return std::make_pair(time_s, i);
        }
      }
    }
    return std::nullopt;
  }
  /// How far the shape's middle gets between two instants.
  double moved(std::size_t shape, double from_s, double to_s) {
    const Vector3 from = posesAt(from_s)[shape].translation();
    return (posesAt(to_s)[shape].translation() - from).norm();
  }

 private:
  std::shared_ptr<const RobotModel> model_;
  Kinematics kinematics_;
  const JointPath& path_;
  std::vector<double> positions_;
};

/// Against many poses, close to each other: what is deeper than half a step is found, and not later
/// than half a step's motion; what is found touches.
void expectWhatManyPosesFind(double step_m, double share, unsigned seed, int scenes) {
  constexpr int kPoses = 2000;
  constexpr double kGrown = 0.02;
  const auto model = smallArm();
  WayCheck check = wayCheck(model, kGrown, step_m);
  Random random(seed);
  int touching = 0, free = 0;
  for (int scene = 0; scene < scenes; ++scene) {
    const CuboidMap map = test::randomMap(random, smallGrid(), share);
    const JointPath path = randomWay(*model, random);
    Walker walker(model, path);
    const auto found = check.firstContact({map, path, kAtOrigin}, path.begin(), path.end());
    const auto deep = walker.firstOverlap(map, kPoses, kGrown - 0.5 * step_m);
    if (found) {
      const double found_s = path.begin() + found->time_s;
      EXPECT_LE(found_s, path.end() + kRounding);
      const UprightBox cuboid = map.box(map.cuboids[found->contact.cuboid]);
      EXPECT_TRUE(walker.overlapsAt(found_s, found->contact.shape, kGrown, cuboid)) << scene;
    }
    if (deep) {
      ASSERT_TRUE(found) << scene << ": " << model->linkOf(deep->second) << " after "
                         << deep->first;
      const double found_s = path.begin() + found->time_s;
      if (found_s > deep->first) {
        EXPECT_LE(walker.moved(deep->second, deep->first, found_s), 0.5 * step_m + kRounding);
      }
    }
    ++(found ? touching : free);
  }
  EXPECT_GT(touching, scenes / 5);
  EXPECT_GT(free, scenes / 5);
}

TEST(WayCheckByManyPosesTest, InStepsOf20MmItFindsWhatManyPosesFind) {
  expectWhatManyPosesFind(0.02, 0.006, 1, 150);
}

TEST(WayCheckByManyPosesTest, InStepsOf2MmItFindsWhatManyPosesFind) {
  expectWhatManyPosesFind(0.002, 0.006, 2, 100);
}

/// A single thin column near the arm, as what is missed most easily.
TEST(WayCheckByManyPosesTest, AmongFewThinColumnsItFindsWhatManyPosesFind) {
  expectWhatManyPosesFind(0.01, 0.002, 3, 200);
}

/// All of a real robot's primitives and joints at once, as fast as they go.
TEST(WayCheckByManyPosesTest, OfTheDualArmRobotItFindsWhatManyPosesFind) {
  constexpr int kPoses = 400;
  const auto model = simulation::dualArm();
  WayCheck check = wayCheck(model, 0.02, 0.02);
  Grid::Config grid;
  grid.origin_x_m = 0.3;
  grid.size_x_m = 0.8;
  grid.height_min_m = 0.5;
  Random random(4);
  int touching = 0, free = 0;
  std::size_t most_poses = 0;
  for (int scene = 0; scene < 40; ++scene) {
    const CuboidMap map = test::randomMap(random, grid, 0.01);
    JointPath path(model->variables().size());
    std::vector<double> positions;
    for (const JointVariable& variable : model->variables()) {
      positions.push_back(random.uniform(*variable.lower, *variable.upper));
    }
    path.add(0.0, positions);
    for (double& position : positions) position += random.uniform(-0.5, 0.5);
    path.add(0.5, positions);
    Walker walker(model, path);
    const auto found = check.firstContact({map, path, kAtOrigin}, 0.0, 0.5);
    most_poses = std::max(most_poses, check.poses());
    const auto deep = walker.firstOverlap(map, kPoses, 0.01);
    if (deep) {
      ASSERT_TRUE(found) << scene;
      if (found->time_s > deep->first) {
        EXPECT_LE(walker.moved(deep->second, deep->first, found->time_s), 0.01 + kRounding);
      }
    }
    if (found) {
      EXPECT_TRUE(walker.overlapsAt(found->time_s, found->contact.shape, 0.02,
                                    map.box(map.cuboids[found->contact.cuboid])));
    }
    ++(found ? touching : free);
  }
  EXPECT_GT(touching, 1);
  EXPECT_GT(free, 1);
  EXPECT_LT(most_poses, 100U);
}

}  // namespace
}  // namespace tccm
