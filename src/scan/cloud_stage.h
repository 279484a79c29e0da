#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "scan/cloud.h"
#include "scan/cloud_body_filter.h"
#include "scan/cloud_filters.h"
#include "scan/cloud_looks.h"
#include "scan/filtered_robot.h"
#include "scan/range_noise.h"
#include "sight/look.h"

namespace tccm {

/// The first step of the way for a camera or a lidar, as ScanStage is for a laser: from a cloud and
/// where the sensor and the robot were to what the map takes of it. What is filtered out is not in
/// the map, and not free.
class CloudStage {
 public:
  struct Config {
    bool self_filter = true;
    BodySampler::Config body;
    BodyFilter body_filter;
    CloudLimits limits;
    double range_min_m = 0.3;
    double range_max_m = 5.0;
    RangeNoise noise;
    Thinning thinning;
    FlyingPixelFilter flying;
    SupportFilter::Config support;
    CloudLooks::Config looks;
    double unknown_fraction_max = 0.95;
    double future_max_s = 0.1;

    void describe(ParameterTable& table);
    /// @throws ConfigError
    void validate() const;
  };

  /// @param model of the robot to be filtered out; may be nothing. @throws ConfigError
  CloudStage(const Config& config, std::shared_ptr<const RobotModel> model);

  [[nodiscard]] const BodySampler* body() const { return robot_.body(); }
  [[nodiscard]] const JointStates* joints() const { return robot_.joints(); }
  /// A joint state that is stamped in the future is dropped. @return whether it was taken.
  bool addJoints(Time now, Time stamp, const std::vector<std::string>& names,
                 const std::vector<double>& positions, const std::vector<double>& velocities);
  /// As FilteredRobot's.
  std::vector<std::string> hold(const std::vector<AttachedObject>& objects) {
    return robot_.hold(objects);
  }
  void reset() { robot_.reset(); }

  /// Each point is placed with the sensor's pose at its own time, to 0.25 ms.
  /// @param T_fixed_sensor the sensor's poses, covering the cloud from first to last point.
  /// @param T_fixed_roots one for each of the model's roots, where a robot is filtered out.
  /// @return empty, or why the cloud must be dropped: no_transform, no_joint_states, blind.
  [[nodiscard]] std::string assemble(const Cloud& cloud, const PosePath& T_fixed_sensor,
                                     const std::vector<PosePath>& T_fixed_roots);
  /// What the map takes of the last cloud. A cloud has no tilt.
  [[nodiscard]] const ScanReturns& returns() const { return returns_; }
  /// How many of its points were of each kind.
  [[nodiscard]] const BeamCounts& counts() const { return counts_; }
  /// Of each of its points, in the cloud's order.
  [[nodiscard]] const std::vector<BeamKind>& kinds() const { return state_.kinds; }
  [[nodiscard]] const std::string& selfLink() const { return robot_.mostCounted(); }

 private:
  void sortRows(const Cloud& cloud, std::size_t end);
  /// Once all rows are sorted.
  [[nodiscard]] bool isBlind(const Cloud& cloud) const;
  [[nodiscard]] bool place(const Cloud& cloud, const PosePath& T_fixed_sensor);
  [[nodiscard]] std::size_t placeOf(const Cloud& cloud, std::size_t i) const;
  void begin(const Cloud& cloud);
  template <typename PlaceOf>
  void filterRow(const Cloud& cloud, std::size_t row, const PlaceOf& place_of);
  template <typename PlaceOf>
  void takeRow(const Cloud& cloud, std::size_t row, const PlaceOf& place_of);
  template <typename PlaceOf>
  void takeRows(const Cloud& cloud, const PlaceOf& place_of);

  Config config_;
  FilteredRobot robot_;
  SupportFilter support_;
  CloudBodyFilter body_filter_;
  CloudLooks looks_;
  CloudState state_;
  std::size_t sorted_rows_ = 0;
  std::size_t within_ = 0;          ///< points in them within the limits of range
  std::vector<CloudPlace> places_;  ///< at equal steps of time
  ScanReturns returns_;
  BeamCounts counts_{};
};

}  // namespace tccm
