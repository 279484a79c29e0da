#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tccm_monitor/cuboid_map.h"
#include "tccm_monitor/robot_model.h"
#include "tccm_monitor/verdict.h"

namespace tccm {

class CheckInputs;
class EvidenceCheck;
class ModelAgreement;
class PoseCheck;

/// Wall times of a check's parts [us]; nothing that is decided depends on them.
struct CheckTimes {
  double collision_us =
      0.0;  ///< at the present pose and at the end of the way, kinematics included
  double occlusion_us = 0.0;
  double way_us = 0.0;  ///< what lies between
  double evidence_us = 0.0;
  double clearance_us = 0.0;
};

/// Turns the newest map, joint states, root poses and commanded trajectories into a verdict,
/// whenever it is asked and whatever is missing.
class Checker {
 public:
  struct Config;

  /// @throws ConfigError, also where the self-test does not find a link.
  Checker(std::shared_ptr<const RobotModel> model, const Config& config);
  ~Checker();
  Checker(const Checker&) = delete;
  Checker& operator=(const Checker&) = delete;

  /// Other limits and checks from the next check on; how joint states are gathered stays.
  /// @throws ConfigError, and nothing changes.
  void reconfigure(const Config& config);
  [[nodiscard]] const Config& config() const;

  /// A message that is stamped in the future is dropped.
  /// @param publisher for what is told to people; may be empty. @return what was taken of it.
  AddedJoints addJoints(Time now, Time stamp, const std::vector<std::string>& names,
                        const std::vector<double>& positions, const std::vector<double>& velocities,
                        const std::string& publisher = {});
  /// One of the model's roots in the fixed frame. One that does not move (the same frame, or
  /// static transforms alone) never grows old.
  void setRootPose(std::size_t root, Time stamp, const Pose& T_fixed_root, bool is_static);
  /// What becomes of scans. Where nothing reports it, maps alone tell.
  /// @param sensor index into the configured sensors.
  void addScanReport(Time now, const ScanReport& report, std::size_t sensor = 0);
  void setMap(Time now, std::shared_ptr<const CuboidMap> map, std::size_t sensor = 0);
  /// What the arms were told to do. It takes the place of what was said of one of its joints; one
  /// without points cancels. @return what is wrong with it, in one line; then the robot is stopped
  /// until the next for any of its joints.
  std::string command(Time now, const JointTrajectory& trajectory);
  /// How long verdicts take, measured, from the moment when scan and transforms are there to the
  /// publication: margins grow with it.
  void setLatency(double seconds);
  [[nodiscard]] double latency() const;
  /// What the caller knows to be wrong or unknown, until it says otherwise; CLEAR: nothing.
  void setOutsideCause(const Cause& cause);

  /// The robot has something else in its hand from now on; an object of the same name is replaced.
  /// @throws ConfigError, and nothing changes.
  void attach(const AttachedObject& object);
  /// @return false where no object has that name.
  bool detach(const std::string& object);
  [[nodiscard]] const std::vector<AttachedObject>& attached() const;
  /// @throws ConfigError, and nothing changes. @param duration_s 0 ends one of the same owner.
  void addExemption(Time now, const Exemption& exemption, double duration_s);
  /// @param link empty: all of that owner. @return how many have ended.
  std::size_t liftExemptions(const std::string& owner, const std::string& link);
  /// A goal of an owner begins or ends, and exemptions with it. @param goal empty at the end: all
  /// of that owner. @throws ConfigError where a name is missing.
  void reportGoal(Time now, const std::string& owner, const std::string& goal, bool under_way);
  /// The frames of exemptions that transforms have to place, in the fixed frame.
  [[nodiscard]] std::vector<std::string> exemptFrames() const;
  void setExemptFrame(const std::string& frame, Time stamp, const Pose& T_fixed_frame,
                      bool is_static);
  /// Ends those whose time is over, and looks which are in force, as each check and question does.
  void updateExemptions(Time now);
  [[nodiscard]] const std::vector<Exemption>& exemptions() const;
  /// No link may enter it from now on; one of the same name is replaced. It stays, whatever time
  /// does. @throws ConfigError, and nothing changes; also for one of the configuration.
  void setKeepOut(const KeepOutRegion& region);
  /// @throws ConfigError where there is none of that name, or it is of the configuration.
  void removeKeepOut(const std::string& name);
  /// Frames are as transforms call them.
  [[nodiscard]] const std::vector<KeepOutRegion>& keepOut() const;
  /// Why one of them is not in force; empty where it is.
  [[nodiscard]] std::string whyNotInForce(const Exemption& exemption) const;
  /// Where the region of one of them is in the fixed frame, with the robot as the last check found
  /// it; nothing where that is not known. @param index into exemptions().
  [[nodiscard]] std::optional<Pose> regionPose(std::size_t index) const;
  /// Where a link is in the fixed frame; nothing where the model lacks it, or joints or root are
  /// missing or too old.
  [[nodiscard]] std::optional<Pose> linkPose(Time now, const std::string& link);
  /// Where an object that is about to be attached is in the fixed frame.
  /// @throws ConfigError where the model lacks its link, or joints or root are missing or too old.
  [[nodiscard]] PlacedShape placeOf(Time now, const AttachedObject& object);

  /// The reference is valid until the next call. @param now not before that of earlier calls.
  const Verdict& check(Time now);
  /// In place of a check that could not be made, or came to nothing.
  const Verdict& fail(Time now, const Cause& cause);
  /// Lifts what holds until it is reset. @return why not; empty where it is lifted.
  [[nodiscard]] std::string reset();
  /// As at the start, but for what holds until it is reset: after time has jumped back.
  void startAnew();

  /// What a controller asks about: the same checks for a pose that the robot is not in. Joints that
  /// are not named are taken where they are; one that the robot does not have, or a position that
  /// is not finite, is answered with BAD_QUESTION.
  [[nodiscard]] StateAnswer checkState(Time now, const std::vector<std::string>& names,
                                       const std::vector<double>& positions);
  /// The same of a whole way, between the waypoints as well.
  [[nodiscard]] TrajectoryAnswer checkTrajectory(Time now, const JointTrajectory& trajectory);

  /// Grows where what the checker goes by changes: limits, what the robot holds or may touch, and
  /// regions.
  [[nodiscard]] std::size_t revision() const;
  /// With what it holds.
  [[nodiscard]] const std::shared_ptr<const RobotModel>& model() const;
  /// Joints that no joint state has named yet.
  [[nodiscard]] std::vector<std::string> missingJoints() const;
  /// All that is occupied, of all sensors.
  [[nodiscard]] const CuboidMap* map() const;
  /// Of the last check.
  [[nodiscard]] const CheckTimes& times() const;

  // For this package's own reports and pictures.
  [[nodiscard]] CheckInputs& inputs();
  [[nodiscard]] const CheckInputs& inputs() const;
  /// Transforms are compared with the model there, and sensors named.
  [[nodiscard]] ModelAgreement& agreement();
  [[nodiscard]] const ModelAgreement& agreement() const;
  [[nodiscard]] const EvidenceCheck& evidence() const;
  [[nodiscard]] const PoseCheck& checkHere() const;
  [[nodiscard]] const PoseCheck& checkAhead() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace tccm
