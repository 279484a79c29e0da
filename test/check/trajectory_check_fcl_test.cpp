/// Random trajectories of the dual-arm robot over a table and among clutter, against a dense check
/// by FCL: what it finds deeper than 2 mm is reported, and hardly anything else.

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "check/trajectory_check.h"
#include "robot/kinematics.h"
#include "support/checked_robot.h"
#include "support/fcl_overlap.h"
#include "support/table_scene.h"

namespace tccm {
namespace {

using test::Random;

constexpr double kDeep = 0.002;          // [m]
constexpr double kWaypointPeriod = 0.1;  // [s]
const std::vector<Pose> kAtOrigin{Pose::Identity()};

CheckedRobot::Config collisionAlone() {
  CheckedRobot::Config config;
  config.check_occlusion = false;
  return config;
}

/// A solid for FCL.
struct Solid {
  Shape shape;
  fcl::CollisionObjectd object;

  explicit Solid(const Shape& of) : shape(of), object(std::visit(test::ToFcl{}, of)) {}
  void moveTo(const Pose& pose) {
    object.setTransform(pose);
    object.computeAABB();
  }
};

/// Whether two solids touch. Balls around the second one's middle tell most of what is apart.
bool touch(const Solid& a, const Solid& b) {
  const Vector3 middle = a.object.getTransform().inverse() * b.object.getTranslation();
  if (distance(a.shape, middle) > boundingRadius(b.shape)) return false;
  fcl::CollisionRequestd request;
  request.gjk_solver_type = fcl::GST_LIBCCD;
  fcl::CollisionResultd result;
  return fcl::collide(&a.object, &b.object, request, result) > 0;
}

/// The map's cuboids and the robot's primitives for FCL, padded as they are checked.
class DenseCheck {
 public:
  explicit DenseCheck(std::shared_ptr<const RobotModel> model)
      : model_(std::move(model)), kinematics_(model_) {
    const UsedShapes used = model_->shapesFor(collisionAlone().collision_use, kCollisionKeys);
    for (std::size_t i = 0; i < used.shapes.size(); ++i) {
      const Expansion& whole = used.expansions[i];
      const Expansion core{whole.scale, whole.padding_m - kDeep};
      const Shape& shape = model_->shapes()[used.shapes[i]].shape;
      primitives_.push_back(
          {used.shapes[i], Solid(expanded(shape, whole)), Solid(expanded(shape, core))});
    }
  }

  void setMap(const CuboidMap& map) {
    tree_.clear();
    cuboids_.clear();
    for (const Cuboid& cuboid : map.cuboids) {
      const UprightBox box = map.box(cuboid);
      const Vector3 half = 0.5 * box.sizes(), centre = box.center();
      cuboids_.emplace_back(Box{half});
      cuboids_.back().moveTo(test::placedAt(centre.x(), centre.y(), centre.z()));
    }
    for (Solid& cuboid : cuboids_) {
      cuboid.object.setUserData(&cuboid);
      tree_.registerObject(&cuboid.object);
    }
    tree_.setup();
  }

  enum class Depth { kNone, kShallow, kDeep };
  Depth at(const std::vector<double>& positions) {
    kinematics_.update(positions, kAtOrigin);
    Depth depth = Depth::kNone;
    for (Primitive& primitive : primitives_) {
      const Pose& pose = kinematics_.shapePoses()[primitive.shape];
      if (!touches(primitive.whole, pose)) continue;
      if (touches(primitive.core, pose)) return Depth::kDeep;
      depth = Depth::kShallow;
    }
    return depth;
  }

 private:
  struct Primitive {
    std::size_t shape;  ///< index into the model's shapes
    Solid whole, core;
  };
  struct Query {
    const Solid& solid;
    bool touches = false;
  };

  bool touches(Solid& solid, const Pose& pose) {
    solid.moveTo(pose);
    Query query{solid};
    tree_.collide(&solid.object, &query, [](auto* a, auto* b, void* data) {
      auto& asked = *static_cast<Query*>(data);
      const auto* cuboid = a == &asked.solid.object ? b : a;
      return asked.touches = touch(asked.solid, *static_cast<const Solid*>(cuboid->getUserData()));
    });
    return query.touches;
  }

  std::shared_ptr<const RobotModel> model_;
  Kinematics kinematics_;
  std::vector<Primitive> primitives_;
  std::vector<Solid> cuboids_;
  fcl::DynamicAABBTreeCollisionManagerd tree_;
};

/// The table with its objects, or clutter, or both.
CuboidMap randomScene(int kind, Random& random) {
  CuboidMap map = kind == 0 ? test::emptyMap() : test::tableMap();
  constexpr int kBlocks = 6;
  for (int i = 0; kind != 1 && i < kBlocks; ++i) {
    const Vector3 corner = random.pointIn({Vector3(0.2, -0.9, 0.4), Vector3(1.2, 0.8, 1.4)});
    const Vector3 size = random.pointIn({Vector3::Constant(0.02), Vector3::Constant(0.2)});
    test::addBlock(map, {corner, corner + size});
  }
  return map;
}

/// The most that any point of a primitive may move from one pose to another.
double moveMax(Kinematics& kinematics, const RobotModel& model, const std::vector<double>& from,
               const std::vector<double>& to) {
  kinematics.update(from, kAtOrigin);
  const std::vector<Pose> before = kinematics.shapePoses();
  kinematics.update(to, kAtOrigin);
  double most = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const Pose& after = kinematics.shapePoses()[i];
    const double angle = Eigen::AngleAxisd(before[i].linear().transpose() * after.linear()).angle();
    const double shift = (after.translation() - before[i].translation()).norm();
    most = std::max(most, shift + angle * boundingRadius(model.shapes()[i].shape));
  }
  return most;
}

void clampToLimits(const RobotModel& model, std::vector<double>& positions) {
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const JointVariable& variable = model.variables()[v];
    positions[v] = std::clamp(positions[v], *variable.lower, *variable.upper);
  }
}

/// How trajectories are made and checked.
struct Trial {
  int trajectories;
  double move_max_m;  ///< of any link between two waypoints
  int waypoints_min, waypoints_max;
  int poses_between;  ///< two waypoints, that FCL looks at
};

/// In about one direction through joint space.
JointTrajectory randomTrajectory(const std::shared_ptr<const RobotModel>& model, const Trial& trial,
                                 std::vector<double> positions, Random& random) {
  Kinematics kinematics(model);
  JointTrajectory trajectory;
  for (const JointVariable& variable : model->variables())
    trajectory.names.push_back(variable.name);
  std::vector<double> direction(positions.size());
  for (double& change : direction) change = random.uniform(-1.0, 1.0);
  const int waypoints = random.integer(trial.waypoints_min, trial.waypoints_max);
  for (int k = 0; k < waypoints; ++k) {
    trajectory.points.push_back({kWaypointPeriod * k, positions, {}, {}});
    const double wanted = random.uniform(0.1, 1.0) * trial.move_max_m;
    std::vector<double> next = positions;
    double step = 0.1;
    for (int i = 0; i < 3; ++i) {  // it is nearly linear
      for (std::size_t v = 0; v < next.size(); ++v) next[v] = positions[v] + step * direction[v];
      const double move = moveMax(kinematics, *model, positions, next);
      if (move > trial.move_max_m || i < 2) step *= 0.98 * wanted / move;
    }
    positions = next;
    clampToLimits(*model, positions);
    for (double& change : direction) change += random.uniform(-0.3, 0.3);
  }
  return trajectory;
}

/// Which stretch first has a contact of either kind; a stretch counts as the waypoint at its end.
struct Contacts {
  std::optional<std::size_t> any, deep;
};
Contacts denselyChecked(DenseCheck& dense, const JointTrajectory& trajectory, int poses_between) {
  Contacts contacts;
  std::vector<double> positions;
  for (std::size_t i = 0; i < trajectory.points.size(); ++i) {
    const std::vector<double>& to = trajectory.points[i].positions;
    const std::vector<double>& from = trajectory.points[i > 0 ? i - 1 : 0].positions;
    for (int k = i > 0 ? 1 : poses_between; k <= poses_between; ++k) {
      positions = from;
      for (std::size_t v = 0; v < positions.size(); ++v) {
        positions[v] += (to[v] - from[v]) * k / poses_between;
      }
      const DenseCheck::Depth depth = dense.at(positions);
      if (depth == DenseCheck::Depth::kNone) continue;
      if (!contacts.any) contacts.any = i;
      if (depth == DenseCheck::Depth::kShallow) continue;
      contacts.deep = i;
      return contacts;
    }
  }
  return contacts;
}

/// Nothing where hardly any posture is free.
std::optional<std::vector<double>> freeStart(DenseCheck& dense, const RobotModel& model,
                                             Random& random) {
  for (int attempt = 0; attempt < 100; ++attempt) {
    std::vector<double> start = test::armsAhead(model, random.uniform(-1.1, -0.6));
    for (double& position : start) position += random.uniform(-0.3, 0.3);
    clampToLimits(model, start);
    if (dense.at(start) == DenseCheck::Depth::kNone) return start;
  }
  return std::nullopt;
}

/// How many trajectories have such contacts, and how many were reported without any.
struct Tally {
  int touching = 0, deep = 0, invented = 0;
};

Tally compare(const Trial& trial, unsigned seed) {
  constexpr int kOfAMap = 20;
  const auto model = simulation::dualArm();
  TrajectoryCheck check(test::checked(model, collisionAlone()), {}, 0.2, 1.5);
  DenseCheck dense(model);
  Random random(seed);
  CuboidMap map;
  Tally tally;
  for (int i = 0; i < trial.trajectories; ++i) {
    if (i % kOfAMap == 0) dense.setMap(map = randomScene(i / kOfAMap % 3, random));
    auto start = freeStart(dense, *model, random);
    while (!start) {
      dense.setMap(map = randomScene(0, random));
      start = freeStart(dense, *model, random);
    }
    const JointTrajectory trajectory = randomTrajectory(model, trial, *start, random);
    const Contacts contacts = denselyChecked(dense, trajectory, trial.poses_between);
    const auto answer = check.check(map, trajectory, *start, kAtOrigin);
    EXPECT_NE(answer.cause.reason, Reason::kBadQuestion) << answer.cause.detail;
    const bool is_reported = answer.cause.reason == Reason::kCollision;
    EXPECT_TRUE(is_reported || !contacts.deep) << "trajectory " << i;
    if (is_reported && contacts.deep) {
      EXPECT_LE(*answer.index, *contacts.deep) << "trajectory " << i;
    }
    tally.touching += contacts.any.has_value();
    tally.deep += contacts.deep.has_value();
    tally.invented += is_reported && !contacts.any;
  }
  return tally;
}

TEST(TrajectoryCheckFclTest, OfAThousandTrajectoriesNoDeepContactIsMissedAndHardlyAnyInvented) {
  const Tally tally = compare({1000, 0.05, 5, 30, 20}, 11);
  EXPECT_GT(tally.deep, 400);
  EXPECT_LT(tally.touching, 600);
  EXPECT_LE(tally.invented, 10);
}

TEST(TrajectoryCheckFclTest, NorAreAnyMissedBetweenWaypointsThatAreFarApart) {
  const Tally tally = compare({200, 0.6, 2, 3, 300}, 12);
  EXPECT_GT(tally.deep, 80);
  EXPECT_LT(tally.touching, 140);
  EXPECT_LE(tally.invented, 2);
}

}  // namespace
}  // namespace tccm
