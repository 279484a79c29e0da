#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "geometry/ray.h"
#include "simulation/simulator.h"
#include "tccm_monitor/laser_scan.h"

namespace tccm::simulation {

/// Knows every beam of a run, and where the robot was: says when a place was really looked at.
class LookOracle {
 public:
  struct Config {
    /// A beam this near to a place looks at it: 2 degrees, half of what scans are apart and a bit.
    double angle_rad = 0.0349066;

    /// @throws ConfigError
    void validate() const;
  };

  /// @throws ConfigError
  LookOracle(const Config& config, std::shared_ptr<const RobotModel> model);

  /// @param sample later than the last one.
  void add(const RobotSample& sample);
  /// @param mapped when the scan was in the map and judged, not before its last beam; scans come in
  /// their order.
  void add(const LaserScan& scan, Time mapped);

  /// A camera's frame, always of the same camera; a look once a robot sample not before its stamp
  /// is known.
  void add(const CloudSensors::Config& camera, Time stamp, Time mapped);

  struct Look {
    Time beam;    ///< when it was measured
    Time mapped;  ///< when its scan was in the map
  };
  /// The first beam after an instant that passes the place, and that the robot itself does not stop
  /// before. Nothing where there is none in what was added so far.
  [[nodiscard]] std::optional<Look> firstLook(Time after, const Vector3& p_fixed) const;
  /// From the robot's nearest shape, as it was at the first sample not before the instant [m].
  [[nodiscard]] double distanceToRobot(Time stamp, const Vector3& p_fixed) const;
  /// The same from one of the model's shapes.
  [[nodiscard]] double distanceTo(Time stamp, std::size_t shape, const Vector3& p_fixed) const;
  /// A shape's point furthest in a direction, at the same sample [fixed frame, m].
  [[nodiscard]] Vector3 furthest(Time stamp, std::size_t shape, const Vector3& direction) const;

 private:
  struct Scan {
    Time stamp;
    double angle_min, angle_increment;  ///< [rad]
    Duration time_increment;
    std::size_t beams;
    Time mapped;
  };
  struct Frame {
    Time stamp;
    Body body;
    std::vector<Pose> link_poses;
  };
  struct Picture {
    Time stamp;
    Time mapped;
  };
  [[nodiscard]] std::optional<Look> firstScan(Time after, const Vector3& p_fixed) const;
  [[nodiscard]] std::optional<Look> firstPicture(Time after, const Vector3& p_fixed) const;
  [[nodiscard]] std::optional<Pose> cameraAt(Time stamp) const;
  [[nodiscard]] bool shows(const Picture& picture, const Vector3& p_fixed) const;
  [[nodiscard]] std::optional<Time> beamOf(const Scan& scan, Time after,
                                           const Vector3& p_fixed) const;
  [[nodiscard]] std::optional<double> azimuthAt(Time stamp, const Vector3& p_fixed) const;
  /// @param angle of a beam in the scan [rad].
  [[nodiscard]] bool looks(Time stamp, double angle, const Vector3& p_fixed) const;
  [[nodiscard]] const Body& bodyAt(Time stamp) const;
  [[nodiscard]] bool robotStops(Time stamp, const Ray& ray, double before_m) const;

  Config config_;
  std::shared_ptr<const RobotModel> model_;
  std::size_t sensor_;  ///< link
  PosePath T_fixed_sensor_;
  std::vector<Scan> scans_;
  std::vector<Frame> frames_;
  DepthCamera::Config camera_;
  std::size_t camera_link_ = 0;
  Pose T_link_camera_ = Pose::Identity();
  std::vector<Picture> pictures_;
};

}  // namespace tccm::simulation
