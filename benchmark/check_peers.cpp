/// What it costs to ask whether the dual-arm robot touches the map at two poses, and whether it is
/// hidden: of this package, and of what others would take for it. Prints JSON [us].

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/octree/octree.h>
#include <fcl/narrowphase/collision.h>
#include <octomap/OcTree.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "check/pose_check.h"
#include "geometry/ray.h"
#include "latencies.h"
#include "peers_main.h"
#include "support/fcl_overlap.h"
#include "support/table_scene.h"

namespace tccm {
namespace {

using Json = nlohmann::ordered_json;
using Positions = std::vector<double>;

/// FCL's objects for a body's shapes, moved to where the body is.
class FclBody {
 public:
  explicit FclBody(const Body& body) {
    for (const Shape& shape : body.shapes) objects_.emplace_back(std::visit(test::ToFcl{}, shape));
  }
  std::vector<fcl::CollisionObjectd>& at(const Body& body) {
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      objects_[i].setTransform(body.poses[i]);
      objects_[i].computeAABB();
    }
    return objects_;
  }

 private:
  std::vector<fcl::CollisionObjectd> objects_;
};

/// The map as an octree of occupied voxels, as MoveIt hands one to FCL. Filling it is not counted.
class FclOctree {
 public:
  explicit FclOctree(const CuboidMap& map) {
    const double edge = map.grid.config().cell_size_m;
    const auto tree = std::make_shared<octomap::OcTree>(edge);
    for (const Cuboid& cuboid : map.cuboids) {
      const UprightBox box = map.box(cuboid);
      for (double z = box.min().z() + 0.5 * edge; z < box.max().z() + 0.5 * edge; z += edge) {
        tree->updateNode(box.center().x(), box.center().y(), z, true);
      }
    }
    occupied_ = std::make_unique<fcl::CollisionObjectd>(std::make_shared<fcl::OcTreed>(tree));
  }
  /// @return how many of the body's shapes touch.
  std::size_t touching(std::vector<fcl::CollisionObjectd>& body) const {
    std::size_t found = 0;
    for (const fcl::CollisionObjectd& shape : body) {
      fcl::CollisionResultd result;
      found += fcl::collide(&shape, occupied_.get(), fcl::CollisionRequestd(), result) > 0 ? 1 : 0;
    }
    return found;
  }

 private:
  std::unique_ptr<fcl::CollisionObjectd> occupied_;
};

/// A box for each cuboid, in FCL's tree of bounds. Filling it is not counted.
class FclBoxes {
 public:
  explicit FclBoxes(const CuboidMap& map) {
    for (const Cuboid& cuboid : map.cuboids) {
      const UprightBox box = map.box(cuboid);
      const Vector3 size = box.sizes();
      boxes_.push_back(std::make_unique<fcl::CollisionObjectd>(
          std::make_shared<fcl::Boxd>(size), Eigen::Matrix3d::Identity(), box.center()));
      tree_.registerObject(boxes_.back().get());
    }
    tree_.setup();
  }
  std::size_t touching(std::vector<fcl::CollisionObjectd>& body) const {
    std::size_t found = 0;
    for (fcl::CollisionObjectd& shape : body) {
      bool touches = false;
      tree_.collide(&shape, &touches, [](auto* a, auto* b, void* does_touch) {
        fcl::CollisionResultd result;
        fcl::CollisionRequestd request;
        request.gjk_solver_type = fcl::GST_LIBCCD;
        return *static_cast<bool*>(does_touch) = fcl::collide(a, b, request, result) > 0;
      });
      found += touches ? 1 : 0;
    }
    return found;
  }

 private:
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> boxes_;
  fcl::DynamicAABBTreeCollisionManagerd tree_;
};

/// The paper's picture (section IV.B) without anything left out: all that the map has is drawn,
/// then the robot.
class FullZBuffer {
 public:
  explicit FullZBuffer(double resolution) : grid_(resolution), depths_(grid_.pixels()) {}

  /// @return how many of the pixels that show the body are covered.
  std::size_t covered(const CuboidMap& map, const Body& body, double margin) {
    viewpoint_ = map.viewpoint;
    std::fill(depths_.begin(), depths_.end(), Depths());
    for (const Cuboid& cuboid : map.cuboids) {
      const UprightBox box = map.box(cuboid);
      draw(Box{0.5 * box.sizes()}, Pose(Eigen::Translation3d(box.center())),
           0.5 * box.diagonal().norm(), &Depths::surroundings);
    }
    for (std::size_t i = 0; i < body.shapes.size(); ++i) {
      draw(body.shapes[i], body.poses[i], boundingRadius(body.shapes[i]), &Depths::robot);
    }
    std::size_t covered = 0;
    for (const Depths& depths : depths_) {
      covered += depths.surroundings < depths.robot - margin && std::isfinite(depths.robot) ? 1 : 0;
    }
    return covered;
  }

 private:
  struct Depths {
    double surroundings = std::numeric_limits<double>::infinity();
    double robot = std::numeric_limits<double>::infinity();
  };

  static double boundingRadius(const Shape& shape) {
    struct Radius {
      double operator()(const Box& b) const { return b.half_extents.norm(); }
      double operator()(const Cylinder& c) const { return std::hypot(c.radius, c.half_length); }
      double operator()(const Capsule& c) const { return c.radius + c.half_length; }
      double operator()(const Sphere& s) const { return s.radius; }
    };
    return std::visit(Radius{}, shape);
  }

  void draw(const Shape& shape, const Pose& T_fixed_shape, double radius, double Depths::*of) {
    const Vector3 towards = T_fixed_shape.translation() - viewpoint_;
    const double distance = towards.norm();
    if (distance <= radius) return;
    const DirectionGrid::Around around =
        grid_.around(std::asin(radius / distance) + grid_.resolution());
    const Pose T_shape_fixed = T_fixed_shape.inverse(Eigen::Isometry);
    grid_.visitAround(grid_.pixelOf(towards), around, [&](int row, int column) {
      const Ray ray{viewpoint_, grid_.middle(row, column)};
      const auto span = intersect(shape, transformed(ray, T_shape_fixed));
      double& depth = depths_[grid_.index(row, column)].*of;
      if (span) depth = std::min(depth, span->enter);
      return false;
    });
  }

  DirectionGrid grid_;
  Vector3 viewpoint_ = Vector3::Zero();
  std::vector<Depths> depths_;
};

/// The robot at two poses, its joints shivering by up to a milliradian.
class TwoPoses {
 public:
  explicit TwoPoses(double shoulder)
      : model_(simulation::dualArm()),
        robot_(std::make_shared<const CheckedRobot>(model_, CheckedRobot::Config())),
        middles_{test::armsAhead(*model_, shoulder), test::armsAhead(*model_, shoulder + 0.05)} {}

  void shiver() {
    std::uniform_real_distribution<double> noise(-1e-3, 1e-3);
    positions_ = middles_;
    for (Positions& positions : positions_) {
      for (double& position : positions) position += noise(engine_);
    }
  }
  void place() {
    for (std::size_t i = 0; i < checks_.size(); ++i) {
      checks_[i].place(positions_[i], {Pose::Identity()});
    }
  }
  std::array<PoseCheck, 2>& checks() { return checks_; }
  [[nodiscard]] const CheckedRobot& robot() const { return *robot_; }

 private:
  std::shared_ptr<const RobotModel> model_;
  std::shared_ptr<const CheckedRobot> robot_;
  std::array<Positions, 2> middles_, positions_ = middles_;
  std::array<PoseCheck, 2> checks_{PoseCheck(robot_, 1.5), PoseCheck(robot_, 1.5)};
  std::mt19937 engine_{1};
};

/// One who answers: it says how much it has found.
struct Peer {
  std::string name;
  std::function<std::size_t()> answer;
};

/// All in turn, kinematics included. @throws std::runtime_error where one finds something and
/// another nothing.
Json compare(const std::string& what, TwoPoses& poses, const std::vector<Peer>& peers, int rounds) {
  std::vector<Latencies> latencies(peers.size());
  std::vector<std::size_t> found(peers.size(), 0);
  for (int round = 0; round < rounds; ++round) {
    poses.shiver();
    for (std::size_t i = 0; i < peers.size(); ++i) {
      latencies[i].time([&] {
        poses.place();
        found[i] += peers[i].answer();
      });
    }
  }
  Json rows = Json::array();
  for (std::size_t i = 0; i < peers.size(); ++i) {
    if ((found[i] > 0) != (found[0] > 0)) {
      throw std::runtime_error(what + ": '" + peers[i].name + "' does not agree");
    }
    rows.push_back({{"name", peers[i].name},
                    {"p50_us", latencies[i].percentileUs(0.5)},
                    {"p99_us", latencies[i].percentileUs(0.99)}});
  }
  return {{"what", what}, {"unit", peers[0].name}, {"rows", rows}};
}

Json compareCollision(const std::string& what, double shoulder, int rounds) {
  const CuboidMap map = test::tableMap();
  TwoPoses poses(shoulder);
  const FclOctree octree(map);
  const FclBoxes boxes(map);
  FclBody fcl(poses.checks()[0].collisionBody().body);
  PoseFindings findings;
  const auto count = [&poses](auto&& ask) {
    std::size_t found = 0;
    for (PoseCheck& check : poses.checks()) found += ask(check);
    return found;
  };
  return compare(what, poses,
                 {{"this package",
                   [&] {
                     return count([&](PoseCheck& check) {
                       check.findContacts(map, findings);
                       return findings.contacts.size();
                     });
                   }},
                  {"FCL, a box for each cuboid",
                   [&] {
                     return count([&](PoseCheck& check) {
                       return boxes.touching(fcl.at(check.collisionBody().body));
                     });
                   }},
                  {"FCL, an octree",
                   [&] {
                     return count([&](PoseCheck& check) {
                       return octree.touching(fcl.at(check.collisionBody().body));
                     });
                   }}},
                 rounds);
}

Json compareOcclusion(const std::string& what, double shoulder, int rounds) {
  const CuboidMap map = test::tableMap();
  TwoPoses poses(shoulder);
  const OcclusionCheck::Config config;
  FullZBuffer full(config.resolution_rad);
  PoseFindings findings, findings_ahead;
  PoseCheck &now = poses.checks()[0], &ahead = poses.checks()[1];
  return compare(what, poses,
                 {{"this package",
                   [&] {
                     now.findOcclusion(map, findings, ahead, findings_ahead);
                     return findings.occluding_cuboids.size() +
                            findings_ahead.occluding_cuboids.size();
                   }},
                  {"a full Z-buffer",
                   [&] {
                     return full.covered(map, now.occlusionBody().body, config.margin_m) +
                            full.covered(map, ahead.occlusionBody().body, config.margin_m);
                   }}},
                 rounds);
}

void run(bool quick) {
  constexpr double kOverTheTable = -0.75;
  constexpr double kInTheTable = -0.55;
  const int rounds = quick ? 100 : 1000;
  const Json all = {
      compareCollision("collision at two poses, over the table", kOverTheTable, rounds),
      compareCollision("collision at two poses, in the table", kInTheTable, rounds),
      compareOcclusion("occlusion at two poses, in the table", kInTheTable, rounds)};
  std::printf("%s\n", all.dump(1).c_str());
}

}  // namespace
}  // namespace tccm

int main(int argc, char** argv) { return tccm::peers::main(argc, argv, "check_peers", tccm::run); }
