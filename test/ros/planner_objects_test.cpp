#include "ros/planner_objects.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/placed.h"
#include "support/random.h"
#include "support/refusal.h"

namespace tccm {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// As moveit_msgs, shape_msgs and std_msgs have them.
struct Header {
  std::string frame_id;
};
struct Solid {
  unsigned char type;
  std::vector<double> dimensions;
};
struct Vertex {
  double x, y, z;
};
struct Mesh {
  std::vector<Vertex> vertices;
};
struct Plane {};
struct OldObject {  // the first that had no pose of their own
  Header header;
  std::string id;
  std::vector<Solid> primitives;
  std::vector<geometry_msgs::Pose> primitive_poses;
  std::vector<Mesh> meshes;
  std::vector<geometry_msgs::Pose> mesh_poses;
  std::vector<Plane> planes;
  signed char operation = 0;
};
struct NewObject : OldObject {
  geometry_msgs::Pose pose;
};
template <typename Object>
struct Attached {
  std::string link_name;
  Object object;
};
template <typename Object>
struct State {
  std::vector<Attached<Object>> attached_collision_objects;
  bool is_diff = false;
};

geometry_msgs::Pose poseAt(double x, double y = 0.0, double z = 0.0) {
  geometry_msgs::Pose pose;
  pose.position.x = x;
  pose.position.y = y;
  pose.position.z = z;
  return pose;  // no rotation, as it is often left
}

const Solid kBall{planner::kSphere, {0.05}};

template <typename Object = NewObject>
Attached<Object> attachedOf(const std::string& id, const std::vector<Solid>& solids = {kBall},
                            const std::string& link = "palm") {
  Attached<Object> attached;
  attached.link_name = attached.object.header.frame_id = link;
  attached.object.id = id;
  attached.object.primitives = solids;
  for (std::size_t i = 0; i < solids.size(); ++i) attached.object.primitive_poses.emplace_back();
  return attached;
}

class PlannerObjectsTest : public ::testing::Test {
 protected:
  template <typename Attached>
  void take(const Attached& message) {
    EXPECT_EQ(objects_.take(message), "");
  }
  template <typename Attached>
  void expectRefused(const Attached& message, const std::string& why) {
    const HeldShapes before = objects_.shapes();
    const std::string defect = objects_.take(message);
    EXPECT_TRUE(test::names(defect, why)) << defect;
    EXPECT_EQ(objects_.shapes(), before);
  }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const auto& entry : objects_.shapes()) names.push_back(entry.first);
    return names;
  }
  [[nodiscard]] tccm_monitor::Primitive primitive(const std::string& name) const {
    return objects_.shapes().at(name).primitive;
  }
  using Names = std::vector<std::string>;

  PlannerObjects objects_{[](const std::string& link, const std::string& frame) {
    return link == "palm" && frame == "tool" ? std::optional<Pose>(test::placedAt(0.0, 0.0, 1.0))
                                             : std::nullopt;
  }};
};

TEST_F(PlannerObjectsTest, BoxBallAndCylinderAreTakenAsTheyAre) {
  take(attachedOf("thing", {{planner::kBox, {0.1, 0.2, 0.3}},
                            {planner::kSphere, {0.05}},
                            {planner::kCylinder, {0.4, 0.06}}}));
  EXPECT_EQ(names(), (Names{"thing/0", "thing/1", "thing/2"}));
  EXPECT_EQ(objects_.shapes().at("thing/2").link, "palm");
  EXPECT_EQ(primitive("thing/0").shape, "box");
  EXPECT_NEAR(primitive("thing/0").size.x, 0.1, 1e-12);
  EXPECT_NEAR(primitive("thing/0").size.z, 0.3, 1e-12);
  EXPECT_EQ(primitive("thing/1").shape, "sphere");
  EXPECT_NEAR(primitive("thing/1").radius, 0.05, 1e-12);
  EXPECT_EQ(primitive("thing/2").shape, "cylinder");
  EXPECT_NEAR(primitive("thing/2").length, 0.4, 1e-12);
  EXPECT_NEAR(primitive("thing/2").radius, 0.06, 1e-12);
}

TEST_F(PlannerObjectsTest, AConeAndAMeshAreEnclosed) {
  auto attached = attachedOf("thing", {{planner::kCone, {0.4, 0.06}}});
  attached.object.meshes = {{{{0.0, 0.0, 0.0}, {0.2, 0.0, 0.0}, {0.0, 0.4, 0.0}}}};
  attached.object.mesh_poses = {poseAt(1.0)};
  take(attached);
  EXPECT_EQ(primitive("thing/0").shape, "cylinder");
  EXPECT_NEAR(primitive("thing/0").length, 0.4, 1e-12);
  const tccm_monitor::Primitive box = primitive("thing/1");
  EXPECT_EQ(box.shape, "box");
  EXPECT_NEAR(box.size.x, 0.2, 1e-12);
  EXPECT_NEAR(box.size.y, 0.4, 1e-12);
  EXPECT_GT(box.size.z, 0.0) << "what is flat is a body all the same";
  EXPECT_NEAR(box.pose.position.x, 1.1, 1e-12);
  EXPECT_NEAR(box.pose.position.y, 0.2, 1e-12);
}

TEST_F(PlannerObjectsTest, PosesOfFrameObjectAndShapeFollowEachOther) {
  auto attached = attachedOf("cup");
  attached.object.header.frame_id = "tool";
  attached.object.pose = poseAt(0.1);
  attached.object.pose.orientation.z = attached.object.pose.orientation.w = std::sqrt(0.5);
  attached.object.primitive_poses = {poseAt(0.2)};
  take(attached);
  const geometry_msgs::Pose pose = primitive("cup").pose;
  EXPECT_NEAR(pose.position.x, 0.1, 1e-12);
  EXPECT_NEAR(pose.position.y, 0.2, 1e-12) << "the object is turned by a quarter";
  EXPECT_NEAR(pose.position.z, 1.0, 1e-12);
  EXPECT_NEAR(std::abs(pose.orientation.z), std::sqrt(0.5), 1e-12);
}

TEST_F(PlannerObjectsTest, MessagesWithoutAnObjectsPoseAreUnderstood) {
  auto attached = attachedOf<OldObject>("cup");
  attached.object.primitive_poses = {poseAt(0.2)};
  take(attached);
  EXPECT_NEAR(primitive("cup").pose.position.x, 0.2, 1e-12);
  EXPECT_EQ(primitive("cup").pose.orientation.w, 1.0);
  attached.object.primitive_poses.clear();
  take(attached);
  EXPECT_EQ(primitive("cup").pose.position.x, 0.0);
}

TEST_F(PlannerObjectsTest, WhatCannotBeTakenIsNamedAndNothingChanges) {
  take(attachedOf("cup"));
  auto cup = attachedOf("cup");
  cup.object.planes.emplace_back();
  expectRefused(cup, "plane");
  expectRefused(attachedOf("cup", {}), "no shape");
  expectRefused(attachedOf("", {kBall}), "no name");
  expectRefused(attachedOf("cup", {{planner::kBox, {0.1, 0.2}}}), "2 dimensions in place of 3");
  expectRefused(attachedOf("cup", {{5, {0.1, 0.2}}}), "type 5");
  expectRefused(attachedOf("cup", {{planner::kSphere, {kNaN}}}), "cup");
  expectRefused(attachedOf("cup", {{planner::kSphere, {-0.1}}}), "cup");
  expectRefused(attachedOf("cup", std::vector<Solid>(17, kBall)), "more than 16");
  cup = attachedOf("cup");
  cup.object.header.frame_id = "world";
  expectRefused(cup, "'world'");
  cup = attachedOf("cup");
  cup.object.pose.position.x = kNaN;
  expectRefused(cup, "cup");
  cup = attachedOf("cup");
  cup.object.operation = 3;
  expectRefused(cup, "added");
  cup = attachedOf("cup", {});
  cup.object.meshes.emplace_back();
  expectRefused(cup, "no vertices");
}

TEST_F(PlannerObjectsTest, OfAllObjectsTogetherThereIsALimit) {
  for (int i = 0; i < 8; ++i) {
    const std::vector<Solid> balls(8, kBall);
    take(attachedOf(std::to_string(i), balls));
  }
  expectRefused(attachedOf("cup"), "64");
  take(attachedOf("3"));
  take(attachedOf("cup"));
}

TEST_F(PlannerObjectsTest, OneOfTheSameNameIsReplacedOrAppendedTo) {
  take(attachedOf("cup"));
  take(attachedOf("cup", {{planner::kSphere, {0.06}}}));
  EXPECT_EQ(names(), Names{"cup"});
  EXPECT_NEAR(primitive("cup").radius, 0.06, 1e-12);
  auto more = attachedOf("cup");
  more.object.operation = planner::kAppend;
  take(more);
  EXPECT_EQ(names(), (Names{"cup/0", "cup/1"}));
  EXPECT_NEAR(primitive("cup/0").radius, 0.06, 1e-12);
}

TEST_F(PlannerObjectsTest, OnesAreRemovedByNameByLinkOrAltogether) {
  const auto removed = [](const std::string& id, const std::string& link) {
    auto attached = attachedOf(id, {}, link);
    attached.object.operation = planner::kRemove;
    return attached;
  };
  for (const char* id : {"cup", "lid"}) take(attachedOf(id));
  take(attachedOf("saw", {kBall}, "other_palm"));
  take(removed("cup", ""));
  EXPECT_EQ(names(), (Names{"lid", "saw"}));
  take(removed("never there", ""));
  take(removed("", "palm"));
  EXPECT_EQ(names(), Names{"saw"});
  take(attachedOf("cup"));
  take(removed("", ""));
  EXPECT_EQ(names(), Names{});
}

TEST_F(PlannerObjectsTest, AStateIsAllThatIsAttachedUnlessItIsADifference) {
  State<NewObject> state;
  state.attached_collision_objects = {attachedOf("cup"), attachedOf("lid")};
  EXPECT_TRUE(objects_.takeState(state).empty());
  EXPECT_EQ(names(), (Names{"cup", "lid"}));
  State<NewObject> difference;
  difference.is_diff = true;
  EXPECT_TRUE(objects_.takeState(difference).empty());
  EXPECT_EQ(names(), (Names{"cup", "lid"}));
  difference.attached_collision_objects = {attachedOf("lid", {}), attachedOf("saw")};
  difference.attached_collision_objects[0].object.operation = planner::kRemove;
  EXPECT_TRUE(objects_.takeState(difference).empty());
  EXPECT_EQ(names(), (Names{"cup", "saw"}));
  state.attached_collision_objects = {attachedOf("lid"), attachedOf("cup", {{9, {}}})};
  const std::vector<std::string> passed_over = objects_.takeState(state);
  ASSERT_EQ(passed_over.size(), 1U);
  EXPECT_TRUE(test::names(passed_over[0], "type 9"));
  EXPECT_EQ(names(), (Names{"cup", "lid"})) << "what cannot be taken stays as it was";
  state.attached_collision_objects.clear();
  EXPECT_TRUE(objects_.takeState(state).empty());
  EXPECT_EQ(names(), Names{});
}

TEST_F(PlannerObjectsTest, TheBoxAroundAnyMeshHasAllOfItsVertices) {
  test::Random random(3);
  for (int i = 0; i < 200; ++i) {
    Mesh mesh;
    for (int k = random.integer(1, 30); k > 0; --k) {
      const Vector3 p = random.point(0.3);
      mesh.vertices.push_back({p.x(), p.y(), random.chance(0.2) ? 0.0 : p.z()});
    }
    const PlacedShape box = planner::boxAround(mesh, "mesh");
    for (const Vertex& v : mesh.vertices) {
      EXPECT_LT(distance(box.shape, box.pose.inverse() * Vector3(v.x, v.y, v.z)), 1e-12);
    }
  }
}

}  // namespace
}  // namespace tccm
