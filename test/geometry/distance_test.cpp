#include "geometry/distance.h"

#include <fcl/narrowphase/distance.h>
#include <gtest/gtest.h>

#include <limits>
#include <sstream>

#include "geometry/overlap.h"
#include "support/fcl_overlap.h"
#include "support/placed.h"
#include "support/random.h"

namespace tccm {
namespace {

using test::centred;
using test::grown;
using test::placedAt;
using test::Random;

constexpr double kExact = 1e-6;      // what distance() promises [m]
constexpr double kRounding = 1e-12;  // [m]

Eigen::Matrix3d turned(double angle, const Vector3& axis) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

struct Pair {
  Shape shape;
  Pose T_fixed_shape;
  UprightBox box;
};

double distance(const Pair& pair) { return distance(pair.shape, pair.T_fixed_shape, pair.box); }

std::string describe(const Pair& pair) {
  std::ostringstream out;
  out.precision(17);
  out << name(pair.shape) << " within " << boundingRadius(pair.shape) << " at\n"
      << pair.T_fixed_shape.matrix() << "\n"
      << pair.box.min().transpose() << " .. " << pair.box.max().transpose();
  return out.str();
}

/// Between the smallest and the largest, each order of magnitude as frequent.
double spread(Random& random, double smallest, double largest) {
  return std::exp(random.uniform(std::log(smallest), std::log(largest)));
}

/// Most of them near enough that both answers are frequent, some up to about 0.3 m apart.
void place(Random& random, Pair& pair) {
  pair.T_fixed_shape.linear() = random.mixedRotation();
  const double reach = (random.chance(0.7) ? 0.5 : 1.0) * boundingRadius(pair.shape) +
                       (random.chance(0.8) ? 0.0 : 0.3);
  pair.T_fixed_shape.translation() = random.pointIn(grown(pair.box, reach));
}

/// Parts of a robot and 20 x 20 mm columns.
Pair randomPair(Random& random, std::size_t kind) {
  const Vector3 half(0.01, 0.01, 0.5 * random.uniform(0.01, 1.0));
  const Vector3 centre = random.point(0.5);
  Pair pair{random.shape(kind), Pose::Identity(), {centre - half, centre + half}};
  place(random, pair);
  return pair;
}

/// Needles, plates and dust: every size from 10 um to 2 m, for shape and box alike.
Pair extremePair(Random& random, std::size_t kind) {
  const auto size = [&] { return spread(random, 5e-6, 1.0); };
  const std::array<Shape, test::kShapeKinds> shapes{Box{{size(), size(), size()}},
                                                    Cylinder{size(), size()},
                                                    Capsule{size(), size()}, Sphere{size()}};
  const Vector3 half(size(), size(), size());
  Pair pair{shapes[kind], Pose::Identity(), {-half, half}};
  place(random, pair);
  return pair;
}

/// The least of a convex function in [low, high], by golden section.
template <typename Function>
double least(double low, double high, const Function& f) {
  constexpr double kRatio = 0.6180339887498949;
  double a = high - kRatio * (high - low), b = low + kRatio * (high - low);
  double at_a = f(a), at_b = f(b);
  double result = std::min(at_a, at_b);
  while (high - low > 1e-8) {
    if (at_a < at_b) {
      high = std::exchange(b, a);
      a = high - kRatio * (high - low);
      at_b = std::exchange(at_a, f(a));
    } else {
      low = std::exchange(a, b);
      b = low + kRatio * (high - low);
      at_a = std::exchange(at_b, f(b));
    }
    result = std::min({result, at_a, at_b});
  }
  return result;
}

/// The least distance of the box's points to the shape: convex in the point, and so in each of its
/// coordinates with the later ones at their best. Never below the truth.
double distanceBySearch(const Pair& pair) {
  const Pose T_shape_fixed = pair.T_fixed_shape.inverse();
  const Vector3 low = pair.box.min(), high = pair.box.max();
  return least(low.x(), high.x(), [&](double x) {
    return least(low.y(), high.y(), [&](double y) {
      return least(low.z(), high.z(), [&](double z) {
        return distance(pair.shape, T_shape_fixed * Vector3(x, y, z));
      });
    });
  });
}

constexpr double kSearched = 1e-7;  // how far above the truth the search may end [m]

void expectAsBySearch(const Pair& pair) {
  const double truth = distanceBySearch(pair);
  const double ours = distance(pair);
  EXPECT_LE(ours, truth + kRounding) << describe(pair);
  EXPECT_GE(ours, truth - kExact - kSearched) << describe(pair);
}

double distanceByFcl(const Pair& pair) {
  const Vector3 size = pair.box.sizes();
  const fcl::CollisionObjectd upright(std::make_shared<fcl::Boxd>(size),
                                      Eigen::Matrix3d::Identity(), pair.box.center());
  const fcl::CollisionObjectd placed(std::visit(test::ToFcl{}, pair.shape),
                                     pair.T_fixed_shape.linear(), pair.T_fixed_shape.translation());
  fcl::DistanceRequestd request;
  request.gjk_solver_type = fcl::GST_LIBCCD;
  fcl::DistanceResultd result;
  return std::max(0.0, fcl::distance(&placed, &upright, request, result));
}

void expectDistance(const Shape& shape, const Pose& pose, const UprightBox& box, double expected) {
  const double ours = distance(shape, pose, box);
  EXPECT_LE(ours, expected + kRounding) << name(shape);
  EXPECT_GE(ours, expected - kExact) << name(shape);
}

/// The values FCL's own tests state.
TEST(DistanceTest, HasTheValuesOfFclsOwnTests) {
  const UprightBox cube = centred(10.0, 10.0, 10.0);
  expectDistance(Box{{10.0, 20.0, 25.0}}, placedAt(15.1, 0.0, 0.0), cube, 0.1);
  expectDistance(Cylinder{5.0, 5.0}, placedAt(10.1, 0.0, 0.0), cube, 0.1);
  expectDistance(Cylinder{5.0, 5.0}, placedAt(0.0, 0.0, 10.1), cube, 0.1);
  const Capsule capsule{2.0, 2.0};
  const UprightBox box = centred(1.0, 2.0, 4.0);
  expectDistance(capsule, placedAt(3.0, 0.0, 0.0), box, 0.5);
  expectDistance(capsule, placedAt(0.0, 0.0, 8.0), box, 2.0);
  expectDistance(capsule, placedAt(-10.0, 0.0, 0.0, turned(0.5 * M_PI, Vector3::UnitY())), box,
                 5.5);
  expectDistance(Sphere{0.7}, placedAt(0.15, 0.3, 1.8 + 0.77), centred(0.6, 1.2, 3.6), 0.07);
}

TEST(DistanceTest, FromCornerToCornerIsPythagoras) {
  const UprightBox cube = centred(2.0, 2.0, 2.0);
  expectDistance(Sphere{1.0}, placedAt(3.0, 4.0, 5.0), cube, std::sqrt(4.0 + 9.0 + 16.0) - 1.0);
  expectDistance(Box{{1.0, 1.0, 1.0}}, placedAt(3.0, 4.0, 8.0), cube, std::sqrt(1.0 + 4.0 + 36.0));
  expectDistance(Capsule{1.0, 1.0}, placedAt(4.0, 5.0, 14.0), cube, 12.0);  // 3, 4, 12: 13 less 1
}

TEST(DistanceTest, CylinderIsNearestWithItsSideItsEndOrItsRim) {
  const UprightBox cube = centred(2.0, 2.0, 2.0);
  const Cylinder cylinder{1.0, 1.0};
  expectDistance(cylinder, placedAt(4.0, 5.0, 0.5), cube, 4.0);  // 3 and 4 to the upright edge
  expectDistance(cylinder, placedAt(0.0, 0.0, 4.0), cube, 2.0);
  expectDistance(cylinder, placedAt(4.0, 0.0, 5.0), cube, std::sqrt(4.0 + 9.0));
  expectDistance(cylinder, placedAt(4.0, 5.0, 5.0), cube, 5.0);  // 4 across, 3 up
}

TEST(DistanceTest, AShapeOnItsEdgeReachesDownByItsDiagonal) {
  const UprightBox cube = centred(2.0, 2.0, 2.0);
  const Eigen::Matrix3d on_edge = turned(0.25 * M_PI, Vector3::UnitX());
  const Eigen::Matrix3d on_corner =
      Eigen::Quaterniond::FromTwoVectors(Vector3::Ones(), Vector3::UnitZ()).toRotationMatrix();
  expectDistance(Box{{1.0, 1.0, 1.0}}, placedAt(0.3, 0.2, 4.0, on_edge), cube,
                 3.0 - std::sqrt(2.0));
  expectDistance(Box{{1.0, 1.0, 1.0}}, placedAt(0.3, 0.2, 4.0, on_corner), cube,
                 3.0 - std::sqrt(3.0));
  expectDistance(Cylinder{1.0, 1.0}, placedAt(0.3, 0.2, 4.0, on_edge), cube, 3.0 - std::sqrt(2.0));
}

/// The nearest points are inside two crossed edges.
TEST(DistanceTest, CrossedEdgesAreAsFarApartAsTheirLines) {
  const Eigen::Matrix3d on_edge = turned(0.25 * M_PI, Vector3::UnitY());
  const Pose pose = placedAt(0.0, 3.0, 3.0, turned(-0.25 * M_PI, Vector3::UnitX()) * on_edge);
  const UprightBox cube = centred(2.0, 2.0, 2.0);
  const double between = std::sqrt(2.0) * 2.0;  // from (0, 1, 1) to the rod's centre
  expectDistance(Box{{0.5, 4.0, 0.5}}, pose, cube, between - std::sqrt(0.5));
}

TEST(DistanceTest, ParallelFacesAreAsFarApartAsTheirPlanes) {
  Random random(11);
  for (int i = 0; i < 10000; ++i) {
    const double gap = spread(random, 1e-9, 0.3);
    const Vector3 half(0.01, 0.01, random.uniform(0.005, 0.5));
    const Vector3 own(random.size(), random.size(), random.size());
    const Pose pose = placedAt(half.x() + own.x() + gap, random.uniform(-0.01, 0.01),
                               random.uniform(-half.z(), half.z()), Eigen::Matrix3d::Identity());
    expectDistance(Box{own}, pose, {-half, half}, gap);
    const Pose over = placedAt(0.005, 0.005, half.z() + own.z() + gap,
                               turned(random.uniform(-3.1, 3.1), Vector3::UnitZ()));
    expectDistance(Box{own}, over, {-half, half}, gap);
    expectDistance(Cylinder{own.x(), own.z()}, over, {-half, half}, gap);
  }
}

TEST(DistanceTest, IsZeroWhereTheyTouch) {
  const UprightBox cube = centred(1.0, 1.0, 1.0);
  EXPECT_EQ(distance(Sphere{0.5}, placedAt(1.0, 0.0, 0.0), cube), 0.0);
  EXPECT_EQ(distance(Capsule{0.5, 0.25}, placedAt(0.0, 0.0, 1.25), cube), 0.0);
  EXPECT_EQ(distance(Box{{0.5, 0.5, 0.5}}, placedAt(1.0, 1.0, 1.0), cube), 0.0);
  EXPECT_EQ(distance(Cylinder{0.5, 0.5}, placedAt(0.0, 0.0, 1.0), cube), 0.0);
  EXPECT_EQ(distance(Cylinder{0.5, 0.5}, placedAt(1.0, 0.0, 0.0), cube), 0.0);
}

TEST(DistanceTest, IsZeroWhereOneIsInsideTheOther) {
  for (std::size_t kind = 0; kind < test::kShapeKinds; ++kind) {
    Random random(3);
    for (int i = 0; i < 1000; ++i) {
      const Shape shape = random.shape(kind);
      const Pose pose = random.pose(i == 0 ? 0.0 : 0.001);
      EXPECT_EQ(distance(shape, pose, centred(2.0, 2.0, 2.0)), 0.0) << name(shape);
      EXPECT_EQ(distance(shape, pose, centred(0.004, 0.004, 0.004)), 0.0) << name(shape);
    }
  }
}

/// Fails closed.
TEST(DistanceTest, IsZeroForAPoseThatIsNotANumber) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const UprightBox far(Vector3(3.0, 3.0, 3.0), Vector3(4.0, 4.0, 4.0));
  for (std::size_t kind = 0; kind < test::kShapeKinds; ++kind) {
    const Shape shape = Random(3).shape(kind);
    for (int i = 0; i < 3; ++i) {
      Pose pose = Pose::Identity();
      pose.translation()[i] = kNan;
      EXPECT_EQ(distance(shape, pose, far), 0.0) << name(shape);
    }
    if (std::holds_alternative<Sphere>(shape)) continue;  // looks the same however it is turned
    Pose pose = Pose::Identity();
    pose.linear().setConstant(kNan);
    EXPECT_EQ(distance(shape, pose, far), 0.0) << name(shape);
  }
}

/// FCL's iterative solver is content with less; where the two differ the search decides.
TEST(DistanceTest, AgreesWithFclOnRandomPairsOfEveryKind) {
  constexpr double kFcl = 1e-5;
  for (std::size_t kind = 0; kind < test::kShapeKinds; ++kind) {
    Random random(100 + static_cast<unsigned>(kind));
    constexpr int kPairs = 25000;
    int apart = 0, differing = 0;
    for (int i = 0; i < kPairs; ++i) {
      const Pair pair = randomPair(random, kind);
      const double ours = distance(pair);
      apart += ours > 0.0;
      if (std::abs(ours - distanceByFcl(pair)) <= kFcl) continue;
      ++differing;
      expectAsBySearch(pair);
    }
    const std::string kind_name = name(random.shape(kind));
    EXPECT_LT(differing, kPairs / 50) << kind_name;
    EXPECT_GT(apart, kPairs / 8) << kind_name;
    EXPECT_LT(apart, kPairs * 7 / 8) << kind_name;
  }
}

TEST(DistanceTest, IsWhatASearchOfTheBoxFinds) {
  for (std::size_t kind = 0; kind < test::kShapeKinds; ++kind) {
    Random random(200 + static_cast<unsigned>(kind));
    for (int i = 0; i < 300; ++i) expectAsBySearch(randomPair(random, kind));
    for (int i = 0; i < 300; ++i) expectAsBySearch(extremePair(random, kind));
  }
}

/// Away from a band of what distance() is exact to.
TEST(DistanceTest, IsZeroWhereTheyOverlapAndNowhereElse) {
  for (std::size_t kind = 0; kind < test::kShapeKinds; ++kind) {
    Random random(300 + static_cast<unsigned>(kind));
    for (int i = 0; i < 100000; ++i) {
      const bool ordinary = random.chance(0.5);
      const Pair pair = ordinary ? randomPair(random, kind) : extremePair(random, kind);
      const double ours = distance(pair);
      ASSERT_TRUE(std::isfinite(ours)) << describe(pair);
      ASSERT_GE(ours, 0.0) << describe(pair);
      if (overlaps(pair.shape, pair.T_fixed_shape, pair.box)) {
        ASSERT_LE(ours, kRounding) << describe(pair);
      } else if (!overlaps(pair.shape, pair.T_fixed_shape, grown(pair.box, kExact))) {
        ASSERT_GT(ours, 0.0) << describe(pair);
      }
    }
  }
}

TEST(DistanceTest, ChangesByNoMoreThanTheShapeMoves) {
  for (std::size_t kind = 0; kind < test::kShapeKinds; ++kind) {
    Random random(400 + static_cast<unsigned>(kind));
    for (int i = 0; i < 50000; ++i) {
      Pair pair = random.chance(0.5) ? randomPair(random, kind) : extremePair(random, kind);
      const double before = distance(pair);
      const double by = spread(random, 1e-7, 0.3);
      pair.T_fixed_shape.translation() += by * random.direction();
      ASSERT_NEAR(distance(pair), before, by + kExact) << describe(pair);
    }
  }
}

TEST(DistanceTest, ItsBoundIsNeverAboveIt) {
  double sum = 0.0, sum_of_bounds = 0.0;
  for (std::size_t kind = 0; kind < test::kShapeKinds; ++kind) {
    Random random(500 + static_cast<unsigned>(kind));
    for (int i = 0; i < 50000; ++i) {
      const Pair pair = random.chance(0.5) ? randomPair(random, kind) : extremePair(random, kind);
      const double bound = distanceBound(bounds(pair.shape, pair.T_fixed_shape), pair.box);
      const double exact = distance(pair);
      ASSERT_LE(bound, exact + kExact) << describe(pair);
      sum += exact;
      sum_of_bounds += bound;
    }
  }
  EXPECT_GT(sum_of_bounds, 0.7 * sum);
}

TEST(DistanceTest, ItsBoundIsThatOfUprightBoxes) {
  const UprightBox cube = centred(2.0, 2.0, 2.0);
  EXPECT_EQ(distanceBound(bounds(Box{{1.0, 1.0, 1.0}}, placedAt(0.0, 5.0, 6.0)), cube), 5.0);
  EXPECT_EQ(distanceBound(bounds(Sphere{1.0}, placedAt(2.0, 0.0, 0.0)), cube), 0.0);
}

/// The same set as two kinds of shape.
TEST(DistanceTest, ShapesWithoutThicknessAreTheirPointSegmentOrRectangle) {
  Random random(13);
  for (int i = 0; i < 50000; ++i) {
    const double length = random.size();
    Pair pair{Capsule{0.0, length}, Pose::Identity(), centred(0.02, 0.02, random.size())};
    place(random, pair);
    const double of_segment = distance(pair);
    pair.shape = Box{{0.0, 0.0, length}};
    ASSERT_NEAR(distance(pair), of_segment, kExact) << describe(pair);
    pair.shape = Cylinder{0.0, length};
    ASSERT_NEAR(distance(pair), of_segment, kExact) << describe(pair);

    const double of_point = pair.box.exteriorDistance(pair.T_fixed_shape.translation());
    for (const Shape& point : {Shape{Sphere{0.0}}, Shape{Capsule{0.0, 0.0}},
                               Shape{Box{Vector3::Zero()}}, Shape{Cylinder{0.0, 0.0}}}) {
      pair.shape = point;
      ASSERT_NEAR(distance(pair), of_point, kExact) << describe(pair);
    }
    for (const Shape& flat :
         {Shape{Box{{0.0, length, random.size()}}}, Shape{Cylinder{length, 0}}}) {
      pair.shape = flat;
      if (i < 200) expectAsBySearch(pair);
    }
  }
}

TEST(CoreTest, IsThePointSegmentOrRectangleInTheMiddle) {
  EXPECT_EQ(std::get<Sphere>(core(Sphere{0.2})).radius, 0.0);
  const auto of_capsule = std::get<Capsule>(core(Capsule{0.2, 0.3}));
  EXPECT_EQ(of_capsule.radius, 0.0);
  EXPECT_EQ(of_capsule.half_length, 0.3);
  const auto of_cylinder = std::get<Capsule>(core(Cylinder{0.2, 0.3}));
  EXPECT_EQ(of_cylinder.radius, 0.0);
  EXPECT_EQ(of_cylinder.half_length, 0.3);
  const auto of_box = std::get<Box>(core(Box{{0.5, 0.25, 1.0}}));
  EXPECT_EQ(of_box.half_extents, Vector3(0.25, 0.0, 0.75));
  EXPECT_EQ(std::get<Box>(core(Box{{0.5, 0.5, 0.5}})).half_extents, Vector3::Zero());
}

TEST(CoreTest, IsNeverNearerThanTheShapeAndTellsHowDeepTheContactIs) {
  Random random(17);
  for (int i = 0; i < 50000; ++i) {
    const Pair pair = randomPair(random, static_cast<std::size_t>(i) % test::kShapeKinds);
    ASSERT_LE(distance(pair), distance(core(pair.shape), pair.T_fixed_shape, pair.box) + kExact);
  }
  const Box plate{{0.3, 0.2, 0.05}};
  const UprightBox cube = centred(0.02, 0.02, 0.02);
  EXPECT_NEAR(distance(core(plate), placedAt(0.0, 0.0, 0.04), cube), 0.03, kExact);
  EXPECT_EQ(distance(core(plate), placedAt(0.0, 0.0, 0.005), cube), 0.0);
}

}  // namespace
}  // namespace tccm
