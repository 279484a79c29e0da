#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "config/parameter_table.h"
#include "tccm_monitor/robot_model.h"
#include "tccm_monitor/time.h"

namespace tccm {

/// What the last joint states say of every variable at once.
struct JointSnapshot {
  Time oldest;                    ///< stamp of the joint heard of least recently
  Time newest;                    ///< stamp of the joint heard of last
  std::vector<double> positions;  ///< [rad] or [m]
  /// Per second: the larger of the reported and the differentiated.
  std::vector<double> velocities;
};

/// Gathers joint states from messages that may each name only some of the joints, and keeps a short
/// past of every joint, so that a pose can be had for the time of a beam.
class JointStates {
 public:
  struct Config {
    double gap_max_s = 0.1;             ///< nothing is interpolated across a longer gap
    double velocity_baseline_s = 0.03;  ///< positions this far apart are differentiated
    std::size_t samples_max = 512;      ///< kept of each joint

    void describe(ParameterTable& table);
  };

  using Added = AddedJoints;

  /// @throws ConfigError
  JointStates(const RobotModel& model, const Config& config);

  /// Joints that the model does not need are passed over. Where a joint's stamps jump back by more
  /// than gap_max_s, time began anew and all that was known is forgotten.
  /// @param velocities may be empty or hold NaN: then positions are differentiated alone.
  Added add(Time stamp, const std::vector<std::string>& names, const std::vector<double>& positions,
            const std::vector<double>& velocities);
  void reset();

  /// In one line, which joint is published elsewhere than the configuration fixes it, by more than
  /// 0.01 rad or m; empty where none is. While there is one, nothing is known of the pose.
  [[nodiscard]] const std::string& contradiction() const { return contradiction_; }
  /// In one line, which joint's velocity was first found missing, or 0 while its position changed;
  /// empty where none was. Its positions are differentiated.
  [[nodiscard]] const std::string& velocityDefect() const { return velocity_defect_; }
  /// All joints never heard of.
  [[nodiscard]] std::vector<std::string> missingJoints() const;
  /// Nothing while a joint is missing. A robot without joints has the stamp of the last message.
  /// The result is valid until the next call.
  [[nodiscard]] const JointSnapshot* latest();
  /// The positions at an instant, interpolated into `positions`.
  /// @return false where a joint has no samples around it, or only such that are too far apart, or
  /// a fixed joint is elsewhere.
  [[nodiscard]] bool at(Time stamp, std::vector<double>& positions) const;
  /// The instant up to which at() can answer; nothing while a joint is missing.
  [[nodiscard]] std::optional<Time> answersUntil() const;

 private:
  struct Sample {
    Time stamp;
    double position = 0.0;
    double velocity = 0.0;  ///< as reported; NaN where it was not
  };
  /// The last samples of one joint, in a ring that is allocated once.
  struct Track {
    std::vector<Sample> ring;
    std::size_t count = 0;
    std::size_t next = 0;
    void add(const Sample& sample);
    /// The k-th newest. @pre k < count
    [[nodiscard]] const Sample& newest(std::size_t k) const {
      return ring[(next + ring.size() - 1 - k) % ring.size()];
    }
  };
  /// From one position to another; of a joint that turns freely the short way.
  [[nodiscard]] double moved(std::size_t joint, double from, double to) const;
  [[nodiscard]] double differentiate(std::size_t joint) const;
  void lookForVelocityDefect(std::size_t joint);
  [[nodiscard]] double velocityOf(std::size_t joint);
  void compareWithFixed(const std::string& name, double position);
  [[nodiscard]] bool interpolate(std::size_t joint, Time stamp, double& position) const;

  Config config_;
  std::unordered_map<std::string, std::size_t> index_;
  std::map<std::string, double> fixed_;
  std::string contradicting_joint_;
  std::string contradiction_;
  std::string velocity_defect_;
  std::vector<std::string> names_;
  std::vector<bool> turns_freely_;  ///< by joint
  std::vector<Track> tracks_;
  std::optional<Time> last_message_;
  JointSnapshot snapshot_;
};

}  // namespace tccm
