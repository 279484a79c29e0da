#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "scan/scan_assembler.h"
#include "support/random.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using K = BeamKind;

/// The sensor at the origin looks along x at a sphere of radius 0.1 m, 1 m away.
constexpr double kRadius = 0.1;
constexpr double kAway = 1.0;
constexpr double kPadding = 0.02;

Pose at(double x, double y, double z) {
  Pose pose = Pose::Identity();
  pose.translation() = Vector3(x, y, z);
  return pose;
}

Time atSeconds(double seconds) { return Time(fromSeconds(seconds)); }

BodySample sampleOf(const Shape& shape, const Pose& pose, double seconds = 0.0,
                    double padding = kPadding) {
  return {atSeconds(seconds), {{shape}, {pose}, {padding}}};
}

const BodySample kBall = sampleOf(Sphere{kRadius}, at(kAway, 0.0, 0.0));

Beam beamTo(const Vector3& p, double seconds = 0.0) {
  Beam beam;
  beam.stamp = atSeconds(seconds);
  beam.p_fixed = p;
  beam.viewpoint = Vector3::Zero();
  beam.kind = K::kReturn;
  return beam;
}

std::vector<K> kindsOf(const std::vector<BodySample>& samples, std::vector<Beam> beams,
                       const BodyFilter& config = {}) {
  AssembledScan scan;
  scan.beams = std::move(beams);
  config.apply(samples, scan);
  std::vector<K> kinds;
  for (const Beam& beam : scan.beams) kinds.push_back(beam.kind);
  return kinds;
}

K kindOf(const BodySample& sample, const Vector3& p, const BodyFilter& config = {}) {
  return kindsOf({sample}, {beamTo(p)}, config).front();
}

/// Behind the ball, on the beam that passes its centre at `miss` [m].
Vector3 passing(double miss, double range) {
  const double angle = std::asin(miss / kAway);
  return range * Vector3(std::cos(angle), std::sin(angle), 0.0);
}

TEST(BodyFilterTest, PointsInsideAndNearTheBodyAreItsOwn) {
  EXPECT_EQ(kindOf(kBall, {1.0, 0.0, 0.0}), K::kSelf);
  EXPECT_EQ(kindOf(kBall, {0.9, 0.0, 0.0}), K::kSelf);
  EXPECT_EQ(kindOf(kBall, {1.0, 0.119, 0.0}), K::kSelf);
  EXPECT_EQ(kindOf(kBall, {1.0, 0.125, 0.0}), K::kReturn);
}

TEST(BodyFilterTest, NoiseMovesOnesOwnPointsAlongTheBeamAndNotAside) {
  // The beam meets the padded ball from 0.88 m to 1.12 m.
  EXPECT_EQ(kindOf(kBall, {0.831, 0.0, 0.0}), K::kSelf);
  EXPECT_EQ(kindOf(kBall, {0.829, 0.0, 0.0}), K::kReturn);
  EXPECT_EQ(kindOf(kBall, {1.169, 0.0, 0.0}), K::kSelf);
  EXPECT_EQ(kindOf(kBall, {1.171, 0.0, 0.0}), K::kShadow);
  EXPECT_EQ(kindOf(kBall, passing(kRadius + 0.019, 0.95)), K::kSelf);
  EXPECT_EQ(kindOf(kBall, passing(kRadius + 0.021, 0.95)), K::kReturn);
  BodyFilter exact;
  exact.range_tolerance_m = 0.0;
  EXPECT_EQ(kindOf(kBall, {0.881, 0.0, 0.0}, exact), K::kSelf);
  EXPECT_EQ(kindOf(kBall, {0.879, 0.0, 0.0}, exact), K::kReturn);
}

TEST(BodyFilterTest, PointsInFrontOfTheBodyAreKept) {
  EXPECT_EQ(kindOf(kBall, {0.5, 0.0, 0.0}), K::kReturn);
}

TEST(BodyFilterTest, TheShadowReachesItsDepthBehindTheBodyAndNoFurther) {
  // The beam leaves the ball, grown by the grazing radius, at 1.11 m.
  EXPECT_EQ(kindOf(kBall, {1.2, 0.0, 0.0}), K::kShadow);
  EXPECT_EQ(kindOf(kBall, {1.409, 0.0, 0.0}), K::kShadow);
  EXPECT_EQ(kindOf(kBall, {1.411, 0.0, 0.0}), K::kReturn);
}

TEST(BodyFilterTest, ABeamThatGrazesTheEdgeIsShadowedAndOnePastTheGrazingRadiusIsNot) {
  EXPECT_EQ(kindOf(kBall, passing(kRadius + 0.009, 1.25)), K::kShadow);
  EXPECT_EQ(kindOf(kBall, passing(kRadius + 0.011, 1.25)), K::kReturn);
  BodyFilter wide;
  wide.grazing_m = 0.04;
  EXPECT_EQ(kindOf(kBall, passing(kRadius + 0.039, 1.25), wide), K::kShadow);
  EXPECT_EQ(kindOf(kBall, passing(kRadius + 0.041, 1.25), wide), K::kReturn);
}

TEST(BodyFilterTest, ARealObstacleBesideTheHandIsKept) {
  const BodySample hand = sampleOf(Capsule{0.04, 0.06}, at(0.8, 0.0, 0.0));
  EXPECT_EQ(kindOf(hand, {0.8, 0.065, 0.0}), K::kReturn);
  EXPECT_EQ(kindOf(hand, {0.85, 0.07, 0.03}), K::kReturn);
  EXPECT_EQ(kindOf(hand, {0.8, 0.055, 0.0}), K::kSelf);
}

TEST(BodyFilterTest, WithoutToleranceAndShadowOnlyTheBodyItselfIsRemoved) {
  BodyFilter config;
  config.range_tolerance_m = 0.0;
  config.grazing_m = 0.0;
  config.shadow_depth_m = 0.0;
  const BodySample bare = sampleOf(Sphere{kRadius}, at(kAway, 0.0, 0.0), 0.0, 0.0);
  EXPECT_EQ(kindOf(bare, {1.05, 0.0, 0.0}, config), K::kSelf);
  EXPECT_EQ(kindOf(bare, {1.11, 0.0, 0.0}, config), K::kReturn);
}

TEST(BodyFilterTest, APrimitiveThatContainsTheSensorCastsNoShadow) {
  const BodySample housing = sampleOf(Box{{0.05, 0.05, 0.05}}, at(0.0, 0.0, 0.0));
  EXPECT_EQ(kindOf(housing, {0.2, 0.0, 0.0}), K::kReturn);
  EXPECT_EQ(kindOf(housing, {0.06, 0.0, 0.0}), K::kSelf);
}

TEST(BodyFilterTest, OnesOwnPointStaysOnesOwnBehindAnotherPrimitive) {
  const BodySample body{
      atSeconds(0.0),
      {{Sphere{kRadius}, Sphere{kRadius}}, {at(1.0, 0, 0), at(1.3, 0, 0)}, {kPadding, kPadding}}};
  EXPECT_EQ(kindOf(body, {1.2, 0.0, 0.0}), K::kSelf);
}

TEST(BodyFilterTest, EachBeamIsComparedWithTheSampleNearestInTime) {
  const std::vector<BodySample> samples = {sampleOf(Sphere{kRadius}, at(1.0, 0.0, 0.0), 0.0),
                                           sampleOf(Sphere{kRadius}, at(1.0, 1.0, 0.0), 0.010),
                                           sampleOf(Sphere{kRadius}, at(1.0, 2.0, 0.0), 0.020)};
  const Vector3 first(1.0, 0.0, 0.0), second(1.0, 1.0, 0.0), third(1.0, 2.0, 0.0);
  EXPECT_EQ(
      kindsOf(samples, {beamTo(first, 0.004), beamTo(first, 0.006), beamTo(second, 0.006),
                        beamTo(second, 0.014), beamTo(second, 0.016), beamTo(third, 0.016),
                        beamTo(third, 0.1)}),
      (std::vector<K>{K::kSelf, K::kReturn, K::kSelf, K::kSelf, K::kReturn, K::kSelf, K::kSelf}));
  EXPECT_EQ(kindsOf(samples, {beamTo(first, -1.0)}), std::vector<K>{K::kSelf});
}

TEST(BodyFilterTest, EachShapeHasAPaddingOfItsOwn) {
  const BodySample body{atSeconds(0.0),
                        {{Sphere{kRadius}, Sphere{kRadius}},
                         {at(kAway, 0.0, 0.0), at(kAway, 1.0, 0.0)},
                         {0.01, 0.2}}};
  BodyFilter exact;
  exact.range_tolerance_m = 0.0;
  EXPECT_EQ(kindOf(body, {0.895, 0.0, 0.0}, exact), K::kSelf);
  EXPECT_EQ(kindOf(body, {0.885, 0.0, 0.0}, exact), K::kReturn);
  EXPECT_EQ(kindOf(body, {0.885, 1.0, 0.0}, exact), K::kSelf);
  EXPECT_EQ(kindOf(body, {0.680, 1.0, 0.0}, exact), K::kReturn);
}

TEST(BodyFilterTest, NoSamplesLeaveTheScanAsItIs) {
  EXPECT_EQ(kindsOf({}, {beamTo({1.0, 0.0, 0.0})}), std::vector<K>{K::kReturn});
}

TEST(BodyFilterTest, OnlyReturnsAreTouched) {
  for (const K kind : {K::kNoReturn, K::kTooClose, K::kUnknown, K::kMixedPixel}) {
    Beam beam = beamTo({1.0, 0.0, 0.0});
    beam.kind = kind;
    EXPECT_EQ(kindsOf({kBall}, {beam}), std::vector<K>{kind});
  }
}

/// From where to where the beam to p meets a shape that is placed, by marching; nowhere: the first
/// is larger.
std::pair<double, double> marched(const Shape& shape, const Pose& T_shape_fixed, const Vector3& p,
                                  double until) {
  std::pair<double, double> span(1e9, -1e9);
  for (double along = 0.0; along <= until; along += 0.0005) {
    if (distance(shape, T_shape_fixed * (p.normalized() * along)) > 0.0) continue;
    span.first = std::min(span.first, along);
    span.second = along;
  }
  return span;
}

/// Inside or near by distance; its own along the beam and shadowed by marching.
K byMarching(const Shape& shape, const Pose& pose, const Vector3& p, const BodyFilter& config) {
  const Pose T_shape_fixed = pose.inverse();
  if (distance(shape, T_shape_fixed * p) <= kPadding) return K::kSelf;
  if (distance(shape, T_shape_fixed * Vector3::Zero()) == 0.0) return K::kReturn;
  const double range = p.norm();
  const double tolerance = config.range_tolerance_m;
  const auto own = marched(expanded(shape, {1.0, kPadding}), T_shape_fixed, p, range + tolerance);
  if (range >= own.first - tolerance && range <= own.second + tolerance) return K::kSelf;
  const auto grazed = marched(expanded(shape, {1.0, config.grazing_m}), T_shape_fixed, p, range);
  const bool is_behind = grazed.first <= range && range <= grazed.second + config.shadow_depth_m;
  return is_behind ? K::kShadow : K::kReturn;
}

TEST(BodyFilterTest, RandomBodiesAgreeWithMarchingAlongTheBeam) {
  test::Random random(12);
  std::array<int, kBeamKinds> seen{};
  int different = 0;
  for (int i = 0; i < 4000; ++i) {
    const Shape shape = random.shape(static_cast<std::size_t>(random.integer(0, 3)));
    const Pose pose = random.pose(0.6);
    const Vector3 through = pose * random.pointIn(bounds(shape, Pose::Identity()));
    const Vector3 p = random.uniform(0.3, 2.0) * through;
    const K expected = byMarching(shape, pose, p, {});
    const K kind = kindOf(sampleOf(shape, pose), p);
    ++seen[static_cast<std::size_t>(kind)];
    different += kind != expected;  // the march may step over a corner, or stop a step short
  }
  EXPECT_LE(different, 20);
  for (const K kind : {K::kReturn, K::kSelf, K::kShadow}) {
    EXPECT_GT(seen[static_cast<std::size_t>(kind)], 200);
  }
}

TEST(BodyFilterTest, NegativeAndNaNConfigurationsAreRefused) {
  for (const double bad :
       {-0.01, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (double BodyFilter::*key :
         {&BodyFilter::range_tolerance_m, &BodyFilter::grazing_m, &BodyFilter::shadow_depth_m}) {
      BodyFilter config;
      config.*key = bad;
      EXPECT_THROW(validated(config), ConfigError);
    }
  }
}

}  // namespace
}  // namespace tccm
