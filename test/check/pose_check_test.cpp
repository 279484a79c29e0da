#include "check/pose_check.h"

#include <gtest/gtest.h>

#include "support/checked_robot.h"
#include "support/cuboid_scene.h"
#include "support/near.h"
#include "support/tiny_robot.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using test::placedAt;

/// The hand's ball of 50 mm is at (slide, 0, 0.5), the other's at (glide, 0.5, 0.5).
const std::vector<Pose> kAtOrigin{Pose::Identity()};

class PoseCheckTest : public ::testing::Test {
 protected:
  PoseCheckTest() { map_.viewpoint = Vector3(0.0, 0.0, 1.5); }

  PoseFindings check(double slide, double glide, const Pose& T_fixed_root = Pose::Identity()) {
    PoseCheck check(test::checked(model_, config_), 1.5);
    std::vector<double> positions{slide, glide};
    if (model_->variables()[0].name == "glide") std::swap(positions[0], positions[1]);
    PoseFindings findings;
    check.place(positions, {T_fixed_root});
    check.check(map_, findings);
    return findings;
  }
  /// A post at x from 0.8 m on, 0.4 m wide.
  void addPost(double y) {
    test::addBlock(map_, {Vector3(0.8, y - 0.2, 0.0), Vector3(0.9, y + 0.2, 1.0)});
  }
  /// A shelf 0.2 m over the balls, between them and the viewpoint.
  void addShelf(double y) {
    test::addBlock(map_, {Vector3(0.0, y - 0.3, 0.78), Vector3(1.2, y + 0.3, 0.80)});
  }
  [[nodiscard]] std::string linkOf(const Contact& contact) const {
    return model_->linkOf(contact.shape);
  }

  std::shared_ptr<const RobotModel> model_ = test::sliderModel();
  CheckedRobot::Config config_;
  CuboidMap map_ = test::emptyMap();
};

TEST_F(PoseCheckTest, AnEmptyMapTouchesAndHidesNothing) {
  const PoseFindings findings = check(0.5, 0.5);
  EXPECT_FALSE(findings.collision);
  EXPECT_FALSE(findings.occlusion);
  EXPECT_TRUE(findings.contacts.empty());
  ASSERT_EQ(findings.links.size(), 2U);
  for (const LinkVisibility& link : findings.links) EXPECT_EQ(link.occluded_fraction, 0.0);
}

TEST_F(PoseCheckTest, ContactsNameTheModelsShapes) {
  addPost(0.0);
  const PoseFindings touching = check(0.8, 0.0);
  EXPECT_TRUE(touching.collision);
  ASSERT_FALSE(touching.contacts.empty());
  for (const Contact& contact : touching.contacts) EXPECT_EQ(linkOf(contact), "hand");
}

TEST_F(PoseCheckTest, PrimitivesAreExpandedForCollision) {
  addPost(0.0);
  config_.collision_use.expansion = {1.0, 0.04};
  EXPECT_FALSE(check(0.8 - 0.091, 0.0).collision);
  EXPECT_TRUE(check(0.8 - 0.089, 0.0).collision);
  config_.collision_use.expansion = {1.2, 0.01};
  EXPECT_FALSE(check(0.8 - 0.071, 0.0).collision);
  EXPECT_TRUE(check(0.8 - 0.069, 0.0).collision);
}

TEST_F(PoseCheckTest, PrimitivesAreNotExpandedForOcclusion) {
  const double silhouette = check(0.5, 0.0).links[0].silhouette;
  config_.collision_use.expansion = {3.0, 0.5};
  EXPECT_EQ(check(0.5, 0.0).links[0].silhouette, silhouette);
}

TEST_F(PoseCheckTest, TheRootsPoseMovesTheWholeRobot) {
  addPost(0.0);
  EXPECT_FALSE(check(0.4, 0.0).collision);
  EXPECT_TRUE(check(0.4, 0.0, placedAt(0.4, 0.0, 0.0)).collision);
}

TEST_F(PoseCheckTest, CollisionLinksLeaveTheOthersOut) {
  addPost(0.5);
  EXPECT_TRUE(check(0.0, 0.8).collision);
  config_.collision_use.links = {"hand"};
  EXPECT_FALSE(check(0.0, 0.8).collision);
  config_.collision_use.links = {"o*"};
  const PoseFindings findings = check(0.0, 0.8);
  ASSERT_TRUE(findings.collision);
  EXPECT_EQ(linkOf(findings.contacts[0]), "other");
}

TEST_F(PoseCheckTest, AHiddenLinkIsNamedByTheModelsIndex) {
  addShelf(0.5);
  const PoseFindings findings = check(0.6, 0.6);
  EXPECT_TRUE(findings.occlusion);
  EXPECT_FALSE(findings.collision);
  EXPECT_FALSE(findings.occluding_cuboids.empty());
  for (const LinkVisibility& link : findings.links) {
    EXPECT_EQ(link.occluded_fraction > 0.5, model_->links()[link.link] == "other");
  }
}

TEST_F(PoseCheckTest, OcclusionLinksLeaveTheOthersOut) {
  addShelf(0.5);
  config_.occlusion_use.links = {"hand"};
  const PoseFindings findings = check(0.6, 0.6);
  EXPECT_FALSE(findings.occlusion);
  ASSERT_EQ(findings.links.size(), 1U);
  EXPECT_EQ(model_->links()[findings.links[0].link], "hand");
}

TEST_F(PoseCheckTest, WithoutOcclusionOnlyCollisionIsFound) {
  addShelf(0.5);
  config_.check_occlusion = false;
  const PoseFindings findings = check(0.6, 0.6);
  EXPECT_FALSE(findings.occlusion);
  EXPECT_TRUE(findings.links.empty());
}

TEST_F(PoseCheckTest, FindingsAreMadeAnewAtEveryCheck) {
  addPost(0.0);
  addShelf(0.5);
  PoseCheck check(test::checked(model_, config_), 1.5);
  PoseFindings findings;
  check.place({0.8, 0.8}, kAtOrigin);
  check.check(map_, findings);
  ASSERT_TRUE(findings.collision);
  ASSERT_TRUE(findings.occlusion);
  check.place({0.8, 0.8}, kAtOrigin);
  check.check(test::emptyMap(), findings);
  EXPECT_FALSE(findings.collision);
  EXPECT_FALSE(findings.occlusion);
  EXPECT_TRUE(findings.contacts.empty());
  EXPECT_TRUE(findings.occluding_cuboids.empty());
}

TEST_F(PoseCheckTest, TheCheckedBodyCanBeShown) {
  PoseCheck check(test::checked(model_, config_), 1.5);
  PoseFindings findings;
  check.place({0.3, 0.3}, kAtOrigin);
  check.check(map_, findings);
  ASSERT_EQ(check.collisionBody().body.shapes.size(), 2U);
  EXPECT_NEAR(std::get<Sphere>(check.collisionBody().body.shapes[0]).radius, 0.08, 1e-12);
  EXPECT_TRUE(test::isNearly(Vector3(check.collisionBody().body.poses[0].translation()),
                             Vector3(0.3, 0.0, 0.5), 1e-12));
  EXPECT_FALSE(check.occlusion().picture().runs().empty());
  EXPECT_EQ(check.occlusionBody().shapes[1], 1U);
}

TEST_F(PoseCheckTest, ValuesOutOfRangeAndWrongLinksAreRefused) {
  config_.collision_use.expansion.scale = 0.9;
  EXPECT_THROW(test::checked(model_, config_), ConfigError);
  config_.collision_use.expansion = {1.0, -0.01};
  EXPECT_THROW(test::checked(model_, config_), ConfigError);
  config_.collision_use.expansion = {};
  config_.collision_use.links = {"foot"};
  EXPECT_THROW(test::checked(model_, config_), ConfigError);
  config_.collision_use.links = {};
  config_.occlusion_use.links = {"base"};
  EXPECT_THROW(test::checked(model_, config_), ConfigError) << "it has no primitive";
}

}  // namespace
}  // namespace tccm
