#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "check/commanded_trajectories.h"
#include "check/moving_out.h"
#include "check/pose_check.h"
#include "check/verdict.h"
#include "check/way_check.h"

namespace tccm {

/// Looks at all that the robot will pass until the horizon: where its velocities lead, and where it
/// was commanded to go. The worse of the two counts.
class WayAhead {
 public:
  struct Config {
    double horizon_s = 0.5;  ///< how far ahead (paper, section VI.B)
    double step_m = 0.02;    ///< no primitive moves further between two poses; a cell
    /// Of the controller. With the measured latency and the age of the joint states it is the delay
    /// after which a verdict has an effect.
    double reaction_time_s = 0.02;
    /// Ahead, primitives grow by their speed times the delay, but by no more. What only this margin
    /// touches slows the robot down.
    double margin_max_m = 0.1;
    /// A contact sooner than this, the delay and half of the time that braking takes together stops
    /// the robot; a later one slows it down.
    double stop_time_s = 0.3;
    double deceleration_mps2 = 2.0;  ///< of a link when the robot brakes
    double slow_scale_min = 0.1;     ///< the least speed scale short of a stop
    double moving_out_scale = 0.2;   ///< while the robot moves out of a contact

    /// @throws ConfigError
    void validate() const;
  };

  /// @throws ConfigError
  WayAhead(std::shared_ptr<const RobotModel> model, const PoseCheck::Config& pose,
           const Config& config);
  void exempt(const ExemptRegions& regions);

  /// Finds the ways.
  /// @param commanded has followed the robot.
  void setOut(const JointSnapshot& joints, CommandedTrajectories& commanded);
  /// Where the robot is at the horizon: on its trajectory, where it follows one.
  [[nodiscard]] const std::vector<double>& positionsAtEnd() const { return end_; }
  [[nodiscard]] bool followsTrajectory() const { return follows_; }

  /// The first contact on either way; where there is none, the first of the margins.
  /// @param latency_s of the verdict and of the joint states.
  /// @param present contacts at the present pose; their primitives are not looked at.
  [[nodiscard]] std::optional<WayContact> firstContact(const CuboidMap& map, double latency_s,
                                                       const std::vector<Pose>& T_fixed_roots,
                                                       const std::vector<Contact>& present);
  /// Whether the robot moves out of the contacts at its present pose: as it is commanded, and
  /// measured not to do the contrary; without a trajectory as it is measured. Looked at is the way
  /// of the next centimetres, however slow it is.
  [[nodiscard]] bool movesOut(const CuboidMap& map, const std::vector<Contact>& contacts,
                              const JointSnapshot& joints, CommandedTrajectories& commanded,
                              const std::vector<Pose>& T_fixed_roots);
  /// Poses looked at by the last firstContact().
  [[nodiscard]] std::size_t poses() const { return poses_; }

  /// STOP where the contact comes before the robot can halt, SLOW later.
  [[nodiscard]] Level levelOf(const WayContact& contact) const;
  /// Of the commanded speed, for a contact that slows the robot down.
  [[nodiscard]] double speedScale(const WayContact& contact) const;

 private:
  [[nodiscard]] std::optional<WayContact> along(const CuboidMap& map, const JointPath& way,
                                                const std::vector<Pose>& T_fixed_roots);
  /// A contact that comes sooner cannot be waited for.
  [[nodiscard]] double haltTime(const WayContact& contact) const;

  std::shared_ptr<const RobotModel> model_;
  Config config_;
  WayCheck check_;
  MovingOut moving_out_;
  JointPath measured_;
  JointPath commanded_;
  JointPath escape_;  ///< reused
  bool follows_ = false;
  double delay_s_ = 0.0;
  std::vector<double> end_;
  std::size_t poses_ = 0;
};

}  // namespace tccm
