#include "simulation/depth_image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "geometry/ray.h"
#include "support/random.h"

namespace tccm::simulation {
namespace {

using test::Random;

Vector3 rayOf(const Pinhole& camera, std::size_t row, std::size_t column) {
  return {(static_cast<double>(column) - camera.centreColumn()) / camera.focal_px,
          (static_cast<double>(row) - camera.centreRow()) / camera.focal_px, 1.0};
}

struct Scene {
  std::vector<Shape> shapes;
  std::vector<Pose> poses;  ///< T_camera_shape
};

/// The nearest shape on a ray by geometry/ray.h.
struct Exact {
  double depth = std::numeric_limits<double>::infinity();
  std::uint32_t target = DepthImage::kNothing;
  double cosine = 0.0;   ///< of the angle between the ray and the normal
  double grazing = 1.0;  ///< length inside the shape [m]
};

Exact exactly(const Scene& scene, const Vector3& ray) {
  Exact nearest;
  for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
    const Pose T_shape_camera = scene.poses[i].inverse();
    if (distance(scene.shapes[i], T_shape_camera.translation()) == 0.0) continue;
    const Ray in_shape = transformed({Vector3::Zero(), ray.normalized()}, T_shape_camera);
    const auto span = intersect(scene.shapes[i], in_shape);
    if (!span || span->enter / ray.norm() >= nearest.depth) continue;
    // The slope of the distance just before the surface is the cosine.
    const double before = span->enter - 1e-6;
    nearest = {span->enter / ray.norm(), static_cast<std::uint32_t>(i),
               distance(scene.shapes[i], in_shape.at(before)) / 1e-6, span->leave - span->enter};
  }
  return nearest;
}

/// @return how many pixels show something.
std::size_t expectExact(const Scene& scene, const Pinhole& camera) {
  DepthImage image(camera);
  for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
    image.draw(static_cast<std::uint32_t>(i), scene.shapes[i], scene.poses[i]);
  }
  std::size_t shown = 0, at_outlines = 0;
  for (std::size_t row = 0; row < camera.height; ++row) {
    for (std::size_t column = 0; column < camera.width; ++column) {
      const std::size_t pixel = row * camera.width + column;
      const Vector3 ray = rayOf(camera, row, column);
      const Exact exact = exactly(scene, ray);
      const float inverse = image.inverseDepths()[pixel];
      const double depth = inverse > 0.0F ? 1.0 / static_cast<double>(inverse)
                                          : std::numeric_limits<double>::infinity();
      const bool same = image.targets()[pixel] == exact.target;
      const bool near = std::abs(depth - exact.depth) <= 2e-5 * std::max(1.0, exact.depth);
      if (exact.target == DepthImage::kNothing && same) continue;
      ++shown;
      // A ray that touches an outline may be taken for one that passes it.
      if (!(same && near) && exact.grazing < 2e-3) {
        ++at_outlines;
        continue;
      }
      if (!same && std::isinf(exact.depth)) {
        ++at_outlines;
        continue;
      }
      EXPECT_TRUE(near) << row << ' ' << column << ": " << depth << " for " << exact.depth;
      if (same && exact.cosine > 0.05 && exact.cosine <= 1.001) {
        EXPECT_NEAR(static_cast<double>(image.facings()[pixel]) / ray.norm(), exact.cosine, 0.01);
      }
    }
  }
  EXPECT_LE(at_outlines, 2 + shown / 500);
  return shown;
}

TEST(DepthImageTest, ABoxAheadIsAtTheDepthOfItsFace) {
  const Pinhole camera{9, 7, 8.0};
  DepthImage image(camera);
  image.draw(5, Box{Vector3(0.2, 0.2, 0.5)}, Pose(Eigen::Translation3d(0.0, 0.0, 1.5)));
  // It reaches to 8 * 0.2 / 1 = 1.6 pixels from the middle.
  for (std::size_t row = 0; row < 7; ++row) {
    for (std::size_t column = 0; column < 9; ++column) {
      const bool is_inside = row >= 2 && row <= 4 && column >= 3 && column <= 5;
      const std::size_t pixel = row * 9 + column;
      EXPECT_EQ(image.targets()[pixel], is_inside ? 5U : DepthImage::kNothing);
      EXPECT_FLOAT_EQ(image.inverseDepths()[pixel], is_inside ? 1.0F : 0.0F);
      if (is_inside) {
        EXPECT_FLOAT_EQ(image.facings()[pixel], 1.0F);
      }
    }
  }
}

TEST(DepthImageTest, TheNearerShapeIsShownWhicheverIsDrawnFirst) {
  const Shape ball = Sphere{0.3};
  const Pose near(Eigen::Translation3d(0.0, 0.0, 1.0)), far(Eigen::Translation3d(0.0, 0.0, 2.0));
  for (const bool near_first : {true, false}) {
    DepthImage image({5, 5, 5.0});
    image.draw(near_first ? 1 : 2, ball, near_first ? near : far);
    image.draw(near_first ? 2 : 1, ball, near_first ? far : near);
    EXPECT_EQ(image.targets()[12], 1U);
    EXPECT_NEAR(1.0 / image.inverseDepths()[12], 0.7, 1e-6);
    image.clear();
    EXPECT_EQ(image.targets()[12], DepthImage::kNothing);
  }
}

TEST(DepthImageTest, ItsOwnHousingIsNotSeen) {
  DepthImage image({5, 5, 5.0});
  for (const Shape& shape : {Shape(Box{Vector3::Constant(0.1)}), Shape(Sphere{0.1}),
                             Shape(Capsule{0.1, 0.1}), Shape(Cylinder{0.1, 0.1})}) {
    image.draw(0, shape, Pose(Eigen::Translation3d(0.0, 0.0, 0.05)));
  }
  EXPECT_EQ(image.targets()[12], DepthImage::kNothing);
}

TEST(DepthImageTest, RandomShapesAreWhereRaysMeetThem) {
  std::size_t shown = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    Scene scene;
    for (int i = 0; i < 12; ++i) {
      scene.shapes.push_back(random.shape(scene.shapes.size() % test::kShapeKinds));
      scene.poses.push_back(random.pose(0.6));
      scene.poses.back().translation().z() += 0.7;  // some beside and behind the camera
    }
    shown += expectExact(scene, {48, 36, 30.0});
  }
  EXPECT_GT(shown, 10000U);
}

TEST(DepthImageTest, ShapesAroundAndCloseToTheCameraAreWhereRaysMeetThem) {
  std::size_t shown = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    Scene scene;
    for (std::size_t kind = 0; kind < test::kShapeKinds; ++kind) {
      scene.shapes.push_back(expanded(random.shape(kind), {3.0, 0.0}));
      scene.poses.push_back(random.pose(0.5));
      // A camera on the axis of a tube, beyond its end.
      scene.shapes.push_back(random.shape(kind));
      scene.poses.emplace_back(Eigen::Translation3d(0.001, -0.002, 0.9));
    }
    shown += expectExact(scene, {48, 36, 30.0});
  }
  EXPECT_GT(shown, 20000U);
}

}  // namespace
}  // namespace tccm::simulation
