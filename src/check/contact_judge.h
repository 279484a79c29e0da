#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "check/moving_out.h"
#include "check/situation.h"
#include "check/way_ahead.h"

namespace tccm {

/// Judges what the robot touches, and what it will touch until the horizon, or as far as halting
/// takes: where its velocities lead, and where it was commanded to go. Of all contacts along all
/// ways the gravest counts.
class ContactJudge {
 public:
  /// What it must not touch.
  enum class Against { kMap, kKeepOut };
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
               const Braking& braking, Against against = Against::kMap);

  struct Findings {
    /// The gravest along all ways, from now on; where nothing touches, of the margins.
    std::optional<WayContact> first_contact;
    /// COLLISION, or KEEP_OUT, at the present pose, also where the robot moves out of it; else
    /// CLEAR.
    Cause touching;
    bool touches = false;   ///< now or ahead; margins do not count
    std::size_t poses = 0;  ///< looked at on the ways
  };
  /// Where there are no regions to keep out of nothing is found in them.
  /// The reference is valid until the next call.
  const Findings& judge(const Situation& situation, Causes& causes);

 private:
  [[nodiscard]] Obstacles obstaclesOf(const Situation& situation) const;
  [[nodiscard]] const std::vector<Contact>& contactsOf(const Situation& situation) const;
  /// What is told of a contact: goes after the link's name.
  enum class Told { kTouches, kMovesOut, kAhead, kTooNear };
  [[nodiscard]] std::string textOf(const Situation& situation, const Contact& contact,
                                   Told told) const;
  void lookAhead(const Situation& situation);
  /// STOP where a contact comes before the robot can halt, SLOW later.
  [[nodiscard]] Cause causeOf(const Situation& situation,
                              const std::optional<WayAhead::Found>& touch,
                              const std::optional<WayAhead::Found>& margin) const;
  [[nodiscard]] Cause tooFast(const WayAhead::TooFast& part) const;
  /// Names the fastest joint.
  [[nodiscard]] Cause tooLong(const JointSnapshot& joints) const;
  void judgePresent(const Situation& situation, bool is_blocked, Causes& causes);
  [[nodiscard]] bool movesOut(const Situation& situation);

  std::shared_ptr<const CheckedRobot> robot_;
  Config config_;
  Against against_;
  WayAhead ahead_;
  MovingOut moving_out_;
  JointPath escape_;  ///< reused
  Findings findings_;
};

/// One that names the link of a shape, and what is held where the shape is that.
/// @param what goes after the name.
[[nodiscard]] std::string textOfContact(const RobotModel& model, std::uint32_t shape,
                                        const std::string& what);

}  // namespace tccm
