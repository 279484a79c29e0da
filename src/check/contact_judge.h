#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "check/situation.h"
#include "check/way_check.h"

namespace tccm {

/// Tells a motion that ends a contact from one that goes on into it. For each pair of primitive and
/// cuboid that touch, the distance of the primitive's core (its axis or middle) to the cuboid is
/// followed along the way: none may become less, and at the end each must be more. A primitive that
/// did not touch must not begin to, and none may come nearer to anything than it was. Where a core
/// itself is in a cuboid, no way out can be told. Looked at are so many poses that no primitive
/// moves further than 10 mm from one to the next.
class MovingOut {
 public:
  explicit MovingOut(std::shared_ptr<const CheckedRobot> robot);

  /// When a primitive may have moved that far along the way; its end where none does.
  [[nodiscard]] double timeOf(const JointPath& way, double metres);
  /// @param contacts of the pose at the way's begin.
  /// @param must_open false: it is enough that nothing closes.
  [[nodiscard]] bool opens(const Way& way, const std::vector<Contact>& contacts, double until_s,
                           bool must_open);

 private:
  /// Of one contact.
  struct Pair {
    std::size_t shape;  ///< index into the body's shapes
    std::uint32_t cuboid;
    double first_m, last_m;  ///< distance of the core
  };
  [[nodiscard]] double coreDistance(const CuboidMap& map, std::size_t shape,
                                    std::uint32_t cuboid) const;
  void place(const Way& way, double time_s);
  [[nodiscard]] bool closesAny(const CuboidMap& map);
  [[nodiscard]] bool closesBetween(const Way& way, double from_s, double to_s);
  /// How far any primitive moves at most.
  [[nodiscard]] double furthest(const JointPath& way, double from_s, double to_s);

  std::shared_ptr<const CheckedRobot> robot_;
  UsedBody body_;
  std::vector<Shape> cores_;
  Kinematics kinematics_;
  MotionBound bound_;
  std::size_t contacts_max_;
  std::vector<Contact> contacts_;  ///< at the pose looked at
  std::size_t poses_ = 0;
  std::vector<double> positions_;
  std::vector<double> travel_from_, travel_;
  std::vector<Pair> pairs_;
  std::vector<double> least_m_;  ///< of each shape in contact at the begin, infinite for others
};

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

  struct Findings {
    /// Along all ways, from now on; of contacts there are none, the first of the margins.
    std::optional<WayContact> first_contact;
    /// COLLISION at the present pose, also where the robot moves out of it; else CLEAR.
    Cause touching;
    bool collision = false;    ///< something touches, now or ahead; margins do not count
    std::size_t poses = 0;     ///< looked at on the ways
    bool is_too_long = false;  ///< the ways, to be looked along in time
  };
  /// The reference is valid until the next call.
  const Findings& judge(const Situation& situation, Causes& causes);

 private:
  [[nodiscard]] std::optional<WayContact> firstAhead(const Situation& situation);
  [[nodiscard]] std::optional<WayContact> along(const Way& way);
  [[nodiscard]] static std::optional<WayContact> graver(const std::optional<WayContact>& one,
                                                        const std::optional<WayContact>& other);
  /// Names the fastest joint.
  [[nodiscard]] Cause tooLong(const JointSnapshot& joints) const;
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
  Findings findings_;
};

/// One that names the link of a shape, and what is held where the shape is that.
/// @param what goes after the name.
[[nodiscard]] std::string textOfContact(const RobotModel& model, std::uint32_t shape,
                                        const std::string& what);

}  // namespace tccm
