#include "simulation/world.h"

#include <gtest/gtest.h>

namespace tccm::simulation {
namespace {

TEST(World, an_object_appears_and_moves_straight_to_its_place) {
  SceneObject object{"ball", Sphere{0.1}, at(1.0, 0.0, 0.0), Eigen::Vector3f::Zero()};
  const Time appears{std::chrono::seconds(5)};
  object.entrance = Entrance{appears, Vector3(0.0, 1.0, 0.0), 0.5};
  EXPECT_FALSE(object.poseAt(appears - Duration(1)));
  EXPECT_NEAR(object.poseAt(appears)->translation().y(), 1.0, 1e-9);
  EXPECT_NEAR(object.poseAt(appears + std::chrono::seconds(1))->translation().y(), 0.5, 1e-9);
  EXPECT_EQ(object.poseAt(appears + std::chrono::seconds(3))->translation().y(), 0.0);
}

TEST(World, every_scene_has_valid_shapes_and_an_unknown_one_is_refused) {
  for (const std::string& name : sceneNames()) {
    const World world = scene(name);
    EXPECT_FALSE(world.empty());
    for (const SceneObject& object : world) EXPECT_NO_THROW(validate(object.shape, object.name));
  }
  EXPECT_ANY_THROW((void)scene("moon"));
}

TEST(World, the_table_top_is_at_750_mm_from_450_mm_ahead) {
  for (const SceneObject& object : scene("table")) {
    if (object.name != "table" || name(object.shape) != "box") continue;
    const UprightBox box = bounds(object.shape, object.T_fixed_shape);
    EXPECT_NEAR(box.max().z(), 0.75, 1e-9);
    EXPECT_NEAR(box.min().x(), 0.45, 1e-9);
  }
}

}  // namespace
}  // namespace tccm::simulation
