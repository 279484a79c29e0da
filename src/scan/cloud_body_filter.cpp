#include "scan/cloud_body_filter.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/point_distance.h"

namespace tccm {
namespace {

constexpr int kEdge = 64;  // pixels of 1.4 degrees
constexpr int kTile = 8;
constexpr int kBallsMax = 16;       // for one shape
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

/// std::visit calls through a table, which takes as long as what is called.
template <typename Ask>
auto ask(const Shape& shape, const Ask& ask) {
  if (const auto* box = std::get_if<Box>(&shape)) return ask(*box);
  if (const auto* capsule = std::get_if<Capsule>(&shape)) return ask(*capsule);
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) return ask(*cylinder);
  return ask(*std::get_if<Sphere>(&shape));
}

/// As intersect(), but empty where the ray misses.
LineSpan spanOf(const Shape& shape, const Ray& ray) {
  LineSpan span = ask(shape, [&ray](const auto& solid) { return lineSpan(solid, ray); });
  if (span.empty() || span.leave < 0.0) return LineSpan::none();
  return {std::max(0.0, span.enter), span.leave};
}

}  // namespace

CloudBodyFilter::CloudBodyFilter() : cube_(kEdge), pixels_(cube_.pixels()), noise_(RangeNoise()) {
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
  noise_ = RangeNoise::Floats(noise);
  tolerance_ = static_cast<float>(filter.range_tolerance_m);
  shadow_ = static_cast<float>(filter.shadow_depth_m);
  std::fill(pixels_.begin(), pixels_.end(), Pixel());
  near_ = std::numeric_limits<float>::infinity();
  far_ = -std::numeric_limits<float>::infinity();
  shapes_ = samples.empty() ? 0 : samples.front().body.shapes.size();
  last_ = 0;
  self_counts_.assign(shapes_, 0);
  if (shapes_ == 0) return;
  prepare(samples);
  placeSensor(places);
  for (std::size_t i = 0; i < shapes_; ++i) drawShape(i, samples, places);
}

void CloudBodyFilter::prepare(const std::vector<BodySample>& samples) {
  prepared_.resize(samples.size() * shapes_, Prepared{Sphere{}, Sphere{}, Sphere{}, 0, 0});
  fixed_poses_.resize(samples.size());
  auto prepared = prepared_.begin();
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const Body& body = samples[k].body;
    fixed_poses_[k].assign(body.poses.begin(), body.poses.end());
    for (std::size_t i = 0; i < shapes_; ++i) {
      const double padding = body.paddings_m[i];
      *prepared++ = {body.shapes[i], expanded(body.shapes[i], {1.0, padding}),
                     expanded(body.shapes[i], {1.0, filter_.grazing_m}), padding,
                     boundingRadius(body.shapes[i]) + std::max(padding, 2.0 * filter_.grazing_m)};
    }
  }
}

void CloudBodyFilter::placeSensor(const std::vector<CloudPlace>& places) {
  sensor_poses_.resize(places.size());
  samples_.resize(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    sensor_poses_[i] = places[i].T_fixed_sensor.inverse(Eigen::Isometry);
    samples_[i] = places[i].sample;
  }
  ++drawing_;
  seen_.resize(places.size() * shapes_);
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
  const int balls = std::clamp(static_cast<int>(std::ceil(2.0 * half / std::max(row.radius, 1e-3))),
                               1, kBallsMax);
  const double moved = motionOf(shape, row.half_axis) + kRounding;
  const Pose T_sensor_shape =
      sensor_poses_.front() * samples[places.front().sample].body.poses[shape];
  for (int k = 0; k < balls; ++k) {
    const Vector3 p_shape = ((2.0 * k + 1.0) / balls - 1.0) * row.half_axis;
    drawBall(shape, {T_sensor_shape * p_shape, std::hypot(row.radius, half / balls) + moved});
  }
}

/// How far any place of a shape's axis comes at most from where it is seen first. What lies between
/// its ends moves no further than one of them.
double CloudBodyFilter::motionOf(std::size_t shape, const Vector3& half_axis) const {
  double moved = 0.0;
  for (const double end : {-1.0, 1.0}) {
    const auto seenFrom = [&](std::size_t place) {
      return Vector3(sensor_poses_[place] *
                     (fixed_poses_[samples_[place]][shape] * (end * half_axis)));
    };
    const Vector3 first = seenFrom(0);
    for (std::size_t i = 1; i < samples_.size(); ++i) {
      moved = std::max(moved, (seenFrom(i) - first).squaredNorm());
    }
  }
  return std::sqrt(moved);
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
  near_ = std::min(near_, near);
  far_ = std::max(far_, far);
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

const CloudBodyFilter::Seen& CloudBodyFilter::seenFrom(std::size_t place, std::size_t shape) {
  Seen& seen = seen_[place * shapes_ + shape];
  if (seen.drawing == drawing_) return seen;
  const Pose T_sensor_shape = sensor_poses_[place] * fixed_poses_[samples_[place]][shape];
  seen.drawing = drawing_;
  seen.R_shape_sensor = T_sensor_shape.linear().transpose();
  seen.centre = T_sensor_shape.translation();
  seen.viewpoint = -(seen.R_shape_sensor * seen.centre);
  const Shape& solid = prepared_[samples_[place] * shapes_ + shape].shape;
  seen.holds_sensor = distance(solid, seen.viewpoint) == 0.0;
  return seen;
}

BeamKind CloudBodyFilter::classify(const Eigen::Vector3f& p_sensor, float range,
                                   std::size_t place) {
  const Vector3 p = p_sensor.cast<double>();
  // Mostly it lies on the shape that the point before was taken for.
  if (isWithin(p, place, last_)) return taken(last_);
  const double away = p.norm();
  const Sighted point{
      p, p / away, away,
      std::max(filter_.range_tolerance_m, 5.0 * static_cast<double>(noise_.at(range)))};
  const std::uint64_t shapes = pixels_[cube_.pixelOf(p_sensor)].shapes;
  BeamKind kind = BeamKind::kReturn;
  for (std::size_t begin = 0; begin < shapes_; begin += 64) {
    for (std::uint64_t left = shapes; left != 0; left &= left - 1) {
      const std::size_t i = begin + static_cast<std::size_t>(__builtin_ctzll(left));
      if (i >= shapes_) break;
      const BeamKind by_shape = classify(point, place, i);
      if (by_shape == BeamKind::kSelf) return taken(i);
      if (by_shape == BeamKind::kShadow) kind = by_shape;
    }
  }
  return kind;
}

BeamKind CloudBodyFilter::taken(std::size_t shape) {
  last_ = shape;
  ++self_counts_[shape];
  return BeamKind::kSelf;
}

bool CloudBodyFilter::isWithin(const Vector3& p_sensor, std::size_t place, std::size_t shape) {
  const Seen& seen = seenFrom(place, shape);
  const Prepared& prepared = prepared_[samples_[place] * shapes_ + shape];
  const Vector3 p_shape = seen.viewpoint + seen.R_shape_sensor * p_sensor;
  return ask(prepared.shape, IsWithin{p_shape, prepared.padding});
}

/// One step of BodyFilter::classify, with all that it needs in the shape's frame.
BeamKind CloudBodyFilter::classify(const Sighted& point, std::size_t place, std::size_t shape) {
  const Prepared& prepared = prepared_[samples_[place] * shapes_ + shape];
  const Seen& seen = seenFrom(place, shape);
  const Ray ray_sensor{Vector3::Zero(), point.direction};
  if (squaredDistance(ray_sensor, point.range + point.tolerance, seen.centre) >
      prepared.far * prepared.far) {
    return BeamKind::kReturn;
  }
  if (isWithin(point.p_sensor, place, shape)) return BeamKind::kSelf;
  if (seen.holds_sensor) return BeamKind::kReturn;
  const Ray ray{seen.viewpoint, seen.R_shape_sensor * point.direction};
  const bool is_padded_larger = prepared.padding >= filter_.grazing_m;
  // What passes by the larger passes by the other.
  const LineSpan larger = spanOf(is_padded_larger ? prepared.padded : prepared.grazed, ray);
  if (larger.empty()) return BeamKind::kReturn;
  const LineSpan met = is_padded_larger ? larger : spanOf(prepared.padded, ray);
  if (!met.empty() && point.range >= met.enter - point.tolerance &&
      point.range <= met.leave + point.tolerance) {
    return BeamKind::kSelf;
  }
  const LineSpan span = is_padded_larger ? spanOf(prepared.grazed, ray) : larger;
  const bool is_behind = !span.empty() && point.range >= span.enter &&
                         point.range <= span.leave + filter_.shadow_depth_m;
  return is_behind ? BeamKind::kShadow : BeamKind::kReturn;
}

}  // namespace tccm
