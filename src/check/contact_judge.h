#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "check/moving_out.h"
#include "check/situation.h"
#include "check/way_check.h"

namespace tccm {

/// Judges what the robot touches, and what it will touch until the horizon: where its velocities
/// lead, and where it was commanded to go. The worse of the two counts.
class ContactJudge {
 public:
  struct Config {
    double horizon_s = 0.5;
    double step_m = 0.02;
    double stop_time_s = 0.3;
    double slow_scale_min = 0.1;
    double moving_out_scale = 0.2;

    void describe(ParameterTable& table);
  };

  /// @throws ConfigError
  ContactJudge(const std::shared_ptr<const CheckedRobot>& robot, const Config& config,
               const Braking& braking);

  void judge(const Situation& situation, Causes& causes);

  // What the last judge() found.

  /// Along all ways, from now on; of contacts there are none, the first of the margins.
  [[nodiscard]] const std::optional<WayContact>& firstContact() const { return first_contact_; }
  /// COLLISION at the present pose, also where the robot moves out of it; else CLEAR.
  [[nodiscard]] const Cause& touching() const { return touching_; }
  /// Something touches, now or ahead; margins do not count.
  [[nodiscard]] bool collision() const { return collision_; }
  /// How many poses were looked at on the ways.
  [[nodiscard]] std::size_t poses() const { return poses_; }

 private:
  [[nodiscard]] std::optional<WayContact> firstAhead(const Situation& situation);
  [[nodiscard]] std::optional<WayContact> along(const Way& way);
  void judgePresent(const Situation& situation, bool is_blocked, Causes& causes);
  /// STOP where the contact comes before the robot can halt, SLOW later.
  [[nodiscard]] Cause causeOf(const WayContact& ahead, const Braking& braking) const;
  /// Whether the robot moves out of its contacts: as it is commanded, and measured not to do the
  /// contrary; without a trajectory as it is measured. Looked at is the way of the next
  /// centimetres, however slow it is.
  [[nodiscard]] bool movesOut(const Situation& situation);

  std::shared_ptr<const CheckedRobot> robot_;
  Config config_;
  WayCheck way_;
  MovingOut moving_out_;
  JointPath escape_;  ///< reused
  double delay_s_ = 0.0;
  std::optional<WayContact> first_contact_;
  Cause touching_;
  bool collision_ = false;
  std::size_t poses_ = 0;
};

/// One that names the link of a shape, and what is held where the shape is that.
/// @param what goes after the name.
[[nodiscard]] std::string textOfContact(const RobotModel& model, std::uint32_t shape,
                                        const std::string& what);

}  // namespace tccm
