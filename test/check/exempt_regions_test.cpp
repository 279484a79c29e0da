/// What exemptions make of verdicts and answers, in random scenes of an arm among cuboids: against
/// maps from which the regions' cuboids are taken out, against regions that stand still, and pose
/// by pose.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "check/checker_config.h"
#include "support/cuboid_scene.h"
#include "support/random.h"
#include "support/small_map.h"
#include "support/tiny_robot.h"

namespace tccm {
namespace {

using namespace test::urdf_text;
using test::Random;

const Time kNow{std::chrono::seconds(100)};
constexpr double kPadding = 0.03;  // [m]

std::string joined(const std::string& name, const std::string& type, const std::string& parent,
                   const std::string& child, const std::string& origin, const std::string& more) {
  return jointOf(name, type, parent, child, "<origin xyz=\"" + origin + "\"/>" + more);
}

/// An arm that turns, bends and reaches.
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

const std::vector<std::string> kJoints{"turn", "bend", "reach"};
const std::vector<std::string> kLinks{"upper", "fore", "hand"};

class ExemptRegionsTest : public ::testing::Test {
 protected:
  struct Scene {
    CuboidMap map;
    std::vector<double> positions, velocities;
    std::string link;     ///< that may touch
    PlacedShape region;   ///< in the frame's
    std::string carrier;  ///< a link
  };

  /// Nothing but contacts is judged, of these links.
  [[nodiscard]] std::unique_ptr<Checker> checker(const std::vector<std::string>& links = kLinks,
                                                 double padding_m = kPadding) const {
    Checker::Config config;
    config.pose.check_occlusion = false;
    config.pose.collision_use.links = links;
    config.pose.collision_use.expansion.padding_m = padding_m;
    config.pose.collision.support_points = 1;
    config.evidence.unseen_fraction_max = 1.0;
    config.braking.reaction_time_s = 0.0;
    config.permission.hold_until_reset = false;
    config.permission.release_checks = 1;
    return std::make_unique<Checker>(model_, config);
  }
  static void feed(Checker& checker, const CuboidMap& map, const Scene& scene) {
    auto copy = std::make_shared<CuboidMap>(map);
    copy->stamp = kNow;
    checker.setRootPose(0, Time(), Pose::Identity(), true);
    checker.addJoints(kNow, kNow, kJoints, scene.positions, scene.velocities);
    checker.setMap(kNow, copy);
  }
  [[nodiscard]] Pose placeOf(const std::string& link, const std::vector<double>& positions) const {
    Kinematics kinematics(model_);
    const auto& links = model_->links();
    const auto index = std::find(links.begin(), links.end(), link) - links.begin();
    return kinematics.update(positions, {Pose::Identity()})
        .T_fixed_links[static_cast<std::size_t>(index)];
  }

  static std::vector<double> randomPositions(Random& random) {
    return {random.uniform(-1.5, 1.5), random.uniform(-1.0, 1.0), random.uniform(-0.1, 0.1)};
  }
  static std::string anyLink(Random& random) {
    return kLinks[static_cast<std::size_t>(random.integer(0, 2))];
  }
  /// Cuboids mostly about the link, and a region about some of them.
  [[nodiscard]] Scene scene(Random& random) const {
    Scene scene;
    scene.map = test::emptyMap(test::smallGrid(1.6, 1.6, 0.9, -0.8));
    scene.positions = randomPositions(random);
    for (std::size_t v = 0; v < 3; ++v) scene.velocities.push_back(random.uniform(-0.6, 0.6));
    scene.link = anyLink(random);
    scene.carrier = anyLink(random);
    for (int i = random.integer(1, 4); i > 0; --i) {
      const std::string about = random.chance(0.8) ? scene.link : anyLink(random);
      const Vector3 p = placeOf(about, scene.positions).translation() + random.point(0.2);
      const auto cell = scene.map.grid.cellOf(p);
      if (!cell) continue;
      test::addCuboid(scene.map, *cell, p.z(), p.z() + random.uniform(0.01, 0.1));
    }
    const double size = random.uniform(0.1, 0.5);
    scene.region = {random.chance(0.5) ? Shape(Sphere{size}) : Shape(Box{{size, size, 0.5 * size}}),
                    Pose(Eigen::Translation3d(random.point(0.15)) *
                         Eigen::AngleAxisd(random.uniform(-3.0, 3.0), Vector3::UnitX()))};
    return scene;
  }

  static void exempt(Checker& checker, const Scene& scene, const PlacedShape& region,
                     const std::string& frame, bool with_goal = false) {
    Exemption exemption{"grasping", scene.link, region, Time()};
    exemption.frame = frame;
    exemption.with_goal = with_goal;
    checker.addExemption(kNow, exemption, 50.0);
  }
  /// In the fixed frame, with the carrier where the robot's positions put it.
  [[nodiscard]] PlacedShape standing(const Scene& scene,
                                     const std::vector<double>& positions) const {
    return {scene.region.shape, placeOf(scene.carrier, positions) * scene.region.pose};
  }
  /// Without the cuboids that lie altogether in the region.
  static CuboidMap without(const PlacedShape& region, const CuboidMap& map) {
    CuboidMap rest = map;
    const Pose T_region_fixed = region.pose.inverse();
    const auto liesIn = [&](const Cuboid& cuboid) {
      const UprightBox box = map.box(cuboid);
      for (int corner = 0; corner < 8; ++corner) {
        const Vector3 p = T_region_fixed * box.corner(static_cast<UprightBox::CornerType>(corner));
        if (distance(region.shape, p) > 0.0) return false;
      }
      return true;
    };
    rest.cuboids.erase(std::remove_if(rest.cuboids.begin(), rest.cuboids.end(), liesIn),
                       rest.cuboids.end());
    indexCells(rest);
    return rest;
  }
  static void expectNeverMilder(const Verdict& verdict, const Verdict& than) {
    EXPECT_GE(verdict.level, than.level) << verdict.detail << "\n" << than.detail;
    EXPECT_LE(verdict.speed_scale, than.speed_scale) << verdict.detail << "\n" << than.detail;
  }

  const std::shared_ptr<const RobotModel> model_ = test::modelOf(armUrdf());
};

TEST_F(ExemptRegionsTest, OfTheLinkAloneItIsAsIfTheRegionsCuboidsWereNotThere) {
  Random random(7);
  int milder = 0;
  for (int i = 0; i < 800; ++i) {
    const Scene base = scene(random);
    const PlacedShape region = standing(base, base.positions);
    const auto exempted = checker({base.link}), bare = checker({base.link}),
               plain = checker({base.link});
    exempt(*exempted, base, region, "");
    feed(*exempted, base.map, base);
    feed(*bare, without(region, base.map), base);
    feed(*plain, base.map, base);
    const Verdict& verdict = exempted->check(kNow);
    const Verdict& expected = bare->check(kNow);
    EXPECT_EQ(verdict.reason, expected.reason) << i << verdict.detail << "\n" << expected.detail;
    EXPECT_EQ(verdict.level, expected.level) << i;
    EXPECT_EQ(verdict.speed_scale, expected.speed_scale) << i;
    EXPECT_EQ(verdict.now.contacts.size(), expected.now.contacts.size()) << i;
    if (plain->check(kNow).level != verdict.level) ++milder;
  }
  EXPECT_GT(milder, 20) << "it has to make a difference";
}

TEST_F(ExemptRegionsTest, OfOtherLinksNothingBecomesMilder) {
  Random random(8);
  int stopped = 0;
  for (int i = 0; i < 800; ++i) {
    const Scene base = scene(random);
    std::vector<std::string> others = kLinks;
    others.erase(std::find(others.begin(), others.end(), base.link));
    const auto exempted = checker(), without_it = checker(others);
    exempt(*exempted, base, base.region, random.chance(0.5) ? base.carrier : "");
    feed(*exempted, base.map, base);
    feed(*without_it, base.map, base);
    const Verdict& expected = without_it->check(kNow);
    expectNeverMilder(exempted->check(kNow), expected);
    if (expected.level >= Level::kStop) ++stopped;
  }
  EXPECT_GT(stopped, 20);
}

TEST_F(ExemptRegionsTest, OneThatIsNotInForceChangesNothing) {
  Random random(9);
  int in_contact = 0;
  for (int i = 0; i < 200; ++i) {
    const Scene base = scene(random);
    const auto waiting = checker(), plain = checker();
    if (random.chance(0.5)) {
      exempt(*waiting, base, standing(base, base.positions), "", true);
    } else {
      exempt(*waiting, base, base.region, "cup");
    }
    for (Checker* one : {waiting.get(), plain.get()}) feed(*one, base.map, base);
    const Verdict& verdict = waiting->check(kNow);
    const Verdict& expected = plain->check(kNow);
    EXPECT_EQ(verdict.reason, expected.reason);
    EXPECT_EQ(verdict.detail, expected.detail);
    EXPECT_EQ(verdict.speed_scale, expected.speed_scale);
    EXPECT_EQ(verdict.way_poses, expected.way_poses);
    EXPECT_EQ(verdict.now.contacts.size(), expected.now.contacts.size());
    if (expected.collision) ++in_contact;
  }
  EXPECT_GT(in_contact, 20);
}

TEST_F(ExemptRegionsTest, AtEachPoseARegionThatMovesIsAsOneThatStandsWhereItsLinkIs) {
  Random random(10);
  int milder = 0;
  for (int i = 0; i < 800; ++i) {
    const Scene base = scene(random);
    const auto moving = checker(), fixed = checker(), plain = checker();
    // The robot is elsewhere than where it is asked about.
    Scene elsewhere = base;
    elsewhere.positions = randomPositions(random);
    for (Checker* one : {moving.get(), fixed.get(), plain.get()}) feed(*one, base.map, elsewhere);
    exempt(*moving, base, base.region, base.carrier);
    exempt(*fixed, base, standing(base, base.positions), "");
    const StateAnswer answer = moving->checkState(kNow, kJoints, base.positions);
    const StateAnswer expected = fixed->checkState(kNow, kJoints, base.positions);
    EXPECT_EQ(answer.cause.reason, expected.cause.reason) << i;
    ASSERT_EQ(answer.findings.contacts.size(), expected.findings.contacts.size()) << i;
    for (std::size_t k = 0; k < answer.findings.contacts.size(); ++k) {
      EXPECT_EQ(answer.findings.contacts[k].shape, expected.findings.contacts[k].shape);
      EXPECT_EQ(answer.findings.contacts[k].cuboid, expected.findings.contacts[k].cuboid);
    }
    const StateAnswer without = plain->checkState(kNow, kJoints, base.positions);
    if (without.findings.contacts.size() != answer.findings.contacts.size()) ++milder;
  }
  EXPECT_GT(milder, 20) << "it has to make a difference";
}

TEST_F(ExemptRegionsTest, AlongATrajectoryItIsAtEachPoseWhereItsLinkIsThen) {
  Random random(11);
  int free = 0, found = 0, milder = 0;
  for (int i = 0; i < 800; ++i) {
    const Scene base = scene(random);
    const auto moving = checker(), plain = checker();
    for (Checker* one : {moving.get(), plain.get()}) feed(*one, base.map, base);
    exempt(*moving, base, base.region, base.carrier);
    std::vector<double> to = base.positions;
    for (double& position : to) position += random.uniform(-0.3, 0.3);
    const JointTrajectory way{kJoints, {{0.0, base.positions, {}, {}}, {1.0, to, {}, {}}}};
    const TrajectoryAnswer answer = moving->checkTrajectory(kNow, way);
    const auto reasonAt = [&](double time_s) {
      std::vector<double> positions = base.positions;
      for (std::size_t v = 0; v < 3; ++v) positions[v] += time_s * (to[v] - positions[v]);
      return moving->checkState(kNow, kJoints, positions).cause.reason;
    };
    if (answer.cause.reason == Reason::kCollision) {
      ++found;
      EXPECT_EQ(reasonAt(answer.time_s), Reason::kCollision) << i;
      continue;
    }
    if (answer.cause.reason == Reason::kMovingOut) {  // of a contact that is not exempt
      EXPECT_EQ(reasonAt(0.0), Reason::kCollision) << i;
      EXPECT_EQ(reasonAt(1.0), Reason::kClear) << i;
      continue;
    }
    ASSERT_EQ(answer.cause.reason, Reason::kClear) << answer.cause.detail;
    ++free;
    if (plain->checkTrajectory(kNow, way).cause.reason != Reason::kClear) ++milder;
    for (int k = 0; k <= 4; ++k) EXPECT_EQ(reasonAt(0.25 * k), Reason::kClear) << i << " " << k;
  }
  EXPECT_GT(free, 20);
  EXPECT_GT(found, 20);
  EXPECT_GT(milder, 10) << "it has to make a difference";
}

TEST_F(ExemptRegionsTest, OnTheWayAheadItIsAtEachPoseWhereItsLinkIsThen) {
  Random random(12);
  int free = 0, found = 0, milder = 0;
  for (int i = 0; i < 800; ++i) {
    const Scene base = scene(random);
    // What is passed over on the way is no deeper than a part of a step.
    const auto moving = checker(), thinner = checker(kLinks, kPadding - 0.011), plain = checker();
    for (Checker* one : {moving.get(), thinner.get()}) {
      feed(*one, base.map, base);
      exempt(*one, base, base.region, base.carrier);
    }
    feed(*plain, base.map, base);
    const auto stateAt = [&](Checker& of, double time_s) {
      std::vector<double> positions = base.positions;
      for (std::size_t v = 0; v < 3; ++v) positions[v] += time_s * base.velocities[v];
      return of.checkState(kNow, kJoints, positions).cause.reason;
    };
    const Verdict& verdict = moving->check(kNow);
    ASSERT_TRUE(verdict.placed);
    if (verdict.now.collision) continue;
    const bool touches = verdict.first_contact && !verdict.first_contact->by_margin;
    if (touches) {
      ++found;
      EXPECT_EQ(stateAt(*moving, verdict.first_contact->time_s), Reason::kCollision) << i;
      continue;
    }
    ++free;
    const Verdict& other = plain->check(kNow);
    if (other.collision) ++milder;
    for (int k = 0; k <= 10; ++k) {
      EXPECT_EQ(stateAt(*thinner, 0.05 * k), Reason::kClear) << i << " after " << 0.05 * k;
    }
  }
  EXPECT_GT(free, 20);
  EXPECT_GT(found, 20);
  EXPECT_GT(milder, 10) << "it has to make a difference";
}

}  // namespace
}  // namespace tccm
