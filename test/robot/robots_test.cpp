/// Real robots' models, from URDF and meshes to primitives and the file of them, against urdfdom,
/// Assimp and geometric_shapes.

#include <geometric_shapes/mesh_operations.h>
#include <gtest/gtest.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "fit/primitives_file.h"
#include "robot/link_primitives.h"
#include "ros/resources.h"
#include "support/geometric_shapes_body.h"
#include "support/random.h"
#include "support/robot_meshes.h"
#include "tccm_monitor/robot_model.h"

namespace tccm {
namespace {

using test::LinkMesh;
using test::Random;
using test::SharedRobot;

/// A robot as the project reads it, and as other libraries do.
struct Robot {
  explicit Robot(const SharedRobot& shared)
      : model(shared.urdf(), {}, {resourceReader(shared.packages()), {}, {}}),
        urdf(urdf::parseURDF(shared.urdf())),
        meshes(test::collisionMeshes(*urdf, shared)) {}

  RobotModel model;
  urdf::ModelInterfaceSharedPtr urdf;
  std::vector<LinkMesh> meshes;
};

/// Fitted once for all tests.
const Robot& robotOf(const SharedRobot& shared) {
  static std::map<std::string, Robot> robots;
  const auto found = robots.find(shared.folder);
  return found != robots.end() ? found->second
                               : robots.emplace(shared.folder, shared).first->second;
}

LinkPrimitives writtenAndReadAgain(const LinkPrimitives& primitives) {
  return readPrimitives(writePrimitives(primitives, "A robot."), "robot.yaml");
}

/// What geometric_shapes takes for inside a link's primitives.
class Inside {
 public:
  explicit Inside(const std::vector<PlacedShape>& primitives) {
    for (const PlacedShape& primitive : primitives) add(primitive);
  }

  [[nodiscard]] bool contains(const Vector3& p_link) const {
    return std::any_of(bodies_.begin(), bodies_.end(),
                       [&](const auto& body) { return body->containsPoint(p_link); });
  }

 private:
  void add(const PlacedShape& primitive) {
    const auto* capsule = std::get_if<Capsule>(&primitive.shape);
    if (capsule == nullptr) {
      bodies_.push_back(test::toBody(primitive.shape));
      bodies_.back()->setPose(primitive.pose);
      return;
    }
    for (const double end : {-capsule->half_length, capsule->half_length}) {
      const Pose T_link_ball = primitive.pose * Eigen::Translation3d(0.0, 0.0, end);
      add({Sphere{capsule->radius}, T_link_ball});
    }
    add({Cylinder{capsule->radius, capsule->half_length}, primitive.pose});
  }

  std::vector<std::unique_ptr<bodies::Body>> bodies_;
};

Vector3 pointOn(const Mesh& mesh, const Mesh::Triangle& triangle, Random& random) {
  double u = random.uniform(0.0, 1.0), v = random.uniform(0.0, 1.0);
  if (u + v > 1.0) {
    u = 1.0 - u;
    v = 1.0 - v;
  }
  const Vector3& origin = mesh.vertices[triangle[0]];
  return origin + u * (mesh.vertices[triangle[1]] - origin) +
         v * (mesh.vertices[triangle[2]] - origin);
}

/// The mesh's vertices, and five points on each of its triangles.
std::vector<Vector3> pointsOf(const Mesh& mesh, Random& random) {
  std::vector<Vector3> points = mesh.vertices;
  for (const Mesh::Triangle& triangle : mesh.triangles) {
    for (int i = 0; i < 5; ++i) points.push_back(pointOn(mesh, triangle, random));
  }
  return points;
}

void expectCovered(const std::vector<LinkMesh>& meshes, const LinkPrimitives& primitives) {
  Random random(1);
  for (const LinkMesh& mesh : meshes) {
    const Inside inside(primitives.at(mesh.link));
    ASSERT_FALSE(mesh.mesh.vertices.empty()) << mesh.uri;
    std::size_t outside = 0;
    for (const Vector3& point : pointsOf(mesh.mesh, random)) outside += !inside.contains(point);
    EXPECT_EQ(outside, 0U) << mesh.link << ": " << mesh.uri;
  }
}

/// On the surface of what the URDF says, in its own frame; short of it by what rounding may do.
Vector3 surfacePoint(const urdf::Geometry& geometry, Random& random) {
  constexpr double kShort = 1.0 - 1e-7;
  const double side = random.chance(0.5) ? 0.5 : -0.5;
  const Vector3 direction = random.direction();
  if (geometry.type == urdf::Geometry::SPHERE) {
    return kShort * dynamic_cast<const urdf::Sphere&>(geometry).radius * direction;
  }
  if (geometry.type == urdf::Geometry::CYLINDER) {
    const auto& cylinder = dynamic_cast<const urdf::Cylinder&>(geometry);
    const Eigen::Vector2d rim = cylinder.radius * direction.head<2>().normalized();
    return kShort * Vector3(rim.x(), rim.y(), side * cylinder.length);
  }
  const urdf::Vector3& size = dynamic_cast<const urdf::Box&>(geometry).dim;
  const double other_side = random.chance(0.5) ? 0.5 : -0.5;
  return kShort * Vector3(side * size.x, other_side * size.y, random.uniform(-0.5, 0.5) * size.z);
}

void expectPrimitiveElementsCovered(const urdf::ModelInterface& urdf,
                                    const LinkPrimitives& primitives) {
  Random random(2);
  for (const auto& [name, link] : urdf.links_) {
    for (const auto& collision : link->collision_array) {
      if (collision->geometry->type == urdf::Geometry::MESH) continue;
      const Inside inside(primitives.at(name));
      for (int i = 0; i < 200; ++i) {
        const Vector3 point = surfacePoint(*collision->geometry, random);
        ASSERT_TRUE(inside.contains(test::toPose(collision->origin) * point)) << name;
      }
    }
  }
}

class RobotsTest : public ::testing::TestWithParam<SharedRobot> {
 protected:
  void SetUp() override {
    if (!GetParam().isThere()) GTEST_SKIP() << "no robot " << GetParam().folder;
  }
  [[nodiscard]] static const Robot& robot() { return robotOf(GetParam()); }
};

std::set<std::string> linksWithCollision(const urdf::ModelInterface& urdf) {
  std::set<std::string> links;
  for (const auto& [name, link] : urdf.links_) {
    if (!link->collision_array.empty()) links.insert(name);
  }
  return links;
}

TEST_P(RobotsTest, EveryLinkThatTheUrdfGivesCollisionElementsHasPrimitives) {
  std::set<std::string> links;
  for (const auto& entry : primitivesOf(robot().model)) links.insert(entry.first);
  EXPECT_EQ(links, linksWithCollision(*robot().urdf));
  EXPECT_EQ(links.size() + robot().model.linksWithoutShape().size(), robot().urdf->links_.size());
}

TEST_P(RobotsTest, EveryVertexAndTriangleOfEveryMeshIsInsideThePrimitives) {
  expectCovered(robot().meshes, primitivesOf(robot().model));
}

TEST_P(RobotsTest, EveryVertexAndTriangleOfEveryMeshIsInsideThePrimitivesOfTheWrittenFile) {
  expectCovered(robot().meshes, writtenAndReadAgain(primitivesOf(robot().model)));
}

TEST_P(RobotsTest, ThePrimitivesOfTheUrdfAreCoveredByThoseOfModelAndFile) {
  const LinkPrimitives primitives = primitivesOf(robot().model);
  expectPrimitiveElementsCovered(*robot().urdf, primitives);
  expectPrimitiveElementsCovered(*robot().urdf, writtenAndReadAgain(primitives));
}

INSTANTIATE_TEST_SUITE_P(SharedRobots, RobotsTest,
                         ::testing::Values(test::kBaxter, test::kGuardian, test::kNextage,
                                           test::kPanda, test::kPandaOfPrimitives, test::kPr2,
                                           test::kUr5),
                         [](const auto& info) { return info.param.folder; });

/// What meshes were covered by.
struct Totals {
  double primitives_m3 = 0.0;
  double hulls_m3 = 0.0;  ///< by geometric_shapes
  double hulls_of_model_m3 = 0.0;
  std::size_t primitives = 0;
  std::size_t links = 0;  ///< with meshes
};

/// Of geometric_shapes' hull, as a sum of tetrahedra. Its own computeVolume() takes the triangles'
/// windings for those of a closed surface, which they are not.
double hullVolume(const Mesh& mesh) {
  const EigenSTL::vector_Vector3d vertices(mesh.vertices.begin(), mesh.vertices.end());
  std::vector<unsigned> corners;
  for (const Mesh::Triangle& triangle : mesh.triangles) {
    corners.insert(corners.end(), triangle.begin(), triangle.end());
  }
  const std::unique_ptr<shapes::Mesh> shape(shapes::createMeshFromVertices(vertices, corners));
  const bodies::ConvexMesh hull(shape.get());
  const EigenSTL::vector_Vector3d& points = hull.getVertices();
  const std::vector<unsigned>& triangles = hull.getTriangles();
  Vector3 inside = Vector3::Zero();
  for (const Vector3& point : points) inside += point / static_cast<double>(points.size());
  double volume_m3 = 0.0;
  for (std::size_t i = 0; i + 2 < triangles.size(); i += 3) {
    const Vector3 a = points[triangles[i]] - inside;
    const Vector3 b = points[triangles[i + 1]] - inside;
    const Vector3 c = points[triangles[i + 2]] - inside;
    volume_m3 += std::abs(a.dot(b.cross(c))) / 6.0;
  }
  return volume_m3;
}

void add(const Robot& robot, Totals& totals) {
  std::set<std::string> links;
  for (const LinkMesh& mesh : robot.meshes) {
    links.insert(mesh.link);
    totals.hulls_m3 += hullVolume(mesh.mesh);
  }
  totals.links += links.size();
  for (const LinkElement& element : robot.model.elements()) {
    if (element.source != "mesh") continue;
    totals.primitives += element.shapes;
    totals.hulls_of_model_m3 += element.hull_volume_m3;
    for (std::size_t i = 0; i < element.shapes; ++i) {
      totals.primitives_m3 += volume(robot.model.shapes()[element.first_shape + i].shape);
    }
  }
}

TEST(RobotsTotalsTest, FewPrimitivesThatAreNotMuchLargerThanTheHulls) {
  Totals totals;
  for (const SharedRobot& robot : {test::kPr2, test::kPanda, test::kUr5, test::kNextage}) {
    if (!robot.isThere()) GTEST_SKIP() << "no robot " << robot.folder;
    add(robotOf(robot), totals);
  }
  EXPECT_GT(totals.links, 50U);
  EXPECT_NEAR(totals.hulls_of_model_m3, totals.hulls_m3, 1e-6 * totals.hulls_m3);
  EXPECT_LE(totals.primitives_m3, 1.6 * totals.hulls_m3);
  EXPECT_LE(static_cast<double>(totals.primitives), 3.0 * static_cast<double>(totals.links));
}

}  // namespace
}  // namespace tccm
