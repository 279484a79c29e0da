#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tccm_monitor/checker.h"
#include "tccm_monitor/laser_scan.h"

namespace tccm {

class BodySampler;
class Mapper;
struct AssembledScan;
struct Cloud;
struct ScanReturns;

/// The whole way joined, time passed in: scan or cloud -> points -> map -> verdict. What the
/// offline programs drive; the nodelets drive the same stages, with messages between them.
class Monitor {
 public:
  struct Config;  ///< loadMonitor() reads it from a file

  struct ScanOutcome {
    /// Why nothing was mapped: no_transform, no_joint_states, malformed, blind, out_of_order,
    /// bad_viewpoint; empty where the scan is in the map.
    std::string dropped;
    BeamCounts beams{};
    AddedReturns added;
    double assemble_us = 0.0;
    double integrate_us = 0.0;  ///< addition and expiry
    double snapshot_us = 0.0;
  };

  /// @param model nothing: the surroundings are mapped, and nothing is checked.
  /// @throws ConfigError
  Monitor(const Config& config, std::shared_ptr<const RobotModel> model);
  Monitor(Monitor&& other) noexcept;
  ~Monitor();

  [[nodiscard]] bool hasRobot() const;
  /// @pre hasRobot()
  [[nodiscard]] Checker& checker();
  [[nodiscard]] const Checker& checker() const;

  /// To the self filter and to the checker. @param publisher for what is told to people; may be
  /// empty.
  void addJoints(Time now, Time stamp, const std::vector<std::string>& names,
                 const std::vector<double>& positions, const std::vector<double>& velocities,
                 const std::string& publisher = {});
  /// A scan came in, and waits for transforms.
  /// @param sensor here and below: index into the configured sensors.
  void scanArrived(Time now, Time stamp, std::size_t sensor = 0);
  /// A scan that came in will not be handed over. @param report says why.
  void scanDropped(Time now, const ScanReport& report, std::size_t sensor = 0);
  /// @param now when it is processed, by the clock of the stamps.
  /// @param T_fixed_sensor the sensor's poses over the scan. @param T_fixed_roots one for each of
  /// the model's roots, where a robot is filtered out.
  /// @pre the sensor is a laser.
  ScanOutcome addScan(Time now, const LaserScan& scan, const PosePath& T_fixed_sensor,
                      const std::vector<PosePath>& T_fixed_roots, std::size_t sensor = 0);
  /// The same of a camera or lidar. @pre the sensor is one.
  ScanOutcome addCloud(Time now, const Cloud& cloud, const PosePath& T_fixed_sensor,
                       const std::vector<PosePath>& T_fixed_roots, std::size_t sensor = 0);
  /// The robot holds something from now on: it joins the body for filter and check, and what was
  /// seen of it leaves the map, also in scans stamped up to now that are still to come.
  /// @param forget_padding_m what was seen this near to it was the object.
  /// @throws ConfigError where the object's link cannot be placed, or the object is no good; then
  /// nothing has changed. @pre hasRobot()
  void attach(Time now, const AttachedObject& object, double forget_padding_m);
  /// @return false where no object has that name. @pre hasRobot()
  bool detach(const std::string& object);
  /// As at the start: after time has jumped back. Serials go on, and what holds until it is reset.
  void reset();
  [[nodiscard]] std::size_t sensors() const;
  /// A sensor's map after its last scan; none before the first.
  [[nodiscard]] const CuboidMap* map(std::size_t sensor = 0) const;

  // For this package's own reports and pictures.
  /// Nothing where no robot is filtered out.
  [[nodiscard]] const BodySampler* body(std::size_t sensor = 0) const;
  [[nodiscard]] const Mapper& mapper(std::size_t sensor = 0) const;
  /// The last scan that was assembled, also where the mapper dropped it. @pre of a laser.
  [[nodiscard]] const AssembledScan& assembled(std::size_t sensor = 0) const;
  /// The points of the last scan.
  [[nodiscard]] const ScanReturns& returns(std::size_t sensor = 0) const;
  /// What became of each point of the last cloud, in its order. @pre of a camera or lidar.
  [[nodiscard]] const std::vector<BeamKind>& kinds(std::size_t sensor = 0) const;

 private:
  struct Stages;
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// @param config path of a YAML file (docs/parameters.md); empty: all defaults.
/// @param urdf the robot's description itself; empty: the surroundings are mapped, and nothing is
/// checked. @throws ConfigError, also for a key that nothing reads.
[[nodiscard]] Monitor loadMonitor(const std::string& config, const std::string& urdf,
                                  const RobotResources& resources = {});

}  // namespace tccm
