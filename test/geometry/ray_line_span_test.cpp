#include <gtest/gtest.h>

#include "geometry/ray.h"
#include "support/random.h"

namespace tccm {
namespace {

const Ray kAlongX{Vector3(-2.0, 0.0, 0.0), Vector3::UnitX()};
const Ray kAlongZ{Vector3(0.0, 0.0, -2.0), Vector3::UnitZ()};

void expectSpan(const LineSpan& span, double enter, double leave) {
  EXPECT_NEAR(span.enter, enter, 1e-12);
  EXPECT_NEAR(span.leave, leave, 1e-12);
}

TEST(LineSpanTest, ALineThroughTheMiddleIsInsideForTheShapesWholeWidth) {
  expectSpan(lineSpan(Box{{0.1, 0.2, 0.3}}, kAlongX), 1.9, 2.1);
  expectSpan(lineSpan(Box{{0.1, 0.2, 0.3}}, kAlongZ), 1.7, 2.3);
  expectSpan(lineSpan(Cylinder{0.1, 0.3}, kAlongX), 1.9, 2.1);
  expectSpan(lineSpan(Cylinder{0.1, 0.3}, kAlongZ), 1.7, 2.3);
  expectSpan(lineSpan(Capsule{0.1, 0.3}, kAlongX), 1.9, 2.1);
  expectSpan(lineSpan(Capsule{0.1, 0.3}, kAlongZ), 1.6, 2.4);
  expectSpan(lineSpan(Sphere{0.1}, kAlongX), 1.9, 2.1);
}

TEST(LineSpanTest, ALineHasAPartBehindItsOriginToo) {
  expectSpan(lineSpan(Sphere{0.1}, {Vector3(2.0, 0.0, 0.0), Vector3::UnitX()}), -2.1, -1.9);
}

TEST(LineSpanTest, ALineBesideTheShapeHasNone) {
  for (std::size_t kind = 0; kind < test::kShapeKinds; ++kind) {
    const Shape shape = test::Random(1).shape(kind);
    const Ray beside{Vector3(-2.0, 0.5, 0.0), Vector3::UnitX()};
    EXPECT_TRUE(std::visit([&](const auto& s) { return lineSpan(s, beside); }, shape).empty());
  }
}

TEST(LineSpanTest, PartsThatDoNotMeetLeaveNothing) {
  LineSpan span{0.0, 1.0};
  span.meet({0.5, 2.0});
  expectSpan(span, 0.5, 1.0);
  span.meet({1.5, 2.0});
  EXPECT_TRUE(span.empty());
  EXPECT_TRUE(LineSpan::none().empty());
  EXPECT_FALSE(LineSpan{}.empty());
}

/// The middle of a span is inside, points just beyond its ends are outside.
TEST(LineSpanTest, SpansEndAtTheSurfaceOfRandomShapes) {
  for (std::size_t kind = 0; kind < test::kShapeKinds; ++kind) {
    test::Random random(2 + static_cast<unsigned>(kind));
    int met = 0;
    for (int i = 0; i < 2000; ++i) {
      const Shape shape = random.shape(kind);
      const Ray ray{random.point(0.5), random.direction()};
      const LineSpan span = std::visit([&](const auto& s) { return lineSpan(s, ray); }, shape);
      if (span.empty()) continue;
      ++met;
      EXPECT_LT(distance(shape, ray.at(0.5 * (span.enter + span.leave))), 1e-9);
      EXPECT_LT(distance(shape, ray.at(span.enter)), 1e-9);
      EXPECT_LT(distance(shape, ray.at(span.leave)), 1e-9);
      EXPECT_GT(distance(shape, ray.at(span.enter - 1e-3)), 0.0);
      EXPECT_GT(distance(shape, ray.at(span.leave + 1e-3)), 0.0);
    }
    EXPECT_GT(met, 20) << kind;
  }
}

}  // namespace
}  // namespace tccm
