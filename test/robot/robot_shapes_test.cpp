/// Which shapes a robot model has: groups, ignored links, visual geometry, files of primitives,
/// meshes, and what the robot holds.
#include <gtest/gtest.h>

#include "robot/link_use.h"
#include "support/near.h"
#include "support/refusal.h"
#include "support/tiny_robot.h"
#include "tccm_monitor/config_error.h"
#include "tccm_monitor/robot_model.h"

namespace tccm {
namespace {

using namespace test::urdf_text;
using test::names;
using test::refusalOf;

constexpr const char* kTetrahedron =
    "v 0 0 0\nv 0.1 0 0\nv 0 0.2 0\nv 0 0 0.3\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n";

std::string visualOf(const std::string& geometry) {
  return "<visual><geometry>" + geometry + "</geometry></visual>";
}

std::string meshOf(const std::string& uri, const std::string& scale = "1 1 1") {
  return "<mesh filename=\"" + uri + "\" scale=\"" + scale + "\"/>";
}

/// Reads what it is given by URI.
RobotResources files(const std::map<std::string, std::string>& contents) {
  RobotResources resources;
  resources.read = [contents](const std::string& uri) {
    const auto found = contents.find(uri);
    if (found == contents.end()) throw ConfigError(uri + ": there is no such file");
    return found->second;
  };
  return resources;
}

std::vector<std::string> shapeLinks(const RobotModel& model) {
  std::vector<std::string> links;
  for (std::size_t i = 0; i < model.shapes().size(); ++i) links.push_back(model.linkOf(i));
  return links;
}

using Links = std::vector<std::string>;

/// base (no shape) -> arm, hand (balls) and eye (seen only).
std::string someRobot() {
  return robotOf(linkOf("base") + ballLink("arm") + ballLink("hand") +
                 linkOf("eye", visualOf(sphereOf("0.02"))) +
                 jointOf("shoulder", "continuous", "base", "arm", axisOf("0 0 1")) +
                 jointOf("wrist", "continuous", "arm", "hand", axisOf("0 0 1")) +
                 jointOf("neck", "fixed", "base", "eye"));
}

TEST(RobotShapesTest, LinksWithoutShapeAreReported) {
  const RobotModel model(someRobot(), {});
  EXPECT_EQ(shapeLinks(model), (Links{"arm", "hand"}));
  EXPECT_EQ(model.linksWithoutShape(), (Links{"base", "eye"}));
}

TEST(RobotShapesTest, AGroupIsMonitoredAndIgnoredLinksAreNot) {
  RobotModel::Config config;
  config.link_groups["moving"] = {"arm", "h*"};
  config.monitored_links = {"moving"};
  EXPECT_EQ(shapeLinks(RobotModel(someRobot(), config)), (Links{"arm", "hand"}));
  config.ignored_links = {"hand"};
  const RobotModel model(someRobot(), config);
  EXPECT_EQ(shapeLinks(model), Links{"arm"});
  EXPECT_EQ(model.variables().size(), 1U) << "nobody has to publish the wrist";
  config.monitored_links = {"*"};
  EXPECT_TRUE(names(refusalOf(someRobot(), config), "link 'base'"));
  config.ignored_links = {"hand", "base", "eye"};
  EXPECT_EQ(shapeLinks(RobotModel(someRobot(), config)), Links{"arm"});
  config.ignored_links = {"*"};
  EXPECT_TRUE(names(refusalOf(someRobot(), config), "no link to monitor"));
}

TEST(RobotShapesTest, VisualGeometryIsTakenWhereItIsAskedForAndThere) {
  RobotModel::Config config;
  config.visual_links = {"*"};
  const RobotModel model(someRobot(), config);
  EXPECT_EQ(shapeLinks(model), (Links{"arm", "eye", "hand"}));
  EXPECT_EQ(std::get<Sphere>(model.shapes()[1].shape).radius, 0.02);
  const std::string both =
      robotOf(linkOf("base", collisionOf(sphereOf("0.3")) + visualOf(sphereOf("0.1"))));
  EXPECT_EQ(std::get<Sphere>(RobotModel(both, config).shapes()[0].shape).radius, 0.1);
  EXPECT_EQ(std::get<Sphere>(RobotModel(both, {}).shapes()[0].shape).radius, 0.3);
}

TEST(RobotShapesTest, AMeshIsCoveredAtItsPlaceWithItsScale) {
  const std::string urdf =
      robotOf(linkOf("base", collisionOf(meshOf("package://p/part.obj", "1 -2 1"), "1 0 0")));
  const RobotModel model(urdf, {}, files({{"package://p/part.obj", kTetrahedron}}));
  ASSERT_FALSE(model.shapes().empty());
  for (const Vector3& corner : {Vector3(1.0, 0.0, 0.0), Vector3(1.1, 0.0, 0.0),
                                Vector3(1.0, -0.4, 0.0), Vector3(1.0, 0.0, 0.3)}) {
    bool inside = false;
    for (const LinkShape& shape : model.shapes()) {
      inside = inside || distance(shape.shape, shape.T_link_shape.inverse() * corner) == 0.0;
    }
    EXPECT_TRUE(inside) << corner.transpose();
  }
  ASSERT_EQ(model.elements().size(), 1U);
  const LinkElement& element = model.elements()[0];
  EXPECT_EQ(element.source, "mesh");
  EXPECT_EQ(element.uri, "package://p/part.obj");
  EXPECT_EQ(element.shapes, model.shapes().size());
  EXPECT_NEAR(element.hull_volume_m3, 0.1 * 0.4 * 0.3 / 6.0, 1e-9);
}

TEST(RobotShapesTest, AMeshThatResolvesToNothingOrHasNoScaleIsRefusedNamingLinkAndFile) {
  const auto robot = [](const std::string& scale) {
    return robotOf(linkOf("base", collisionOf(meshOf("package://p/part.obj", scale))));
  };
  const std::string nothing = refusalOf(robot("1 1 1"), {}, files({}));
  EXPECT_TRUE(names(nothing, "link 'base'") && names(nothing, "package://p/part.obj")) << nothing;
  const auto there = files({{"package://p/part.obj", kTetrahedron}});
  EXPECT_EQ(refusalOf(robot("1 1 1"), {}, there), "");
  EXPECT_TRUE(names(refusalOf(robot("1 0 1"), {}, there), "link 'base'"));
  EXPECT_TRUE(names(refusalOf(robot("1 1 1"), {}, files({{"package://p/part.obj", "garbage"}})),
                    "package://p/part.obj"));
}

TEST(RobotShapesTest, AFileOfPrimitivesStandsInForTheShapesOfTheLinksInIt) {
  RobotModel::Config config;
  config.primitives_file = "robot.yaml";
  const std::string text =
      "links: {base: [{shape: box, size: [0.2, 0.4, 0.6]}], "
      "hand: [{shape: sphere, radius: 0.1, xyz: [1, 2, 3]}, {shape: sphere, radius: 0.2}]}";
  const RobotModel model(someRobot(), config, files({{"robot.yaml", text}}));
  EXPECT_EQ(shapeLinks(model), (Links{"base", "arm", "hand", "hand"}));
  EXPECT_TRUE(test::isNearly(std::get<Box>(model.shapes()[0].shape).half_extents,
                             Vector3(0.1, 0.2, 0.3), 1e-12));
  EXPECT_EQ(std::get<Sphere>(model.shapes()[2].shape).radius, 0.1);
  EXPECT_TRUE(test::isNearly(Vector3(model.shapes()[2].T_link_shape.translation()),
                             Vector3(1.0, 2.0, 3.0), 1e-12));
  EXPECT_EQ(model.elements()[0].source, "file");

  const auto refused = [&](const std::string& file) {
    return refusalOf(someRobot(), config, files({{"robot.yaml", file}}));
  };
  EXPECT_TRUE(names(refused("links: {foot: [{shape: sphere, radius: 1}]}"), "'foot'"));
  EXPECT_TRUE(names(refused("links: {hand: [{shape: sphere, radius: -1}]}"), "robot.yaml"));
  EXPECT_TRUE(names(refusalOf(someRobot(), config, files({})), "robot.yaml"));
  EXPECT_TRUE(names(refusalOf(someRobot(), config), "primitives_file"));
}

TEST(RobotShapesTest, AMeshIsNotReadWhereAFileStandsInForIt) {
  RobotModel::Config config;
  config.primitives_file = "robot.yaml";
  const std::string urdf = robotOf(linkOf("base", collisionOf(meshOf("package://p/lost.stl"))));
  const std::string text = "links: {base: [{shape: sphere, radius: 0.1}]}";
  EXPECT_EQ(refusalOf(urdf, config, files({{"robot.yaml", text}})), "");
}

TEST(RobotShapesTest, WhatTheRobotHoldsMovesWithItsLinkAndIsTakenByEveryUse) {
  const RobotModel bare(someRobot(), {});
  Pose ahead = Pose::Identity();
  ahead.translation().x() = 0.2;
  const RobotModel model = bare.holding({{"cup", "arm", {Cylinder{0.04, 0.05}, ahead}}});
  ASSERT_EQ(model.shapes().size(), 3U);
  EXPECT_EQ(model.linkOf(2), "arm");
  EXPECT_EQ(model.shapes()[2].object, "cup");
  EXPECT_EQ(bare.shapes().size(), 2U);
  LinkUse use;
  use.links = {"hand"};
  EXPECT_EQ(model.shapesFor(use, kCollisionKeys).shapes, (std::vector<std::size_t>{1, 2}));
  use.all_objects = false;
  EXPECT_EQ(model.shapesFor(use, kOcclusionKeys).shapes, (std::vector<std::size_t>{1}));
}

TEST(RobotShapesTest, AnObjectOnAnUnknownLinkOrOfNoSizeIsRefused) {
  const RobotModel model(someRobot(), {});
  const auto hold = [&](const std::string& name, const std::string& link, const Shape& shape) {
    return model.holding({{name, link, {shape, Pose::Identity()}}});
  };
  EXPECT_NO_THROW((void)hold("cup", "base", Sphere{0.1}));
  EXPECT_THROW((void)hold("cup", "foot", Sphere{0.1}), ConfigError);
  EXPECT_THROW((void)hold("cup", "eye", Sphere{0.1}), ConfigError) << "it is not placed";
  EXPECT_THROW((void)hold("cup", "arm", Sphere{-0.1}), ConfigError);
  EXPECT_THROW((void)hold("", "arm", Sphere{0.1}), ConfigError);
  EXPECT_THROW((void)hold("cup", "arm", Cylinder{35.0, 50.0}), ConfigError) << "in millimetres";
}

TEST(RobotShapesTest, OnlySoManyObjectsAreHeldAtOnce) {
  const RobotModel model(someRobot(), {});
  std::vector<AttachedObject> objects;
  for (int i = 0; i < 64; ++i) {
    objects.push_back({"cup " + std::to_string(i), "base", {Sphere{0.1}, Pose::Identity()}});
  }
  EXPECT_NO_THROW((void)model.holding(objects));
  objects.push_back({"one too many", "base", {Sphere{0.1}, Pose::Identity()}});
  EXPECT_TRUE(names(test::errorOf([&] { (void)model.holding(objects); }), "one too many"));
}

}  // namespace
}  // namespace tccm
