#include "check/z_buffer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "check/ray_entry.h"
#include "support/cuboid_scene.h"

namespace tccm {
namespace {

using test::placedAt;
using test::Random;

constexpr double kResolution = 0.035;
const Vector3 kOrigin = Vector3::Zero();

Vector3 directionOf(const ZBuffer& buffer, int row, int column) {
  const double elevation = (row + 0.5) * M_PI / buffer.grid().rows() - 0.5 * M_PI;
  const double azimuth = (column + 0.5) * 2.0 * M_PI / buffer.grid().columns() - M_PI;
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
          std::sin(elevation)};
}

/// The pixels that show something.
std::vector<std::uint32_t> drawnIn(const ZBuffer& buffer) {
  std::vector<std::uint32_t> drawn;
  for (const ZBuffer::Run& run : buffer.runs()) {
    for (std::uint32_t at = run.begin; at < run.end; ++at) drawn.push_back(at);
  }
  return drawn;
}

/// [sr]
double solidAngle(const ZBuffer& buffer) {
  double pixels = 0.0;
  for (const std::uint32_t at : drawnIn(buffer))
    pixels += buffer.grid().cosine(buffer.grid().rowOfPixel(at));
  return pixels * std::pow(M_PI / buffer.grid().rows(), 2);
}

/// Of a ball as seen from outside [sr].
double solidAngleOfBall(double radius, double range) {
  return 2.0 * M_PI * (1.0 - std::sqrt(1.0 - std::pow(radius / range, 2)));
}

TEST(ZBufferTest, PixelsAreNoLargerThanAskedAndFillTheSphere) {
  for (const double resolution : {0.002, 0.017, 0.035, 0.2}) {
    const ZBuffer buffer(resolution);
    EXPECT_LE(M_PI / buffer.grid().rows(), resolution * (1.0 + 1e-12));
    EXPECT_EQ(buffer.grid().columns(), 2 * buffer.grid().rows());
  }
}

TEST(ZBufferTest, ABallCoversItsSolidAngleWhereverItStands) {
  ZBuffer buffer(0.01);
  Random random(1);
  std::vector<Vector3> directions{{1, 0, 0}, {-1, 0, 0},      {0, 0, -1},
                                  {0, 0, 1}, {-1, 1e-9, 0.3}, {0.02, 0.01, -1}};
  for (int i = 0; i < 20; ++i) directions.push_back(random.direction());
  for (const Vector3& direction : directions) {
    const Vector3 centre = 2.0 * direction.normalized();
    buffer.begin(kOrigin);
    buffer.draw(Sphere{0.4}, placedAt(centre.x(), centre.y(), centre.z()), 7);
    EXPECT_NEAR(solidAngle(buffer) / solidAngleOfBall(0.4, 2.0), 1.0, 0.03)
        << direction.transpose();
  }
}

/// Every pixel has what its central ray meets first among all shapes: no window is too tight.
TEST(ZBufferTest, EveryPixelShowsWhatItsRayMeetsFirst) {
  Random random(2);
  ZBuffer buffer(kResolution);
  std::size_t shown = 0;
  for (int scene = 0; scene < 60; ++scene) {
    const Vector3 viewpoint = random.point(0.5);
    Body body;
    buffer.begin(viewpoint);
    for (std::uint32_t i = 0; i < 6; ++i) {
      body.shapes.push_back(random.shape(i % test::kShapeKinds));
      body.poses.push_back(random.pose(0.8));
      if (distance(body.shapes[i], body.poses[i].inverse() * viewpoint) == 0.0) {
        body.poses[i].translation() += Vector3(2.0, 0.0, 0.0);
      }
      buffer.draw(body.shapes[i], body.poses[i], i);
    }
    for (int row = 0; row < buffer.grid().rows(); ++row) {
      for (int column = 0; column < buffer.grid().columns(); ++column) {
        const Ray ray{viewpoint, directionOf(buffer, row, column)};
        double nearest = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < body.shapes.size(); ++i) {
          const auto span = intersect(body.shapes[i], transformed(ray, body.poses[i].inverse()));
          if (span) nearest = std::min(nearest, span->enter);
        }
        const auto pixel = buffer.pixel(row, column);
        if (std::isinf(nearest)) {
          EXPECT_TRUE(std::isinf(pixel.depth)) << scene << ": " << row << ", " << column;
        } else {
          EXPECT_NEAR(pixel.depth, nearest, 1e-5) << scene << ": " << row << ", " << column;
          ++shown;
        }
      }
    }
  }
  EXPECT_GT(shown, 10000U);
}

/// Where a capsule's own formulas, without those of where a ray leaves, say that it is entered.
TEST(ZBufferTest, CapsulesAreEnteredWhereTheirLineSpansBegin) {
  Random random(8);
  int met = 0;
  for (int i = 0; i < 200000; ++i) {
    const Capsule capsule{random.uniform(0.01, 0.3),
                          random.chance(0.1) ? 0.0 : random.uniform(0.0, 0.5)};
    const Vector3 origin = random.uniform(0.0, 3.0) * random.direction();
    if (distance(capsule, origin) == 0.0) continue;
    const bool is_along = random.chance(0.01);
    const Vector3 direction = is_along ? Vector3(0.0, 0.0, -1.0) : random.direction();
    const Ray ray{is_along ? Vector3(0.1 * capsule.radius, 0.0, 2.0) : origin, direction};
    const auto span = intersect(capsule, ray);
    const double way = WayToSolid<Capsule>(capsule, ray.origin)(direction);
    ASSERT_EQ(way, span ? span->enter : std::numeric_limits<double>::infinity()) << i;
    met += span ? 1 : 0;
  }
  EXPECT_GT(met, 5000);
}

TEST(ZBufferTest, TheNearerOfTwoIsShownInWhicheverOrderTheyAreDrawn) {
  for (const bool near_first : {true, false}) {
    ZBuffer buffer(kResolution);
    buffer.begin(kOrigin);
    buffer.draw(Sphere{0.2}, placedAt(near_first ? 1.0 : 2.0, 0, 0), near_first ? 1 : 2);
    buffer.draw(Sphere{0.2}, placedAt(near_first ? 2.0 : 1.0, 0, 0), near_first ? 2 : 1);
    for (const std::uint32_t at : drawnIn(buffer)) EXPECT_EQ(buffer.pixelAt(at).shape, 1U);
  }
}

TEST(ZBufferTest, OfTwoAtOnePlaceTheFirstOfTheBodyIsShownInWhicheverOrderTheyAreDrawn) {
  for (const std::uint32_t drawn_first : {1U, 2U}) {
    ZBuffer buffer(kResolution);
    buffer.begin(kOrigin);
    buffer.draw(Box{{0.1, 0.2, 0.2}}, placedAt(1, 0, 0), drawn_first);
    buffer.draw(Box{{0.1, 0.2, 0.2}}, placedAt(1, 0, 0), 3U - drawn_first);
    EXPECT_FALSE(buffer.runs().empty());
    for (const std::uint32_t at : drawnIn(buffer)) EXPECT_EQ(buffer.pixelAt(at).shape, 1U);
  }
}

TEST(ZBufferTest, AShapeAroundTheViewpointIsLeftOut) {
  ZBuffer buffer(kResolution);
  buffer.begin(Vector3(0.1, 0.0, 0.0));
  buffer.draw(Sphere{0.2}, Pose::Identity(), 0);
  buffer.draw(Box{{0.1, 0.1, 0.1}}, Pose::Identity(), 0);
  EXPECT_TRUE(buffer.runs().empty()) << "its surface belongs to the inside";
  buffer.draw(Box{{0.09, 0.1, 0.1}}, Pose::Identity(), 0);
  EXPECT_FALSE(buffer.runs().empty());
}

TEST(ZBufferTest, BeginEmptiesThePicture) {
  ZBuffer buffer(kResolution);
  buffer.begin(kOrigin);
  buffer.draw(Sphere{0.2}, placedAt(1, 0, 0), 0);
  buffer.begin(kOrigin);
  EXPECT_TRUE(buffer.runs().empty());
  for (int row = 0; row < buffer.grid().rows(); ++row) {
    for (int column = 0; column < buffer.grid().columns(); ++column) {
      EXPECT_TRUE(std::isinf(buffer.pixel(row, column).depth));
    }
  }
}

/// A map 4 x 4 m around the origin, from 2 m below to 2 m above.
CuboidMap mapAround() {
  Grid::Config grid;
  grid.origin_x_m = grid.origin_y_m = -2.0;
  grid.size_x_m = grid.size_y_m = 4.0;
  grid.height_min_m = -2.0;
  grid.cell_size_m = 0.05;
  return test::emptyMap(grid);
}

CuboidMap mapWith(const Vector3& place, double height) {
  CuboidMap map = mapAround();
  test::addCuboid(map, *map.grid.cellOf(place), place.z() - 0.5 * height, place.z() + 0.5 * height);
  return map;
}

bool covers(ZBuffer& buffer, const CuboidMap& map) {
  return buffer.cover(map, map.cuboids[0], 0.05);
}

TEST(ZBufferTest, ACuboidBehindOrBesideAllThatIsDrawnCoversNothing) {
  ZBuffer buffer(kResolution);
  buffer.begin(kOrigin);
  EXPECT_FALSE(covers(buffer, mapWith({0.5, 0, 0}, 0.1))) << "nothing is drawn";
  buffer.draw(Sphere{0.2}, placedAt(1, 0, 0), 0);
  EXPECT_TRUE(covers(buffer, mapWith({0.5, 0, 0}, 0.1)));
  EXPECT_FALSE(covers(buffer, mapWith({1.6, 0, 0}, 0.1))) << "behind";
  EXPECT_FALSE(covers(buffer, mapWith({-0.5, 0, 0}, 0.1))) << "the other way";
  EXPECT_FALSE(covers(buffer, mapWith({0.5, 0.5, 0}, 0.1))) << "to the left";
  EXPECT_FALSE(covers(buffer, mapWith({0.5, 0, 0.6}, 0.1))) << "above";
  EXPECT_FALSE(covers(buffer, mapWith({0.5, 0, -0.6}, 0.1))) << "below";
}

/// Wherever a pixel's ray meets the cuboid in front of what is drawn, the pixel is covered.
TEST(ZBufferTest, CoversEveryPixelWhoseRayMeetsTheCuboidInFront) {
  constexpr double kMargin = 0.05;
  Random random(3);
  ZBuffer buffer(kResolution);
  CuboidMap map = mapAround();
  std::size_t covered = 0;
  for (int scene = 0; scene < 400; ++scene) {
    const Vector3 viewpoint = random.point(0.3);
    buffer.begin(viewpoint);
    for (std::uint32_t i = 0; i < 3; ++i) {
      const Vector3 centre = viewpoint + random.uniform(0.6, 2.5) * random.direction();
      buffer.draw(Sphere{0.4}, placedAt(centre.x(), centre.y(), centre.z()), i);
    }
    map.cuboids.clear();
    const double bottom = random.uniform(-1.0, 0.8);
    test::addCuboid(map, *map.grid.cellOf(random.point(1.0)), bottom,
                    bottom + random.uniform(0.02, 1.0));
    const UprightBox box = map.box(map.cuboids[0]);
    if (box.exteriorDistance(viewpoint) < 1e-3) continue;
    buffer.cover(map, map.cuboids[0], kMargin);
    Pose T_fixed_box = Pose::Identity();
    T_fixed_box.translation() = box.center();
    for (const std::uint32_t at : drawnIn(buffer)) {
      const int row = static_cast<int>(at) / buffer.grid().columns();
      const int column = static_cast<int>(at) % buffer.grid().columns();
      const Ray ray{viewpoint, directionOf(buffer, row, column)};
      const auto span = intersect(Box{0.5 * box.sizes()}, transformed(ray, T_fixed_box.inverse()));
      const auto pixel = buffer.pixelAt(at);
      if (!span || span->enter + kMargin + 1e-5 > pixel.depth) continue;
      EXPECT_TRUE(pixel.covered) << scene << ": " << row << ", " << column;
      ++covered;
    }
  }
  EXPECT_GT(covered, 1000U);
}

TEST(ZBufferTest, AllCuboidsTogetherCoverWhatEachCoversAlone) {
  Random random(4);
  ZBuffer together(kResolution), alone(kResolution);
  std::size_t covering_any = 0;
  for (int scene = 0; scene < 60; ++scene) {
    const CuboidMap map = test::randomMap(random, mapAround().grid.config(), 0.3);
    // Among the cuboids, which stand low; every other time mostly outside of the area.
    Vector3 viewpoint = random.point(scene % 2 == 0 ? 0.5 : 3.0);
    viewpoint.z() = random.uniform(-2.0, -1.3);
    for (ZBuffer* buffer : {&together, &alone}) buffer->begin(viewpoint);
    for (std::uint32_t i = 0; i < 3; ++i) {
      const Vector3 centre = viewpoint + random.uniform(0.4, 2.5) * random.direction();
      const Pose pose = placedAt(centre.x(), centre.y(), centre.z());
      for (ZBuffer* buffer : {&together, &alone}) buffer->draw(Sphere{0.3}, pose, i);
    }
    std::vector<std::uint32_t> covering, each;
    together.coverBy(map, 0.05, covering);
    for (std::uint32_t k = 0; k < map.cuboids.size(); ++k) {
      if (alone.cover(map, map.cuboids[k], 0.05)) each.push_back(k);
    }
    EXPECT_EQ(covering, each) << scene;
    covering_any += each.size();
    for (const std::uint32_t at : drawnIn(alone)) {
      EXPECT_EQ(together.pixelAt(at).covered, alone.pixelAt(at).covered) << scene;
    }
  }
  EXPECT_GT(covering_any, 1000U);
}

void sayUnseen(ZBuffer& buffer) {
  for (const std::uint32_t at : drawnIn(buffer)) {
    buffer.editShown()[at].sight = ZBuffer::Sight::kUnseen;
  }
}

void expectSamePicture(const ZBuffer& one, const ZBuffer& other, int scene) {
  ASSERT_EQ(drawnIn(one).size(), drawnIn(other).size()) << scene;
  for (std::uint32_t at = 0; at < one.grid().pixels(); ++at) {
    const ZBuffer::Pixel a = one.pixelAt(at), b = other.pixelAt(at);
    ASSERT_EQ(a.depth, b.depth) << scene << ": " << at;
    if (std::isinf(a.depth)) continue;
    ASSERT_EQ(a.shape, b.shape) << scene << ": " << at;
    ASSERT_EQ(a.sight, b.sight) << scene << ": " << at;
    ASSERT_EQ(a.covered, b.covered) << scene << ": " << at;
  }
}

/// Six shapes; some stand under the viewpoint, as a body does under a head, and fill whole rows.
std::vector<PlacedShape> randomBody(Random& random, const Vector3& viewpoint) {
  std::vector<PlacedShape> body;
  for (std::size_t i = 0; i < 6; ++i) {
    body.push_back({random.shape(i % test::kShapeKinds), random.pose(0.8)});
    body.back().pose.translation() += viewpoint;
    if (!random.chance(0.3)) continue;
    body.back().pose.translation() = viewpoint - Vector3(0.0, 0.0, random.uniform(0.3, 1.0));
  }
  return body;
}

/// A picture of shapes some of which moved.
TEST(ZBufferTest, WhatIsDrawnAnewAfterSomeWasTakenBackIsAsIfDrawnAlone) {
  Random random(5);
  ZBuffer again(kResolution), alone(kResolution);
  const CuboidMap map = test::randomMap(random, mapAround().grid.config(), 0.3);
  std::size_t covering = 0;
  for (int scene = 0; scene < 100; ++scene) {
    Vector3 viewpoint = random.point(0.5);
    viewpoint.z() = random.uniform(-2.0, -1.3);  // among the cuboids, which stand low
    std::vector<PlacedShape> body = randomBody(random, viewpoint);
    const auto draw = [&](ZBuffer& buffer, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        buffer.draw(body[i].shape, body[i].pose, static_cast<std::uint32_t>(i));
      }
    };
    const auto same = static_cast<std::size_t>(random.integer(0, 6));
    again.begin(viewpoint);
    draw(again, 0, same);
    sayUnseen(again);
    const ZBuffer::Mark mark = again.mark();
    draw(again, same, 6);
    std::vector<std::uint32_t> cuboids;
    again.coverBy(map, 0.05, cuboids);
    covering += cuboids.size();
    const std::vector<PlacedShape> moved = randomBody(random, viewpoint);
    std::copy(moved.begin() + static_cast<std::ptrdiff_t>(same), moved.end(),
              body.begin() + static_cast<std::ptrdiff_t>(same));
    again.takeBack(mark);
    draw(again, same, 6);
    alone.begin(viewpoint);
    draw(alone, 0, same);
    sayUnseen(alone);
    draw(alone, same, 6);
    expectSamePicture(again, alone, scene);
  }
  EXPECT_GT(covering, 100U);
}

TEST(ZBufferTest, InWhicheverOrderItIsDrawnAPictureShowsTheSame) {
  Random random(6);
  ZBuffer one(kResolution), other(kResolution);
  for (int scene = 0; scene < 100; ++scene) {
    for (ZBuffer* buffer : {&one, &other}) buffer->begin(kOrigin);
    const std::vector<PlacedShape> body = randomBody(random, kOrigin);
    for (std::uint32_t i = 0; i < 6; ++i) {
      one.draw(body[i].shape, body[i].pose, i);
      other.draw(body[5 - i].shape, body[5 - i].pose, 5 - i);
    }
    expectSamePicture(one, other, scene);
  }
}

TEST(ZBufferTest, ACuboidAtTheSeamCoversBothEndsOfThePicture) {
  ZBuffer buffer(kResolution);
  buffer.begin(kOrigin);
  buffer.draw(Sphere{0.5}, placedAt(-1.5, 0, 0), 0);
  const CuboidMap map = mapWith({-0.5, 0.0, 0.0}, 0.5);
  CuboidMap both = map;
  test::addCuboid(both, *map.grid.cellOf({-0.5, -0.01, 0.0}), -0.25, 0.25);
  for (const Cuboid& cuboid : both.cuboids) EXPECT_TRUE(buffer.cover(both, cuboid, 0.05));
  const int middle = buffer.grid().rows() / 2;
  EXPECT_TRUE(buffer.pixel(middle, 0).covered);
  EXPECT_TRUE(buffer.pixel(middle, buffer.grid().columns() - 1).covered);
  EXPECT_FALSE(buffer.pixel(middle, buffer.grid().columns() / 2).covered);
}

TEST(ZBufferTest, ACuboidRightBelowCoversWhatLiesUnderIt) {
  ZBuffer buffer(kResolution);
  const Vector3 viewpoint(0.025, 0.025, 0.0);
  buffer.begin(viewpoint);
  buffer.draw(Sphere{0.2}, placedAt(0.025, 0.025, -1.5), 0);
  const CuboidMap map = mapWith({0.025, 0.025, -0.5}, 0.1);
  EXPECT_TRUE(covers(buffer, map));
  for (int column = 0; column < buffer.grid().columns(); ++column) {
    EXPECT_TRUE(buffer.pixel(0, column).covered) << column;
  }
}

}  // namespace
}  // namespace tccm
