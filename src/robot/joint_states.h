#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "config/parameter_table.h"
#include "robot/joint_rule.h"
#include "robot/joint_track.h"
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
  /// The same, but for joints whose reported and differentiated velocities differ in direction:
  /// of these the other. Empty where there is no such joint.
  std::vector<double> contrary_velocities = {};
  /// By variable: it was measured beyond that limit, which does not hold therefore. Empty: all
  /// hold.
  std::vector<bool> beyond_lower = {};
  std::vector<bool> beyond_upper = {};
  std::size_t oldest_joint = 0;  ///< the joint heard of least recently
};

/// Gathers joint states from messages that may each name only some of the joints, and keeps a short
/// past of every joint, so that a pose can be had for the time of a beam.
class JointStates {
 public:
  struct Config {
    double gap_max_s = 0.1;             ///< nothing is interpolated across a longer gap
    double velocity_baseline_s = 0.03;  ///< positions this far apart are differentiated
    double limit_tolerance = 0.2;       ///< [rad], a tenth of it in m
    std::size_t samples_max = 512;      ///< kept of each joint

    void describe(ParameterTable& table);
  };

  using Added = AddedJoints;

  /// @throws ConfigError
  JointStates(const RobotModel& model, const Config& config);

  /// Joints that the model does not need are passed over. Where a joint's stamps jump back by more
  /// than gap_max_s, time began anew and all that was known is forgotten.
  /// A position far beyond a joint's limits is not taken.
  /// @param velocities may be empty or hold NaN: then positions are differentiated alone.
  /// @param publisher for what is told to people; may be empty.
  Added add(Time stamp, const std::vector<std::string>& names, const std::vector<double>& positions,
            const std::vector<double>& velocities, const std::string& publisher = {});
  void reset();

  /// In one line, which joint is published elsewhere than the configuration fixes it, by more than
  /// 0.01 rad or m; empty where none was for two seconds. Meanwhile nothing is known of the pose.
  [[nodiscard]] const std::string& contradiction() const { return contradiction_.text; }
  /// In one line, which joint was said to be at two places at one time: twice in one message, by
  /// two that publish it, or against the rule of a mimic. Empty where none was for two seconds.
  /// Meanwhile nothing is known of the pose.
  [[nodiscard]] const std::string& twoPositions() const { return two_positions_.text; }
  /// In one line, which joint was said to be where or as fast as no such joint is. Empty where none
  /// was for two seconds.
  [[nodiscard]] const std::string& outOfRange() const { return out_of_range_.text; }
  /// In one line, which joint was first measured a little beyond its limits; empty where none was.
  [[nodiscard]] const std::string& limitDefect() const { return limit_defect_; }
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
  /// Something that no healthy robot publishes.
  struct Doubt {
    std::string text;
    Time stamp;  ///< of the message that it was last seen in
  };
  struct Message {
    Time stamp;
    const std::vector<std::string>& names;
    const std::vector<double>& positions;
    const std::vector<double>& velocities;
    std::uint8_t publisher;
  };
  [[nodiscard]] std::uint8_t numberOf(const std::string& publisher);
  /// Whether its stamp lies so far before what is known of one of its joints.
  [[nodiscard]] bool beginsAnew(const Message& message) const;
  /// @return whether it was taken.
  bool addJoint(const Message& message, std::size_t i, std::size_t joint);
  void noteLimits(std::size_t joint, double position);
  void lookForSpeed(std::size_t joint);
  /// Of a position that is not taken because a newer one, or one of the same stamp, is known.
  void lookForSecondPosition(const Message& message, std::size_t i, std::size_t joint);
  void lookForTwoHistories(std::size_t joint);
  void lookForBrokenMimics(const Message& message);
  void contradict(std::size_t joint, const JointSample& one, const JointSample& other, Time stamp);
  [[nodiscard]] std::string placeText(std::size_t joint, const JointSample& sample) const;
  void forgetOldDoubts();
  void lookForVelocityDefect(std::size_t joint);
  /// Fills in one joint of the snapshot.
  void findVelocity(std::size_t joint);
  void compareWithFixed(const std::string& name, double position, Time stamp);

  Config config_;
  std::unordered_map<std::string, std::size_t> index_;
  std::map<std::string, double> fixed_;
  std::string contradicting_joint_;
  std::string velocity_defect_;
  std::string limit_defect_;
  Doubt contradiction_;
  Doubt two_positions_;
  Doubt out_of_range_;
  std::vector<JointRule> rules_;                   ///< by joint
  std::vector<JointTrack> tracks_;                 ///< likewise
  std::vector<bool> beyond_lower_, beyond_upper_;  ///< likewise
  std::vector<MimicRule> mimics_;
  std::vector<std::string> publishers_{""};
  std::optional<Time> last_message_;
  JointSnapshot snapshot_;
  std::vector<double> contrary_;  ///< reused
};

}  // namespace tccm
