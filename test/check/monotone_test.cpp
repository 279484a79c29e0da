/// More obstacles, regions to keep out of, links, ways, padding or speed never make a verdict
/// milder: random scenes, each with graver ones, judged from a single instant.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>

#include "check/contact_judge.h"
#include "support/checked_robot.h"
#include "support/cuboid_scene.h"
#include "support/small_map.h"
#include "support/tiny_robot.h"

namespace tccm {
namespace {

using namespace test::urdf_text;
using test::Random;

const std::vector<Pose> kAtOrigin{Pose::Identity()};

std::string joined(const std::string& name, const std::string& type, const std::string& parent,
                   const std::string& child, const std::string& origin, const std::string& more) {
  return jointOf(name, type, parent, child, "<origin xyz=\"" + origin + "\"/>" + more);
}

/// Three balls on rails of their own, one of them twice as fast as its joint.
std::string railsUrdf() {
  const std::string limits = limitOf("-3", "3");
  return robotOf(
      linkOf("base") + ballLink("left") + ballLink("right") + ballLink("geared") +
      joined("slide", "prismatic", "base", "left", "0 0 0.3", axisOf("1 0 0") + limits) +
      joined("glide", "prismatic", "base", "right", "0 0.25 0.3", axisOf("1 0.3 0") + limits) +
      joined("follow", "prismatic", "base", "geared", "0 -0.25 0.3",
             axisOf("1 0 0") + limitOf("-9", "9") + "<mimic joint=\"slide\" multiplier=\"2\"/>"));
}

/// An arm that turns, bends and reaches, with a primitive of every kind.
std::string armUrdf() {
  return robotOf(
      linkOf("base") + linkOf("upper", collisionOf("<box size=\"0.2 0.05 0.04\"/>", "0.1 0 0")) +
      linkOf("fore", collisionOf("<cylinder radius=\"0.03\" length=\"0.2\"/>", "0 0 0.1")) +
      linkOf("hand", collisionOf(test::sphereOf("0.04"))) +
      joined("turn", "continuous", "base", "upper", "0 0 0.25", axisOf("0 0 1")) +
      joined("bend", "revolute", "upper", "fore", "0.2 0 0",
             axisOf("0.3 1 0") + limitOf("-2.5", "2.5")) +
      joined("reach", "prismatic", "fore", "hand", "0 0 0.2",
             axisOf("0 0 1") + "<limit effort=\"1\" velocity=\"1\"/>"));
}

/// What is judged: everything that may become more.
struct Scene {
  std::shared_ptr<const RobotModel> model;
  std::vector<UprightBox> obstacles;
  std::vector<KeepOutRegion> regions = {};
  std::vector<std::string> links;
  double padding_m = 0.03;
  std::vector<double> positions;
  std::vector<double> velocities;
  std::vector<double> contrary;   ///< velocities as well
  std::vector<double> commanded;  ///< where to, within half a second
};

struct Answer {
  Level level = Level::kOk;
  double scale = 1.0;
  bool touches_now = false;
  std::string text;
};

class MonotoneTest : public ::testing::Test {
 protected:
  const std::shared_ptr<CheckedRobot>& robotOf(const Scene& scene) {
    std::string key = std::to_string(scene.padding_m) + scene.model->links().back();
    for (const std::string& link : scene.links) key += " " + link;
    std::shared_ptr<CheckedRobot>& robot = robots_[key];
    if (!robot) {
      CheckedRobot::Config config;
      config.check_occlusion = false;
      config.collision_use.links = scene.links;
      config.collision_use.expansion.padding_m = scene.padding_m;
      robot = test::checked(scene.model, config);
    }
    return robot;
  }

  static CuboidMap mapOf(const std::vector<UprightBox>& obstacles) {
    Grid::Config grid = test::smallGrid(1.6, 1.2, 0.7, -0.6);
    CuboidMap map = test::emptyMap(grid);
    for (const UprightBox& box : obstacles) {
      const Grid::Footprint cells = map.grid.footprint(box);
      for (CellIndex y = cells.y_begin; y < cells.y_end; ++y) {
        for (CellIndex x = cells.x_begin; x < cells.x_end; ++x) {
          Cuboid cuboid;
          cuboid.cell = y * map.grid.cellsX() + x;
          cuboid.bottom = map.grid.heightOf(box.min().z());
          cuboid.top = map.grid.heightOf(box.max().z());
          cuboid.points = 5;
          map.cuboids.push_back(cuboid);
        }
      }
    }
    std::stable_sort(map.cuboids.begin(), map.cuboids.end(),
                     [](const Cuboid& a, const Cuboid& b) { return a.cell < b.cell; });
    indexCells(map);
    return map;
  }

  Answer judge(const Scene& scene) {
    const std::shared_ptr<CheckedRobot>& robot = robotOf(scene);
    const CuboidMap map = mapOf(scene.obstacles);
    JointSnapshot joints;
    joints.positions = scene.positions;
    joints.velocities = scene.velocities;
    joints.contrary_velocities = scene.contrary;
    CommandedTrajectories commanded(scene.model, {});
    if (!scene.commanded.empty()) {
      JointTrajectory trajectory;
      for (const JointVariable& variable : scene.model->variables()) {
        trajectory.names.push_back(variable.name);
      }
      trajectory.points = {{0.0, scene.positions, {}, {}}, {0.5, scene.commanded, {}, {}}};
      EXPECT_EQ(commanded.command(Time(), trajectory, scene.positions), "");
    }
    commanded.findWays(joints, config_.horizon_s);
    KeepOut keep_out({}, *scene.model, "base");
    keep_out.take(*scene.model, robot->collision_body);
    for (const KeepOutRegion& region : scene.regions) keep_out.set(region, *scene.model, "base");
    keep_out.place(kAtOrigin, false);
    const std::vector<SensorView> views{{&map}};
    const Surroundings around(map, views, &keep_out);
    PoseCheck here(robot, 1.5);
    here.place(scene.positions, kAtOrigin);
    PoseFindings found;
    here.check(around, found);
    Braking braking;
    braking.latency_s = 0.03;
    Causes causes;
    for (const auto against : {ContactJudge::Against::kMap, ContactJudge::Against::kKeepOut}) {
      if (against == ContactJudge::Against::kKeepOut && scene.regions.empty()) continue;
      ContactJudge(robot, config_, braking, against)
          .judge({Time(), around, joints, commanded, here, here, found, found, braking, true, 1.0},
                 causes);
    }
    Answer answer;
    answer.touches_now = found.collision || !found.keep_out.empty();
    for (const Cause& cause : causes) {
      answer.level = std::max(answer.level, cause.level);
      answer.scale = std::min(answer.scale, cause.speed_scale);
      answer.text += std::string(name(cause.reason)) + " " + cause.detail + "; ";
    }
    return answer;
  }

  /// Anywhere, about where a primitive is to be, or so that it touches just then.
  [[nodiscard]] static UprightBox obstacle(const Scene& scene, Random& random) {
    const Vector3 size(random.uniform(0.005, 0.1), random.uniform(0.005, 0.15),
                       random.uniform(0.02, 0.3));
    Vector3 low(random.uniform(-0.5, 0.8), random.uniform(-0.5, 0.5), random.uniform(0.0, 0.4));
    if (random.chance(0.3)) return {low, low + size};
    const auto shape = static_cast<std::size_t>(random.integer(0, 2));
    const double time_s = random.uniform(0.25, 0.55);
    const Vector3 then = placeOf(scene, shape, time_s);
    const Vector3 way = then - placeOf(scene, shape, time_s - 0.01);
    if (random.chance(0.5) || way.norm() < 1e-4) {
      low = then - 0.5 * size + random.point(0.08);
      return {low, low + size};
    }
    const Vector3 ahead = way.normalized();
    const double reach = boundingRadius(scene.model->shapes()[shape].shape) + scene.padding_m;
    low = then + ahead * (reach + 0.5 * size.dot(ahead.cwiseAbs())) - 0.5 * size;
    return {low, low + size};
  }

  /// Likewise, turned anyhow.
  [[nodiscard]] static KeepOutRegion region(const Scene& scene, Random& random) {
    KeepOutRegion region = regionOf(obstacle(scene, random), std::to_string(scene.regions.size()));
    if (random.chance(0.7)) region.T_frame_box.linear() = random.rotation();
    return region;
  }
  static KeepOutRegion regionOf(const UprightBox& box, const std::string& name) {
    KeepOutRegion region{name, "", Box{0.5 * box.sizes()}};
    region.T_frame_box.translation() = box.center();
    return region;
  }

  static Vector3 placeOf(const Scene& scene, std::size_t shape, double time_s) {
    std::vector<double> positions = scene.positions;
    for (std::size_t v = 0; v < positions.size(); ++v) positions[v] += time_s * scene.velocities[v];
    Kinematics kinematics(scene.model);
    return kinematics.update(positions, kAtOrigin).T_fixed_shapes[shape].translation();
  }

  Scene scene(Random& random) const {
    Scene scene;
    scene.model = random.chance(0.5) ? rails_ : arm_;
    const double fast = random.chance(0.2) ? 3.0 : 0.8;
    for (std::size_t v = 0; v < scene.model->variables().size(); ++v) {
      const double slower = random.chance(0.3) ? 0.1 : 1.0;
      scene.positions.push_back(random.uniform(-0.4, 0.4));
      scene.velocities.push_back(random.chance(0.2) ? 0.0 : slower * random.uniform(-fast, fast));
    }
    const int obstacles = random.integer(1, 3);
    for (int i = 0; i < obstacles; ++i) scene.obstacles.push_back(obstacle(scene, random));
    const std::vector<std::string>& links = scene.model->links();
    scene.links = {links[1 + static_cast<std::size_t>(random.integer(0, 1))]};
    if (random.chance(0.5)) scene.links = {links.begin() + 1, links.end()};
    return scene;
  }

  void expectNeverMilder(const char* what, const Answer& one, const Answer& other) {
    ++pairs_[what];
    if (one.level != other.level) ++changed_[what];
    EXPECT_GE(other.level, one.level) << what << "\n" << one.text << "\n" << other.text;
    EXPECT_LE(other.scale, one.scale + 1e-9) << what << "\n" << one.text << "\n" << other.text;
  }

  const std::shared_ptr<const RobotModel> rails_ = test::modelOf(railsUrdf());
  const std::shared_ptr<const RobotModel> arm_ = test::modelOf(armUrdf());
  ContactJudge::Config config_;
  std::map<std::string, std::shared_ptr<CheckedRobot>> robots_;
  std::map<std::string, int> pairs_, changed_;
};

TEST_F(MonotoneTest, OfThousandsOfScenesNoneIsJudgedMilderForMore) {
  Random random(19);
  for (int i = 0; i < 5000; ++i) {
    const Scene base = scene(random);
    const Answer one = judge(base);
    Scene more = base;
    for (int k = random.integer(1, 2); k > 0; --k) more.obstacles.push_back(obstacle(base, random));
    expectNeverMilder("obstacles", one, judge(more));

    more = base;
    for (int k = random.integer(1, 3); k > 0; --k) more.regions.push_back(region(more, random));
    const Answer with_regions = judge(more);
    expectNeverMilder("regions", one, with_regions);
    more.regions.push_back(region(more, random));
    expectNeverMilder("one more region", with_regions, judge(more));

    more = base;
    more.links = {base.model->links().begin() + 1, base.model->links().end()};
    expectNeverMilder("links", one, judge(more));

    more = base;
    more.padding_m += random.uniform(0.001, 0.03);
    more.padding_m = 1e-3 * std::round(1e3 * more.padding_m);
    // What is in contact may come nearer by 2 mm before it recedes, what is not must not touch.
    const Answer padded = judge(more);
    if (!padded.touches_now) expectNeverMilder("padding", one, padded);

    more = base;
    const double faster = 1.0 + std::pow(10.0, random.uniform(-3.0, 0.5));
    for (double& velocity : more.velocities) velocity *= faster;
    // Of the way out of a contact 10 s are looked along: slowly, 100 mm take longer.
    const bool is_slow = std::any_of(base.velocities.begin(), base.velocities.end(),
                                     [](double v) { return v != 0.0 && std::abs(v) < 0.01; });
    if (!one.touches_now || !is_slow) expectNeverMilder("speed", one, judge(more));

    more = base;
    for (const double velocity : base.velocities) {
      more.contrary.push_back(random.chance(0.5) ? velocity : -random.uniform(0.2, 1.0) * velocity);
    }
    expectNeverMilder("ways", one, judge(more));

    // A robot in contact may be commanded out of it: without, it may not move.
    if (one.touches_now) continue;
    more = base;
    for (const double position : base.positions) {
      more.commanded.push_back(position + random.uniform(-0.3, 0.3));
    }
    expectNeverMilder("commanded", one, judge(more));
  }
  int pairs = 0;
  for (const auto& [what, number] : pairs_) {
    pairs += number;
    EXPECT_GT(changed_[what], number / 100) << what << ": it has to make a difference";
    RecordProperty(what, number);
  }
  EXPECT_GE(pairs, 20000);
}

/// What stands in the map and what nobody may enter stop a robot alike.
TEST_F(MonotoneTest, ARegionIsJudgedAsCuboidsOfTheSameSizeAre) {
  Random random(20);
  std::map<Level, int> levels;
  int touching = 0;
  for (int i = 0; i < 5000; ++i) {
    Scene mapped = scene(random);
    mapped.obstacles.resize(1);
    const CuboidMap map = mapOf(mapped.obstacles);
    Scene walled = mapped;
    walled.obstacles.clear();
    for (const Cuboid& cuboid : map.cuboids) {
      walled.regions.push_back(regionOf(map.box(cuboid), std::to_string(walled.regions.size())));
    }
    if (walled.regions.empty() || walled.regions.size() > KeepOut::kCountMax) continue;
    const Answer one = judge(mapped), other = judge(walled);
    ++levels[one.level];
    touching += one.touches_now;
    EXPECT_EQ(one.touches_now, other.touches_now) << one.text << "\n" << other.text;
    EXPECT_EQ(one.level, other.level) << one.text << "\n" << other.text;
    EXPECT_NEAR(one.scale, other.scale, 1e-6) << one.text << "\n" << other.text;
  }
  for (const Level level : {Level::kOk, Level::kSlow, Level::kStop}) {
    EXPECT_GT(levels[level], 200) << static_cast<int>(level);
  }
  EXPECT_GT(touching, 100);
}

}  // namespace
}  // namespace tccm
