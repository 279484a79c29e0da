#pragma once

#include <memory>
#include <string>
#include <vector>

#include "scan/filtered_robot.h"
#include "scan/scan_assembler.h"
#include "sight/look.h"

namespace tccm {

/// What a beam of that kind says of the space along it.
[[nodiscard]] Seen seenBy(BeamKind kind);

/// The first step of the way: from a scan and where the sensor and the robot were to what the map
/// takes of it. The robot is filtered out, with what it holds.
class ScanStage {
 public:
  struct Config {
    bool self_filter = true;
    BodySampler::Config body;
    ScanAssembler assembler;
    double future_max_s = 0.1;

    void describe(ParameterTable& table);
    /// @throws ConfigError
    void validate() const { body.validate(); }
  };

  /// @param model of the robot to be filtered out; may be nothing. @throws ConfigError
  ScanStage(const Config& config, std::shared_ptr<const RobotModel> model);

  /// Nothing where no robot is filtered out.
  [[nodiscard]] const BodySampler* body() const { return robot_.body(); }
  [[nodiscard]] const JointStates* joints() const { return robot_.joints(); }
  /// A joint state that is stamped in the future is dropped. @return whether it was taken.
  bool addJoints(Time now, Time stamp, const std::vector<std::string>& names,
                 const std::vector<double>& positions, const std::vector<double>& velocities);
  /// What the robot holds from now on; objects that are no good are left out.
  /// @return why, a line for each of those.
  std::vector<std::string> hold(const std::vector<AttachedObject>& objects) {
    return robot_.hold(objects);
  }
  void reset() { robot_.reset(); }

  /// @param T_fixed_sensor the sensor's poses, covering the scan from first to last beam.
  /// @param T_fixed_roots one for each of the model's roots, where a robot is filtered out.
  /// @return empty, or why the scan must be dropped: no_transform, no_joint_states, malformed,
  /// blind.
  [[nodiscard]] std::string assemble(const LaserScan& scan, const PosePath& T_fixed_sensor,
                                     const std::vector<PosePath>& T_fixed_roots);
  /// The last scan, in the fixed frame.
  [[nodiscard]] const AssembledScan& scan() const { return scan_; }
  /// The link that most returns of the last hundred scans or so were taken for; empty where none.
  [[nodiscard]] const std::string& selfLink() const { return robot_.mostCounted(); }

 private:
  Config config_;
  FilteredRobot robot_;
  AssembledScan scan_;
};

/// The map's part of an assembled scan. @param returns reused.
void takeReturns(const AssembledScan& scan, ScanReturns& returns);

}  // namespace tccm
