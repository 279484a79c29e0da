#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tccm_monitor/check/pose_check.h"
#include "tccm_monitor/check/verdict.h"
#include "tccm_monitor/robot/joint_states.h"

namespace tccm {

/// Turns the newest map, joint states and root pose into a verdict, whenever it is asked and
/// whatever is missing.
class Checker {
 public:
  struct Config {
    std::string fixed_frame = "?";  ///< for what is told to people
    PoseCheck::Config pose;
    JointStates::Config joints;
    double horizon_s = 0.5;  ///< how far ahead the second pose lies (paper, section VI.B)
    double joint_timeout_s = 0.1;
    double transform_timeout_s = 0.5;     ///< age of the root's pose
    double scan_timeout_periods = 3.0;    ///< without a new map, in measured scan periods
    double map_age_max_s = 0.5;           ///< from the newest scan's stamp to the check
    double future_max_s = 0.1;            ///< a stamp may lead the check by this much
    double transform_future_max_s = 0.5;  ///< the same of a transform; many publishers date ahead
    /// Clear for so long before a stop is released; never less than the map's window.
    double release_s = 0.0;

    /// @throws ConfigError
    void validate() const;
  };

  /// @throws ConfigError
  Checker(std::shared_ptr<const RobotModel> model, const Config& config);

  /// Other limits and checks from the next check on; how joint states are gathered stays.
  /// @throws ConfigError, and nothing changes.
  void reconfigure(const Config& config);
  [[nodiscard]] const Config& config() const { return config_; }

  /// @return what was taken of it.
  JointStates::Added addJoints(Time stamp, const std::vector<std::string>& names,
                               const std::vector<double>& positions,
                               const std::vector<double>& velocities);
  /// One of the model's roots in the fixed frame. One that does not move (the same frame, or
  /// static transforms alone) never grows old.
  /// @param root index into the model's roots().
  void setRootPose(std::size_t root, Time stamp, const Pose& T_fixed_root, bool is_static);
  /// The robot has something else in its hand from now on; an object of the same name is replaced.
  /// @throws ConfigError, and nothing changes.
  void attach(const AttachedObject& object);
  /// @return false where no object has that name.
  bool detach(const std::string& object);
  [[nodiscard]] const std::vector<AttachedObject>& attached() const { return attached_; }
  /// Where a link is in the fixed frame; nothing where the model lacks it, or joints or root are
  /// missing or too old.
  [[nodiscard]] std::optional<Pose> linkPose(Time now, const std::string& link);
  /// Whether the clock that gives `now` stands still, as a player's or simulation's may.
  void setClockStalls(bool stalls) { clock_stalls_ = stalls; }
  void setMap(Time now, std::shared_ptr<const CuboidMap> map);
  /// As at the start: after time has jumped back.
  void reset();

  /// The reference is valid until the next call. @param now not before that of earlier calls.
  const Verdict& check(Time now);

  struct StateAnswer {
    Reason reason = Reason::kInit;  ///< kClear: the pose is free
    std::string detail;
    std::string link;
    PoseFindings findings;
  };
  /// What a controller asks about: the same checks for a pose that the robot is not in. Joints that
  /// are not named are taken where they are; one that the robot does not have, or a position that
  /// is not finite, is answered with kBadQuestion.
  [[nodiscard]] StateAnswer checkState(Time now, const std::vector<std::string>& names,
                                       const std::vector<double>& positions);

  /// With what it holds.
  [[nodiscard]] const RobotModel& model() const { return *model_; }
  [[nodiscard]] std::shared_ptr<const RobotModel> sharedModel() const { return model_; }
  /// Joints that no joint state has named yet.
  [[nodiscard]] std::vector<std::string> missingJoints() const { return joints_.missingJoints(); }
  [[nodiscard]] const CuboidMap* map() const { return map_.get(); }
  [[nodiscard]] const PoseCheck& poseCheckNow() const { return check_now_; }
  [[nodiscard]] const PoseCheck& poseCheckAhead() const { return check_ahead_; }

 private:
  struct Cause {
    Reason reason = Reason::kClear;
    std::string detail;
    std::string link;
  };
  struct RootPose {
    Time stamp;
    bool is_static;
  };
  /// The worst of what is missing, late or unknown; kClear where nothing is.
  [[nodiscard]] Cause inputCause(Time now, const JointSnapshot* joints) const;
  [[nodiscard]] Cause jointsCause(Time now, const JointSnapshot* joints) const;
  [[nodiscard]] Cause rootCause(Time now) const;
  [[nodiscard]] Cause rootCause(Time now, std::size_t root) const;
  [[nodiscard]] bool rootsKnown() const;
  [[nodiscard]] Cause mapCause(Time now) const;
  /// What a pose's findings mean; the reasons are those of the present pose, or of the one ahead.
  [[nodiscard]] Cause findingsCause(const PoseFindings& findings, bool ahead) const;
  [[nodiscard]] bool within(Time now, double seconds) const;
  void lookAhead(const JointSnapshot& joints);
  [[nodiscard]] bool needsRelease(Reason reason) const;
  void decide(const Cause& cause);
  void hold(std::vector<AttachedObject> objects);

  std::shared_ptr<const RobotModel> model_;
  Config config_;
  std::shared_ptr<const RobotModel> bare_model_;  ///< with empty hands
  std::vector<AttachedObject> attached_;
  JointStates joints_;
  Kinematics kinematics_;  ///< for questions
  PoseCheck check_now_;
  PoseCheck check_ahead_;
  PoseCheck check_state_;
  std::shared_ptr<const CuboidMap> map_;
  Time map_arrival_;
  std::optional<double> scan_period_s_;         ///< the mean of the recent ones
  std::optional<Time> started_;                 ///< the first check
  std::vector<std::optional<RootPose>> roots_;  ///< by the model's roots
  std::vector<Pose> T_fixed_roots_;
  bool clock_stalls_ = false;
  std::vector<double> positions_ahead_;
  bool was_known_ = false;         ///< since the start: what is missing before is no stop
  std::optional<Time> last_stop_;  ///< the last check that was not clear, INIT apart
  Verdict verdict_;
};

}  // namespace tccm
