#include "simulation/depth_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "geometry/ray.h"

namespace tccm::simulation {
namespace {

using Vector3f = Eigen::Vector3f;

constexpr double kTiny = 1e-9;  // [m] from a plane, so that nothing is divided by 0

/// What a ray meets first, with 1 / depth along it; 0: nothing.
struct Meeting {
  float inverse_depth = 0.0F;
  float facing = 0.0F;
};

/// The nearer root of a surface of the second order, for a camera outside. In w = 1 / depth the
/// ray o + d / w meets it where c w^2 + 2 b w + a = 0. The discriminant b^2 - a c comes in a form
/// of its own (Lagrange's identity), as rounding would take the difference of large numbers.
struct Roots {
  float enter, leave, root;

  Roots(float b, float c, float discriminant)
      : enter((std::sqrt(discriminant) - b) / c),
        leave((-std::sqrt(discriminant) - b) / c),
        root(std::sqrt(discriminant)) {}
};

/// A ball around the origin of its frame, moved along z.
class SolidBall {
 public:
  SolidBall(double radius, const Vector3& p_camera)
      : o_(p_camera.cast<float>()),
        radius_(static_cast<float>(radius)),
        outside_(static_cast<float>(p_camera.squaredNorm() - radius * radius)) {}

  [[nodiscard]] Meeting meet(const Vector3f& d) const {
    const float discriminant = d.squaredNorm() * radius_ * radius_ - o_.cross(d).squaredNorm();
    if (!(discriminant > 0.0F)) return {};
    const Roots roots(o_.dot(d), outside_, discriminant);
    return {roots.enter, roots.root / radius_};
  }

 private:
  Vector3f o_;
  float radius_;
  float outside_;
};

/// The side of a cylinder or capsule, around z.
class Tube {
 public:
  Tube(double radius, const Vector3& p_camera)
      : o_(p_camera.cast<float>()),
        radius_(static_cast<float>(radius)),
        outside_(static_cast<float>(p_camera.head<2>().squaredNorm() - radius * radius)) {}

  /// Negative where it misses.
  [[nodiscard]] float discriminant(const Vector3f& d) const {
    const float across = o_.x() * d.y() - o_.y() * d.x();
    return (d.x() * d.x() + d.y() * d.y()) * radius_ * radius_ - across * across;
  }
  [[nodiscard]] Roots roots(const Vector3f& d, float discriminant) const {
    return {o_.x() * d.x() + o_.y() * d.y(), outside_, discriminant};
  }
  [[nodiscard]] float radius() const { return radius_; }
  [[nodiscard]] float cameraHeight() const { return o_.z(); }

 private:
  Vector3f o_;
  float radius_;
  float outside_;
};

class SolidCylinder {
 public:
  SolidCylinder(const Cylinder& cylinder, const Vector3& p_camera)
      : tube_(cylinder.radius, p_camera), half_(static_cast<float>(cylinder.half_length)) {}

  [[nodiscard]] Meeting meet(const Vector3f& d) const {
    const float discriminant = tube_.discriminant(d);
    if (!(discriminant > 0.0F)) return {};
    const Roots roots = tube_.roots(d, discriminant);
    if (!(roots.enter > 0.0F)) return {};
    const float height = tube_.cameraHeight() * roots.enter + d.z();  // times 1 / depth
    if (std::abs(height) <= half_ * roots.enter) {
      return {roots.enter, roots.root / tube_.radius()};
    }
    const float side = height > 0.0F ? 1.0F : -1.0F;
    const float above = side * tube_.cameraHeight() - half_;
    if (!(above > 0.0F)) return {};
    const float end = -side * d.z() / above;
    if (end > roots.enter || end < roots.leave) return {};
    return {end, std::abs(d.z())};
  }

 private:
  Tube tube_;
  float half_;
};

class SolidCapsule {
 public:
  SolidCapsule(const Capsule& capsule, const Vector3& p_camera)
      : tube_(capsule.radius, p_camera),
        half_(static_cast<float>(capsule.half_length)),
        upper_(capsule.radius, p_camera - capsule.half_length * Vector3::UnitZ()),
        lower_(capsule.radius, p_camera + capsule.half_length * Vector3::UnitZ()) {}

  [[nodiscard]] Meeting meet(const Vector3f& d) const {
    const float discriminant = tube_.discriminant(d);
    if (!(discriminant > 0.0F)) return {};
    const Roots roots = tube_.roots(d, discriminant);
    if (!(roots.enter > 0.0F)) return {};
    const float height = tube_.cameraHeight() * roots.enter + d.z();  // times 1 / depth
    if (std::abs(height) <= half_ * roots.enter) {
      return {roots.enter, roots.root / tube_.radius()};
    }
    return (height > 0.0F ? upper_ : lower_).meet(d);
  }

 private:
  Tube tube_;
  float half_;
  SolidBall upper_, lower_;
};

/// By the rays of geometry/ray.h, for a camera that is within a tube but beyond its ends.
class ExactSolid {
 public:
  ExactSolid(const Shape& shape, const Vector3& p_camera) : shape_(shape), p_camera_(p_camera) {}

  [[nodiscard]] Meeting meet(const Vector3f& d) const {
    const double length = d.cast<double>().norm();
    const Ray ray{p_camera_, d.cast<double>() / length};
    const auto span = intersect(shape_, ray);
    if (!span || !(span->enter > 0.0)) return {};
    constexpr double kBefore = 1e-6;  // [m]: how fast the surface comes nearer says how it stands
    const double cosine = distance(shape_, ray.at(span->enter - kBefore)) / kBefore;
    return {static_cast<float>(length / span->enter), static_cast<float>(length * cosine)};
  }

 private:
  const Shape& shape_;
  Vector3 p_camera_;
};

/// A function that is linear in the pixel.
struct PixelPlane {
  double base, per_column, per_row;

  [[nodiscard]] double atRow(std::size_t row) const {
    return base + per_row * static_cast<double>(row);
  }
};

/// The half spaces that a box is made of, by the 1 / depth at which a ray passes their planes: it
/// is inside where that is below all of `enter` and above all of `leave`.
struct BoxPlanes {
  struct Plane {
    PixelPlane inverse_depth;
    double distance;  ///< of the camera from it [m]
  };
  std::array<Plane, 6> enter, leave;
  std::size_t enters = 0, leaves = 0;

  BoxPlanes(const Box& box, const Pose& T_camera_box, const Pinhole& camera) {
    for (int k = 0; k < 3; ++k) {
      for (const double sign : {-1.0, 1.0}) {
        const Vector3 normal = sign * T_camera_box.linear().col(k);
        const double above = -normal.dot(T_camera_box.translation()) - box.half_extents[k];
        const double distance = above >= 0.0 ? std::max(above, kTiny) : std::min(above, -kTiny);
        const Vector3 slope = -normal / distance;
        const PixelPlane plane = {
            slope.z() - (slope.x() * camera.centreColumn() + slope.y() * camera.centreRow()) /
                            camera.focal_px,
            slope.x() / camera.focal_px, slope.y() / camera.focal_px};
        if (above >= 0.0) {
          enter[enters++] = {plane, distance};
        } else {
          leave[leaves++] = {plane, distance};
        }
      }
    }
    for (std::size_t i = enters; i > 0 && i < 3; ++i) enter[i] = enter[0];
  }

  /// The faces that are turned to the camera, from a pixel on; of less than three one again.
  [[nodiscard]] std::array<DepthImage::Face, 3> faces(std::size_t row, std::size_t column) const {
    std::array<DepthImage::Face, 3> faces;
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const auto& [plane, distance] = enter[i];
      faces[i] = {
          static_cast<float>(plane.atRow(row) + plane.per_column * static_cast<double>(column)),
          static_cast<float>(plane.per_column), static_cast<float>(distance)};
    }
    return faces;
  }
  /// The columns of a row in which the box is, as a range of doubles.
  [[nodiscard]] std::pair<double, double> columnsOf(std::size_t row, double first,
                                                    double last) const {
    const auto keep = [&](double base, double per_column) {  // base + per_column * column >= 0
      if (per_column > 0.0) {
        first = std::max(first, -base / per_column);
      } else if (per_column < 0.0) {
        last = std::min(last, -base / per_column);
      } else if (base < 0.0) {
        last = first - 1.0;
      }
    };
    for (std::size_t i = 0; i < enters; ++i) {
      const PixelPlane& in = enter[i].inverse_depth;
      keep(in.atRow(row) - 1e-6, in.per_column);
      for (std::size_t j = 0; j < leaves; ++j) {
        const PixelPlane& out = leave[j].inverse_depth;
        keep(in.atRow(row) - out.atRow(row), in.per_column - out.per_column);
      }
    }
    return {first, last};
  }
};

/// The pixels around the edges of something, as far as they are ahead of the camera.
struct Outline {
  explicit Outline(const Pinhole& camera) : camera(camera) {}

  void addEdge(const Vector3& from, const Vector3& to) {
    constexpr double kNear = 0.005;  // [m] ahead: what is nearer lies beyond the picture, or inside
    if (from.z() < kNear && to.z() < kNear) return;
    const double u = (kNear - from.z()) / (to.z() - from.z());
    const Vector3 cut = from + u * (to - from);
    add(from.z() < kNear ? cut : from);
    add(to.z() < kNear ? cut : to);
  }
  void add(const Vector3& p_camera) {
    const double column = camera.centreColumn() + camera.focal_px * p_camera.x() / p_camera.z();
    const double row = camera.centreRow() + camera.focal_px * p_camera.y() / p_camera.z();
    left = std::min(left, column);
    right = std::max(right, column);
    top = std::min(top, row);
    bottom = std::max(bottom, row);
  }

  const Pinhole& camera;
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
};

}  // namespace

DepthImage::DepthImage(const Pinhole& camera)
    : camera_(camera),
      inverse_depths_(camera.width * camera.height),
      facings_(camera.width * camera.height),
      targets_(camera.width * camera.height, kNothing) {}

void DepthImage::clear() {
  std::fill(inverse_depths_.begin(), inverse_depths_.end(), 0.0F);
  std::fill(targets_.begin(), targets_.end(), kNothing);
}

/// The pixels that a box may be in.
DepthImage::Rectangle DepthImage::around(const Vector3& half_extents,
                                         const Pose& T_camera_shape) const {
  Outline outline(camera_);
  std::array<Vector3, 8> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector3 sides((i & 1) != 0 ? 1.0 : -1.0, (i & 2) != 0 ? 1.0 : -1.0,
                        (i & 4) != 0 ? 1.0 : -1.0);
    corners[i] = T_camera_shape * half_extents.cwiseProduct(sides);
  }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    for (const std::size_t axis : {1U, 2U, 4U}) {
      if ((i & axis) == 0) outline.addEdge(corners[i], corners[i | axis]);
    }
  }
  const auto clamped = [](double value, std::size_t limit) {
    return static_cast<std::size_t>(std::clamp(value, 0.0, static_cast<double>(limit)));
  };
  return {clamped(outline.left, camera_.width), clamped(outline.right + 2.0, camera_.width),
          clamped(outline.top, camera_.height), clamped(outline.bottom + 2.0, camera_.height)};
}

void DepthImage::draw(std::uint32_t target, const Shape& shape, const Pose& T_camera_shape) {
  const Vector3 p_camera = T_camera_shape.inverse().translation();
  if (distance(shape, p_camera) == 0.0) return;
  if (const auto* box = std::get_if<Box>(&shape)) return drawBox(target, *box, T_camera_shape);
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    return drawEach(target, SolidBall(sphere->radius, p_camera), T_camera_shape,
                    around(Vector3::Constant(sphere->radius), T_camera_shape));
  }
  const auto* capsule = std::get_if<Capsule>(&shape);
  const auto* cylinder = std::get_if<Cylinder>(&shape);
  const double radius = capsule != nullptr ? capsule->radius : cylinder->radius;
  const double half =
      capsule != nullptr ? capsule->half_length + capsule->radius : cylinder->half_length;
  const Rectangle pixels = around({radius, radius, half}, T_camera_shape);
  if (p_camera.head<2>().norm() < radius + 1e-4) {
    drawEach(target, ExactSolid(shape, p_camera), T_camera_shape, pixels);
  } else if (capsule != nullptr) {
    drawEach(target, SolidCapsule(*capsule, p_camera), T_camera_shape, pixels);
  } else {
    drawEach(target, SolidCylinder(*cylinder, p_camera), T_camera_shape, pixels);
  }
}

void DepthImage::drawBox(std::uint32_t target, const Box& box, const Pose& T_camera_box) {
  const BoxPlanes planes(box, T_camera_box, camera_);
  const Rectangle pixels = around(box.half_extents, T_camera_box);
  if (pixels.column_begin >= pixels.column_end) return;
  for (std::size_t row = pixels.row_begin; row < pixels.row_end; ++row) {
    const auto [first, last] = planes.columnsOf(row, static_cast<double>(pixels.column_begin),
                                                static_cast<double>(pixels.column_end - 1));
    if (first > last) continue;
    const auto begin = static_cast<std::size_t>(std::ceil(first));
    const auto end = static_cast<std::size_t>(std::floor(last)) + 1;
    if (begin < end)
      drawRow(target, planes.faces(row, begin), row * camera_.width + begin, end - begin);
  }
}

/// Without a branch, so that several pixels are drawn at once.
void DepthImage::drawRow(std::uint32_t target, const std::array<Face, 3>& faces, std::size_t pixel,
                         std::size_t count) {
  const auto& [a, b, c] = faces;
  float* depths = &inverse_depths_[pixel];
  float* facings = &facings_[pixel];
  std::uint32_t* targets = &targets_[pixel];
  for (int i = 0; i < static_cast<int>(count); ++i) {
    const auto along = static_cast<float>(i);
    const float in_a = a.start + along * a.slope, in_b = b.start + along * b.slope,
                in_c = c.start + along * c.slope;
    const bool a_first = in_a <= in_b;
    const float in_ab = a_first ? in_a : in_b;
    const float distance_ab = a_first ? a.distance : b.distance;
    const bool ab_first = in_ab <= in_c;
    const float in = ab_first ? in_ab : in_c;
    const float facing = in * (ab_first ? distance_ab : c.distance);
    const bool nearer = in > depths[i];
    depths[i] = nearer ? in : depths[i];
    facings[i] = nearer ? facing : facings[i];
    targets[i] = nearer ? target : targets[i];
  }
}

template <typename Solid>
void DepthImage::drawEach(std::uint32_t target, const Solid& solid, const Pose& T_camera_shape,
                          const Rectangle& pixels) {
  const Eigen::Matrix3d R_shape_camera = T_camera_shape.linear().transpose();
  const Vector3f per_column = (R_shape_camera.col(0) / camera_.focal_px).cast<float>();
  for (std::size_t row = pixels.row_begin; row < pixels.row_end; ++row) {
    const double y = (static_cast<double>(row) - camera_.centreRow()) / camera_.focal_px;
    const double x =
        (static_cast<double>(pixels.column_begin) - camera_.centreColumn()) / camera_.focal_px;
    const Vector3f first = (R_shape_camera * Vector3(x, y, 1.0)).cast<float>();
    for (std::size_t column = pixels.column_begin; column < pixels.column_end; ++column) {
      const auto along = static_cast<float>(column - pixels.column_begin);
      const Meeting meeting = solid.meet(first + along * per_column);
      if (meeting.inverse_depth > 0.0F) {
        put(row * camera_.width + column, meeting.inverse_depth, meeting.facing, target);
      }
    }
  }
}

}  // namespace tccm::simulation
