#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "geometry/ray.h"
#include "tccm_monitor/shape.h"

namespace tccm::streams {

using Points = std::vector<Vector3>;

/// What a sensor sees of a table with things on it, scan by scan, again and again.
struct Stream {
  std::string name;
  Vector3 viewpoint;
  double period_s;            ///< from one scan to the next
  std::vector<Points> scans;  ///< returns in the fixed frame, those outside the area among them
  std::vector<double> tilts;  ///< of each scan [rad]; none: clouds, each of which is whole
};

struct Thing {
  Box box;
  Vector3 centre;
};

/// A table 0.7 m high, what stands on it, the floor, and a panel at the area's far end.
inline std::vector<Thing> scene() {
  std::vector<Thing> things = {{Box{{3.0, 3.0, 0.005}}, {0.0, 0.0, 0.01}},
                               {Box{{0.02, 3.0, 0.15}}, {1.45, 0.0, 0.85}},
                               {Box{{0.40, 0.70, 0.015}}, {0.80, 0.0, 0.70}}};
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < 14; ++i) {
    const double height = 0.05 + 0.25 * unit(engine);
    things.push_back(
        {Box{{0.02 + 0.05 * unit(engine), 0.02 + 0.05 * unit(engine), 0.5 * height}},
         {0.50 + 0.6 * unit(engine), -0.6 + 1.2 * unit(engine), 0.715 + 0.5 * height}});
  }
  return things;
}

/// To the nearest thing along the ray; infinite where there is none.
inline double rangeTo(const std::vector<Thing>& things, const Ray& ray) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Thing& thing : things) {
    const auto span = intersect(thing.box, {ray.origin - thing.centre, ray.direction});
    if (span) nearest = std::min(nearest, span->enter);
  }
  return nearest;
}

/// Casts rays into the scene, with 1 cm of noise.
class Caster {
 public:
  explicit Caster(const Vector3& viewpoint) : viewpoint_(viewpoint) {}

  void cast(const Vector3& direction, Points& points) {
    const Ray ray{viewpoint_, direction.normalized()};
    const double range = rangeTo(things_, ray);
    if (range < 10.0) points.push_back(ray.at(range + noise_(engine_)));
  }

 private:
  Vector3 viewpoint_;
  std::vector<Thing> things_ = scene();
  std::mt19937 engine_{2};
  std::normal_distribution<double> noise_{0.0, 0.01};
};

constexpr double kDegree = M_PI / 180.0;

/// A laser 1.515 m high that looks 45 degrees down, +-30, in 56 scans. @param fan_deg that its 666
/// beams cover.
inline Stream tilting(const std::string& name, double fan_deg) {
  constexpr int kScans = 56, kBeams = 666;
  Stream stream{name, {0.0, 0.0, 1.515}, 0.028, std::vector<Points>(kScans), {}};
  Caster caster(stream.viewpoint);
  for (int k = 0; k < kScans; ++k) {
    const double phase = 2.0 * M_PI * k / kScans;
    stream.tilts.push_back(kDegree * (45.0 + 30.0 * std::sin(phase)));
    const Eigen::AngleAxisd down(stream.tilts.back(), Vector3::UnitY());
    for (int i = 0; i < kBeams; ++i) {
      const double angle = kDegree * fan_deg * (static_cast<double>(i) / (kBeams - 1) - 0.5);
      caster.cast(down * Vector3(std::cos(angle), std::sin(angle), 0.0),
                  stream.scans[static_cast<std::size_t>(k)]);
    }
  }
  return stream;
}

/// 64 rows over 45 degrees, 1,024 columns around, 0.3 m over the table.
inline Stream lidar() {
  Stream stream{"lidar, 64 x 1024", {0.0, 0.0, 1.0}, 0.1, std::vector<Points>(4), {}};
  Caster caster(stream.viewpoint);
  for (Points& points : stream.scans) {
    for (int column = 0; column < 1024; ++column) {
      for (int row = 0; row < 64; ++row) {
        const double up = kDegree * (-22.5 + 45.0 / 63.0 * row);
        const double around = 2.0 * M_PI * column / 1024;
        caster.cast(
            {std::cos(up) * std::cos(around), std::cos(up) * std::sin(around), std::sin(up)},
            points);
      }
    }
  }
  return stream;
}

/// 640 x 480 pixels, 75 by 62 degrees, 1.5 m high and 45 degrees down.
inline Stream camera() {
  Stream stream{
      "depth camera, 640 x 480", {-0.1, 0.0, 1.5}, 1.0 / 30.0, std::vector<Points>(4), {}};
  Caster caster(stream.viewpoint);
  const Eigen::AngleAxisd down(kDegree * 45.0, Vector3::UnitY());
  for (Points& points : stream.scans) {
    for (int row = 0; row < 480; ++row) {
      for (int column = 0; column < 640; ++column) {
        const double across = std::tan(kDegree * 37.5) * ((column + 0.5) / 320.0 - 1.0);
        const double below = std::tan(kDegree * 31.0) * ((row + 0.5) / 240.0 - 1.0);
        caster.cast(down * Vector3(1.0, -across, -below), points);
      }
    }
  }
  return stream;
}

}  // namespace tccm::streams
