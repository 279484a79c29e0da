#include "simulation/world.h"

#include <gtest/gtest.h>

namespace tccm::simulation {
namespace {

TEST(WorldTest, AnObjectAppearsAndMovesStraightToItsPlace) {
  SceneObject object{"ball", Sphere{0.1}, at(1.0, 0.0, 0.0), Eigen::Vector3f::Zero()};
  const Time appears{std::chrono::seconds(5)};
  object.entrance = Entrance{appears, Vector3(0.0, 1.0, 0.0), 0.5};
  EXPECT_FALSE(object.poseAt(appears - Duration(1)));
  EXPECT_NEAR(object.poseAt(appears)->translation().y(), 1.0, 1e-9);
  EXPECT_NEAR(object.poseAt(appears + std::chrono::seconds(1))->translation().y(), 0.5, 1e-9);
  EXPECT_EQ(object.poseAt(appears + std::chrono::seconds(3))->translation().y(), 0.0);
}

TEST(WorldTest, AnObjectThatLeavesMovesAwayAndIsGone) {
  SceneObject object{"ball", Sphere{0.1}, at(1.0, 0.0, 0.0), Eigen::Vector3f::Zero()};
  const Time appears{std::chrono::seconds(5)};
  const Time leaves{std::chrono::seconds(10)};
  object.entrance = Entrance{appears, Vector3(0.0, 1.0, 0.0), 0.5};
  object.departure = Departure{leaves, Vector3(0.0, 0.0, 0.5), 0.25};
  EXPECT_NEAR(object.poseAt(appears + std::chrono::seconds(1))->translation().y(), 0.5, 1e-9);
  EXPECT_TRUE(object.poseAt(leaves)->isApprox(at(1.0, 0.0, 0.0)));
  EXPECT_NEAR(object.poseAt(leaves + std::chrono::seconds(1))->translation().z(), 0.25, 1e-9);
  EXPECT_FALSE(object.poseAt(leaves + std::chrono::seconds(2)));
}

TEST(WorldTest, AShuttleGoesToAndFroBetweenTwoPlaces) {
  SceneObject object{"sheet", Sphere{0.1}, at(1.0, 0.0, 0.0), Eigen::Vector3f::Zero()};
  const Time starts{std::chrono::seconds(5)};
  object.shuttle = Shuttle{starts, Vector3(0.0, 0.4, 0.0), 0.1};
  const std::vector<double> y = {0.0, 0.1, 0.2, 0.3, 0.4, 0.3, 0.2, 0.1, 0.0, 0.1};
  EXPECT_EQ(object.poseAt(starts - Duration(1))->translation().y(), 0.0);
  for (std::size_t i = 0; i < y.size(); ++i) {
    const Vector3 place = object.poseAt(starts + std::chrono::seconds(i))->translation();
    EXPECT_TRUE(place.isApprox(Vector3(1.0, y[i], 0.0), 1e-9)) << i << " s";
  }
}

TEST(WorldTest, EverySceneHasValidShapesAndAnUnknownOneIsRefused) {
  for (const std::string& name : sceneNames()) {
    const World world = scene(name);
    EXPECT_FALSE(world.empty());
    for (const SceneObject& object : world) EXPECT_NO_THROW(validate(object.shape, object.name));
  }
  EXPECT_ANY_THROW((void)scene("moon"));
}

TEST(WorldTest, TheTableTopIsAt750MmFrom450MmAhead) {
  for (const SceneObject& object : scene("table")) {
    if (object.name != "table" || name(object.shape) != "box") continue;
    const UprightBox box = bounds(object.shape, object.T_fixed_shape);
    EXPECT_NEAR(box.max().z(), 0.75, 1e-9);
    EXPECT_NEAR(box.min().x(), 0.45, 1e-9);
  }
}

}  // namespace
}  // namespace tccm::simulation
