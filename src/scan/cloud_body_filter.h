#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/direction_cube.h"
#include "geometry/ray.h"
#include "scan/range_noise.h"
#include "scan/scan_assembler.h"
#include "tccm_monitor/laser_scan.h"
#include "tccm_monitor/shape.h"

namespace tccm {

/// Where the sensor was at one time of a cloud, and which sample of the body is nearest to it.
struct CloudPlace {
  Pose T_fixed_sensor = Pose::Identity();
  std::size_t sample = 0;
};

/// The self filter for clouds. The padded body is drawn once a cloud, coarsely, into the sensor's
/// directions; a point is compared with the shapes alone that are drawn where it is, and within
/// their distances. The outcome is that of BodyFilter, which compares each beam with each shape.
class CloudBodyFilter {
 public:
  CloudBodyFilter();

  /// @param samples of the body; empty: nobody is filtered out. @param places of the cloud.
  void draw(const BodyFilter& filter, const RangeNoise& noise,
            const std::vector<BodySample>& samples, const std::vector<CloudPlace>& places);
  /// Whether the point may be one of the robot's, or in its shadow; where not it is a return.
  [[nodiscard]] bool mayMeet(const Eigen::Vector3f& p_sensor, float range) const {
    const float tolerance = toleranceAt(range), beyond = std::max(tolerance, shadow_);
    if (range < near_ - tolerance || range > far_ + beyond) return false;
    const Pixel& pixel = pixels_[cube_.pixelOf(p_sensor)];
    return pixel.shapes != 0 && range >= pixel.near - tolerance && range <= pixel.far + beyond;
  }
  /// kReturn, kSelf or kShadow, as BodyFilter has it with the tolerance of that range.
  /// @param place of those that draw() was told of, by index.
  [[nodiscard]] BeamKind classify(const Eigen::Vector3f& p_sensor, float range, std::size_t place);
  /// How many points were taken for each shape since it was drawn; for any one of those that lie
  /// over each other.
  [[nodiscard]] const std::vector<std::size_t>& selfCounts() const { return self_counts_; }

 private:
  struct Pixel {
    std::uint64_t shapes = 0;  ///< bit k: shape k, k + 64 and so on may be met
    float near = 0.0F;         ///< no shape is nearer [m]
    float far = 0.0F;          ///< nor further
  };
  /// A shape of a sample, and what is asked of it again and again.
  struct Prepared {
    Shape shape, padded, grazed;
    double padding;
    double far;
  };
  /// A shape as it lies before the sensor in one place.
  struct Seen {
    std::uint64_t drawing = 0;  ///< when it was put down; it is once it is asked for
    Eigen::Matrix3d R_shape_sensor;
    Vector3 viewpoint;  ///< in the shape's frame
    Vector3 centre;     ///< of the shape in the sensor's
    bool holds_sensor = false;
  };
  struct Ball {
    Vector3 centre;
    double radius;
  };
  /// A point on its beam.
  struct Sighted {
    Vector3 p_sensor;
    Vector3 direction;
    double range;
    double tolerance;
  };
  /// Five times the noise, as self_filter_range_tolerance_m is to be.
  [[nodiscard]] float toleranceAt(float range) const {
    return std::max(tolerance_, 5.0F * noise_.at(range));
  }
  void prepare(const std::vector<BodySample>& samples);
  void placeSensor(const std::vector<CloudPlace>& places);
  void drawShape(std::size_t shape, const std::vector<BodySample>& samples,
                 const std::vector<CloudPlace>& places);
  [[nodiscard]] double motionOf(std::size_t shape, const Vector3& half_axis) const;
  void drawBall(std::size_t shape, const Ball& ball_sensor);
  [[nodiscard]] const Seen& seenFrom(std::size_t place, std::size_t shape);
  BeamKind taken(std::size_t shape);
  [[nodiscard]] bool isWithin(const Vector3& p_sensor, std::size_t place, std::size_t shape);
  [[nodiscard]] BeamKind classify(const Sighted& point, std::size_t place, std::size_t shape);

  DirectionCube cube_;
  std::vector<Eigen::Vector3f> directions_;       ///< of the pixels
  std::vector<Eigen::Vector3f> tile_directions_;  ///< of squares of pixels
  std::vector<Pixel> pixels_;
  float near_ = 0.0F;  ///< no pixel has a shape that is nearer [m]
  float far_ = 0.0F;   ///< nor further
  BodyFilter filter_;
  RangeNoise::Floats noise_;
  float tolerance_ = 0.0F;
  float shadow_ = 0.0F;
  std::size_t shapes_ = 0;
  std::uint64_t drawing_ = 0;
  std::vector<Prepared> prepared_;              ///< sample by sample
  std::vector<std::vector<Pose>> fixed_poses_;  ///< T_fixed_shape, sample by sample
  std::vector<Pose> sensor_poses_;              ///< T_sensor_fixed of the places
  std::vector<std::size_t> samples_;            ///< of the places
  std::vector<Seen> seen_;                      ///< place by place
  std::size_t last_ = 0;                        ///< the shape that a point was taken for last
  std::vector<std::size_t> self_counts_;
};

}  // namespace tccm
