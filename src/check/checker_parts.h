#pragma once

#include <memory>
#include <string>
#include <vector>

#include "check/area_check.h"
#include "check/checker_config.h"
#include "check/clock_steps.h"

namespace tccm {

/// Everything that is made for one model and configuration: what there is to know of the robot, and
/// the judges that look at it.
struct Judges {
  std::shared_ptr<CheckedRobot> robot;
  PoseCheck here, ahead, asked;
  AreaCheck area;
  ContactJudge contacts;
  ContactJudge keep_out;
  EvidenceCheck evidence;
  GovernedSpeed governed_speed;
  ApproachCheck approach;
  TrajectoryCheck trajectory;

  /// @throws ConfigError, also where the self-test does not find a link.
  Judges(const std::shared_ptr<const RobotModel>& model, const Checker::Config& config);
};

struct Checker::Parts {
  Parts(std::shared_ptr<const RobotModel> model, const Config& new_config);

  /// The one door for what the robot holds and how it is checked.
  /// @throws ConfigError, and nothing changes.
  void renew(const Config& new_config, std::vector<AttachedObject> objects);
  /// And for what it may touch: other exemptions, or another robot.
  void exempt();
  /// The same exemptions, as they are now.
  void updateExemptions(Time now);
  [[nodiscard]] Exemptions::Limits transformLimits() const;
  const Verdict& check(Time now);
  /// What the robot does and meets, once it can be placed.
  void judge(Time now, const JointSnapshot& joints);
  /// Whether the map says anything of where the robot would be. @pre there is a map
  [[nodiscard]] Cause outsideArea(const Posture& posture) const;
  void findOutside(const JointTrajectory& trajectory, TrajectoryAnswer& answer);
  /// What is there, with the regions to keep out of where the roots are now. @pre there is a map
  [[nodiscard]] Surroundings around();
  void decide(Time now);
  void forgetFindings();
  void startAnew();
  /// Without what is attached to it, but `name`.
  [[nodiscard]] std::vector<AttachedObject> attachedBut(const std::string& name) const;
  [[nodiscard]] const RobotModel& model() const { return *judges.robot->model; }

  Config config;
  std::shared_ptr<const RobotModel> bare_model;  ///< with empty hands
  std::vector<AttachedObject> attached;
  CheckInputs inputs;
  CommandedTrajectories commanded;
  Exemptions exemptions;
  KeepOut keep_out;
  Permission permission;
  Judges judges;
  Permission::Findings findings;  ///< of this check
  ClockSteps clock_steps;
  std::size_t revision = 0;
  bool started = false;
  Verdict verdict;
  CheckTimes times;
};

}  // namespace tccm
