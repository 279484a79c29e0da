#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "check/check_inputs.h"
#include "check/clearance_check.h"
#include "check/commanded_trajectories.h"
#include "check/evidence_check.h"
#include "check/exemptions.h"
#include "check/governed_speed.h"
#include "check/permission.h"
#include "check/pose_check.h"
#include "check/trajectory_check.h"
#include "check/verdict.h"
#include "check/way_ahead.h"

namespace tccm {

/// Turns the newest map, joint states, root poses and commanded trajectories into a verdict,
/// whenever it is asked and whatever is missing.
class Checker {
 public:
  struct Config {
    PoseCheck::Config pose;
    CheckInputs::Config inputs;
    WayAhead::Config way;
    EvidenceCheck::Config evidence;
    GovernedSpeed::Config governed_speed;
    CommandedTrajectories::Config trajectories;
    Permission::Config permission;
    Exemptions::Config exemptions;
    double clearance_radius_m = 0.2;  ///< 0: clearances are not measured
    double trajectory_step_m = 0.004;
    int trajectory_occlusion_poses = 8;
    bool occlusion_stops = true;  ///< false: a hidden link only slows the robot down
    double occlusion_slow_scale = 0.3;

    /// @throws ConfigError
    void validate() const;
    /// What is old evidence is told once for all.
    [[nodiscard]] PoseCheck::Config poseCheck() const;
    [[nodiscard]] TrajectoryCheck::Config trajectoryCheck() const;
  };

  /// @throws ConfigError, also where the self-test does not find a link.
  Checker(std::shared_ptr<const RobotModel> model, const Config& config);

  /// Other limits and checks from the next check on; how joint states are gathered stays.
  /// @throws ConfigError, and nothing changes.
  void reconfigure(const Config& config);
  [[nodiscard]] const Config& config() const { return config_; }

  [[nodiscard]] CheckInputs& inputs() { return inputs_; }
  [[nodiscard]] const CheckInputs& inputs() const { return inputs_; }
  /// As CheckInputs does.
  JointStates::Added addJoints(Time now, Time stamp, const std::vector<std::string>& names,
                               const std::vector<double>& positions,
                               const std::vector<double>& velocities) {
    return inputs_.addJoints(now, stamp, names, positions, velocities);
  }
  void setRootPose(std::size_t root, Time stamp, const Pose& T_fixed_root, bool is_static) {
    inputs_.setRootPose(root, stamp, T_fixed_root, is_static);
  }
  void setMap(Time now, std::shared_ptr<const CuboidMap> map) {
    inputs_.setMap(now, std::move(map));
  }
  /// What the arms were told to do, see CommandedTrajectories::command().
  std::string command(Time now, const JointTrajectory& trajectory);
  /// How long verdicts take, measured, from the moment when scan and transforms are there to the
  /// publication: margins grow with it.
  void setLatency(double seconds) { latency_s_ = seconds; }
  /// What the caller knows to be wrong or unknown, until it says otherwise; kClear: nothing.
  void setOutsideCause(const Cause& cause) { outside_ = cause; }

  /// The robot has something else in its hand from now on; an object of the same name is replaced.
  /// @throws ConfigError, and nothing changes.
  void attach(const AttachedObject& object);
  /// @return false where no object has that name.
  bool detach(const std::string& object);
  [[nodiscard]] const std::vector<AttachedObject>& attached() const { return attached_; }
  /// @throws ConfigError, and nothing changes.
  void addExemption(Time now, const Exemption& exemption, double duration_s);
  [[nodiscard]] const Exemptions& exemptions() const { return exemptions_; }
  /// Where a link is in the fixed frame; nothing where the model lacks it, or joints or root are
  /// missing or too old.
  [[nodiscard]] std::optional<Pose> linkPose(Time now, const std::string& link);

  /// The reference is valid until the next call. @param now not before that of earlier calls.
  const Verdict& check(Time now);
  /// In place of a check that could not be made, or came to nothing.
  const Verdict& fail(Time now, const Cause& cause);
  /// Lifts what holds until it is reset. @return why not; empty where it is lifted.
  [[nodiscard]] std::string reset() { return permission_.reset(); }
  /// As at the start: after time has jumped back.
  void startAnew();

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
  /// The same of a whole way.
  [[nodiscard]] TrajectoryCheck::Answer checkTrajectory(Time now,
                                                        const JointTrajectory& trajectory);

  /// With what it holds.
  [[nodiscard]] const RobotModel& model() const { return *model_; }
  [[nodiscard]] std::shared_ptr<const RobotModel> sharedModel() const { return model_; }
  /// Joints that no joint state has named yet.
  [[nodiscard]] std::vector<std::string> missingJoints() const {
    return inputs_.jointStates().missingJoints();
  }
  [[nodiscard]] const CuboidMap* map() const { return inputs_.map(); }
  [[nodiscard]] const CommandedTrajectories& commanded() const { return commanded_; }
  [[nodiscard]] const EvidenceCheck& evidence() const { return checks_.evidence; }
  [[nodiscard]] const PoseCheck& poseCheckNow() const { return checks_.now; }
  [[nodiscard]] const PoseCheck& poseCheckAhead() const { return checks_.ahead; }

 private:
  /// Everything that is made for one model and configuration.
  struct Checks {
    PoseCheck now, ahead, state;
    WayAhead way;
    EvidenceCheck evidence;
    GovernedSpeed governed_speed;
    ClearanceCheck clearance;
    TrajectoryCheck trajectory;
    Kinematics kinematics;  ///< for questions

    /// @throws ConfigError, also where the self-test does not find a link.
    Checks(const std::shared_ptr<const RobotModel>& model, const Config& config);
  };
  void hold(std::vector<AttachedObject> objects);
  void exempt();
  /// What the robot does and meets, once it can be placed.
  void look(Time now, const JointSnapshot& joints);
  void judgeContacts(const JointSnapshot& joints);
  void judgeOcclusion();
  void judgeEvidence(Time now);
  void governSpeed(Time now, const JointSnapshot& joints);
  [[nodiscard]] Cause contactCause(Reason reason, Level level, std::uint32_t shape,
                                   const std::string& what) const;
  void add(Cause cause, double speed_scale);
  void decide(Time now);
  void forgetFindings();

  std::shared_ptr<const RobotModel> model_;
  Config config_;
  std::shared_ptr<const RobotModel> bare_model_;  ///< with empty hands
  std::vector<AttachedObject> attached_;
  CheckInputs inputs_;
  CommandedTrajectories commanded_;
  Exemptions exemptions_;
  Permission permission_;
  Checks checks_;
  Permission::Findings findings_;  ///< of this check
  Cause outside_;
  double latency_s_ = 0.0;
  bool started_ = false;
  Verdict verdict_;
};

}  // namespace tccm
