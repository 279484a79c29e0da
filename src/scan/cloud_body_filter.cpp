#include "scan/cloud_body_filter.h"

#include <algorithm>
#include <cmath>

namespace tccm {
namespace {

constexpr int kEdge = 64;  // pixels of 1.4 degrees
constexpr int kTile = 8;
constexpr int kBallsMax = 8;        // for one shape
constexpr double kRounding = 1e-4;  // [m], [rad]: points come as floats

/// A shape as a row of balls along its longest axis that contain it.
struct Row {
  Vector3 half_axis;  ///< from its middle to its end
  double radius;      ///< of what is across
};

Row rowOf(const Shape& shape) {
  if (const auto* box = std::get_if<Box>(&shape)) {
    int longest = 0;
    box->half_extents.maxCoeff(&longest);
    Vector3 along = Vector3::Zero(), across = box->half_extents;
    along[longest] = across[longest];
    across[longest] = 0.0;
    return {along, across.norm()};
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    return {Vector3(0.0, 0.0, cylinder->half_length), cylinder->radius};
  }
  if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    return {Vector3(0.0, 0.0, capsule->half_length + capsule->radius), capsule->radius};
  }
  return {Vector3::Zero(), std::get<Sphere>(shape).radius};
}

/// Squared distance from p to the ray's part up to length.
double squaredDistance(const Ray& ray, double length, const Vector3& p) {
  const double along = std::clamp((p - ray.origin).dot(ray.direction), 0.0, length);
  return (ray.at(along) - p).squaredNorm();
}

}  // namespace

CloudBodyFilter::CloudBodyFilter() : cube_(kEdge), pixels_(cube_.pixels()) {
  directions_.resize(cube_.pixels());
  for (int face = 0; face < 6; ++face) {
    for (int row = 0; row < kEdge; ++row) {
      for (int column = 0; column < kEdge; ++column) {
        directions_[cube_.index(face, row, column)] = cube_.direction(
            face, static_cast<float>(row) + 0.5F, static_cast<float>(column) + 0.5F);
      }
    }
    for (int row = 0; row < kEdge; row += kTile) {
      for (int column = 0; column < kEdge; column += kTile) {
        tile_directions_.push_back(cube_.direction(face, static_cast<float>(row) + 0.5F * kTile,
                                                   static_cast<float>(column) + 0.5F * kTile));
      }
    }
  }
}

void CloudBodyFilter::draw(const BodyFilter& filter, const RangeNoise& noise,
                           const std::vector<BodySample>& samples,
                           const std::vector<CloudPlace>& places) {
  filter_ = filter;
  noise_ = noise;
  shadow_ = static_cast<float>(filter.shadow_depth_m);
  std::fill(pixels_.begin(), pixels_.end(), Pixel());
  shapes_ = samples.empty() ? 0 : samples.front().body.shapes.size();
  self_counts_.assign(shapes_, 0);
  prepare(samples);
  for (std::size_t i = 0; i < shapes_; ++i) drawShape(i, samples, places);
}

void CloudBodyFilter::prepare(const std::vector<BodySample>& samples) {
  prepared_.resize(samples.size() * shapes_, Prepared{Sphere{}, Sphere{}, Sphere{}, {}, {}, 0, 0});
  auto prepared = prepared_.begin();
  for (const BodySample& sample : samples) {
    const Body& body = sample.body;
    for (std::size_t i = 0; i < shapes_; ++i) {
      const double padding = body.paddings_m[i];
      *prepared++ = {body.shapes[i],
                     expanded(body.shapes[i], {1.0, padding}),
                     expanded(body.shapes[i], {1.0, filter_.grazing_m}),
                     body.poses[i].inverse(),
                     body.poses[i].translation(),
                     padding,
                     boundingRadius(body.shapes[i]) + std::max(padding, 2.0 * filter_.grazing_m)};
    }
  }
}

/// Over all places at once: balls that contain the shape wherever it is seen from.
void CloudBodyFilter::drawShape(std::size_t shape, const std::vector<BodySample>& samples,
                                const std::vector<CloudPlace>& places) {
  double padding = filter_.grazing_m;
  for (const BodySample& sample : samples) {
    padding = std::max(padding, sample.body.paddings_m[shape]);
  }
  const Row row = rowOf(expanded(samples.front().body.shapes[shape], {1.0, padding}));
  const double half = row.half_axis.norm();
  const int balls =
      std::clamp(static_cast<int>(std::ceil(half / std::max(row.radius, 1e-3))), 1, kBallsMax);
  for (int k = 0; k < balls; ++k) {
    const Vector3 p_shape = ((2.0 * k + 1.0) / balls - 1.0) * row.half_axis;
    Ball ball{Vector3::Zero(), std::hypot(row.radius, half / balls)};
    double moved = 0.0;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Pose& T_fixed_shape = samples[places[i].sample].body.poses[shape];
      const Vector3 seen =
          places[i].T_fixed_sensor.inverse(Eigen::Isometry) * (T_fixed_shape * p_shape);
      if (i == 0) ball.centre = seen;
      moved = std::max(moved, (seen - ball.centre).norm());
    }
    ball.radius += moved + kRounding;
    drawBall(shape, ball);
  }
}

void CloudBodyFilter::drawBall(std::size_t shape, const Ball& ball) {
  const double away = ball.centre.norm();
  const double angle = away > ball.radius ? std::asin(ball.radius / away) : M_PI;
  const auto cosine = [angle](double more) {
    return static_cast<float>(std::cos(std::min(M_PI, angle + more + kRounding)) - 1e-6);
  };
  const float in_tile = cosine(cube_.halfDiagonal(kTile));
  const float in_pixel = cosine(cube_.halfDiagonal(1));
  const Eigen::Vector3f towards =
      away > 0.0 ? Eigen::Vector3f((ball.centre / away).cast<float>()) : Eigen::Vector3f::UnitX();
  const auto near = static_cast<float>(away - ball.radius);
  const auto far = static_cast<float>(away + ball.radius);
  std::size_t tile = 0;
  for (int face = 0; face < 6; ++face) {
    for (int row = 0; row < kEdge; row += kTile) {
      for (int column = 0; column < kEdge; column += kTile) {
        if (tile_directions_[tile++].dot(towards) < in_tile) continue;
        for (int k = 0; k < kTile * kTile; ++k) {
          const std::size_t i = cube_.index(face, row + k / kTile, column + k % kTile);
          if (directions_[i].dot(towards) < in_pixel) continue;
          Pixel& pixel = pixels_[i];
          pixel.near = pixel.shapes ? std::min(pixel.near, near) : near;
          pixel.far = std::max(pixel.far, far);
          pixel.shapes |= 1ULL << (shape % 64);
        }
      }
    }
  }
}

BeamKind CloudBodyFilter::classify(const Eigen::Vector3f& p_sensor, float range,
                                   const CloudPlace& place) {
  const std::uint64_t shapes = pixels_[cube_.pixelOf(p_sensor)].shapes;
  const Vector3 viewpoint = place.T_fixed_sensor.translation();
  const Vector3 p_fixed = place.T_fixed_sensor * p_sensor.cast<double>();
  const Vector3 sight = p_fixed - viewpoint;
  const double length = sight.norm();
  const Ray ray{viewpoint, sight / length};
  const auto tolerance =
      std::max(filter_.range_tolerance_m, 5.0 * static_cast<double>(noise_.at(range)));
  const Prepared* prepared = &prepared_[place.sample * shapes_];
  BeamKind kind = BeamKind::kReturn;
  for (std::size_t i = 0; i < shapes_; ++i) {
    if ((shapes >> (i % 64) & 1) == 0) continue;
    const BeamKind by_shape = classify(prepared[i], ray, p_fixed, length, tolerance);
    if (by_shape == BeamKind::kSelf) {
      ++self_counts_[i];
      return by_shape;
    }
    if (by_shape == BeamKind::kShadow) kind = by_shape;
  }
  return kind;
}

/// One step of BodyFilter::classify.
BeamKind CloudBodyFilter::classify(const Prepared& shape, const Ray& ray, const Vector3& p_fixed,
                                   double range, double tolerance) const {
  if (squaredDistance(ray, range + tolerance, shape.centre) > shape.far * shape.far) {
    return BeamKind::kReturn;
  }
  if (distance(shape.shape, shape.T_shape_fixed * p_fixed) <= shape.padding) return BeamKind::kSelf;
  const Ray ray_in_shape = transformed(ray, shape.T_shape_fixed);
  if (distance(shape.shape, ray_in_shape.origin) == 0.0) return BeamKind::kReturn;
  const auto met = intersect(shape.padded, ray_in_shape);
  if (met && range >= met->enter - tolerance && range <= met->leave + tolerance) {
    return BeamKind::kSelf;
  }
  const auto span = intersect(shape.grazed, ray_in_shape);
  const bool is_behind =
      span && range >= span->enter && range <= span->leave + filter_.shadow_depth_m;
  return is_behind ? BeamKind::kShadow : BeamKind::kReturn;
}

}  // namespace tccm
