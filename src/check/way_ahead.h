#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "check/halting.h"
#include "check/leaving.h"
#include "check/way_speeds.h"
#include "robot/motion_bound.h"
#include "robot/path_cursor.h"

namespace tccm {

/// Finds, of all contacts along the ways ahead, the gravest.
///
/// More obstacles, links, ways, padding or speed never make it milder, and that not only up to how
/// finely is looked: each primitive is looked at alone, at places of its way that neither what is
/// around it, nor another primitive, nor its speed moves. They are a small part of a step apart,
/// and closer near the way's begin. Places that the distance to the nearest obstacle proves free
/// are passed over.
class WayAhead {
 public:
  struct Found {
    WayContact contact;
    bool stops = false;
    double scale = 1.0;  ///< of the speed, where it does not stop
  };
  /// A primitive that is too fast for the way to be looked along as far as halting takes.
  struct TooFast {
    std::size_t shape;  ///< index into the model's shapes
    double speed_mps;
    double looked_s;  ///< for how long the way was looked along
    double scale;     ///< at which it halts within that
  };

  /// @param step_m no primitive moves further between two places that are looked at.
  /// @param margin_max_m primitives grow by their speed times the delay, at most by this.
  WayAhead(const std::shared_ptr<const CheckedRobot>& robot, double step_m, double margin_max_m);

  /// Forgets what was found.
  /// @param contacts at the present pose: what touches there is not ahead. @param posture of it.
  /// @param work that may be done on all ways, in the unit of CollisionCheck::work().
  void begin(const Halting& halting, const std::vector<Contact>& contacts, const Posture& posture,
             std::size_t work);
  /// @param way from the present pose on.
  /// @return false where it ends too soon to be looked along as far as it has to be: nothing of it
  /// counts then. One that lasts for lookTimeMax() does not.
  [[nodiscard]] bool lookAlong(const Way& way);
  [[nodiscard]] double lookTimeMax() const;

  /// What touches.
  [[nodiscard]] const std::optional<Found>& touch() const { return touch_; }
  /// What only the margin for a primitive's speed touches. Not looked for any more once a contact
  /// stops.
  [[nodiscard]] const std::optional<Found>& margin() const { return margin_; }
  [[nodiscard]] const std::optional<TooFast>& tooFast() const { return too_fast_; }
  /// At how many places primitives were looked at.
  [[nodiscard]] std::size_t poses() const { return poses_; }
  /// Whether more work would have been needed: then what was not found may be there.
  [[nodiscard]] bool isTooLong() const { return is_too_long_; }

 private:
  /// Everything of one primitive.
  struct Part {
    LinkChain chain;
    Shape grown;  ///< by the margin
    Shape core;
    double margin_m = 0.0;
    double look_s = 0.0;            ///< for how long it is looked along
    double per_metre = 1.0;         ///< that it moves at most for each that its cursor does
    std::size_t halvings = 0;       ///< of the places' distances
    double free_halfway_m = 0.0;    ///< around it at the pose halfway
    std::vector<double> arms = {};  ///< of it with its margin, by variable
    std::vector<std::uint32_t> touched = {};  ///< obstacles at the present pose
  };
  [[nodiscard]] Part partOf(std::size_t i) const;
  void prepare(std::size_t i);
  void findPerMetre(const Way& way, std::size_t i);
  /// How far it moves at most while the joints travel from one of these to the other.
  [[nodiscard]] double moved(std::size_t i, const std::vector<double>& from,
                             const std::vector<double>& to) const;
  /// From the pose halfway: whether nothing lies within what it moves.
  [[nodiscard]] bool isFree(const Way& way, std::size_t i);
  void walk(const Way& way, std::size_t i);
  /// @param until_m the cursor may go at least, from a place with so much around it that is free.
  /// @return how far it may go if it is looked from further ahead as well.
  double passFree(const Way& way, std::size_t i, bool with_margin, double until_m, double free_m);

  // Of a primitive where the cursor is:

  void place(const Way& way, std::size_t i, bool is_here);
  /// The links that the regions it may touch things in move with.
  void placeRegions(const Way& way, std::size_t i);
  /// Before the walk.
  void beginLeaving(const Way& way, std::size_t i);
  /// @return how far the cursor may go until any of what it leaves is ahead.
  double leave(const Way& way, std::size_t i, double here_m);
  /// What does not count as ahead; margins do not count less for it.
  [[nodiscard]] const std::vector<std::uint32_t>* left(bool with_margin) const;
  [[nodiscard]] const Shape& solid(std::size_t i, bool with_margin) const;
  /// How far the cursor may go on or back at least until it touches; 0: it may touch here.
  [[nodiscard]] double freeAround(const Way& way, std::size_t i, bool with_margin) const;
  /// Notes what it touches.
  bool touches(const Way& way, std::size_t i, bool with_margin);

  /// After which a contact of a primitive would be milder than what was found.
  [[nodiscard]] double latest(std::size_t i) const;
  void noteTooFast(const Way& way);
  [[nodiscard]] bool isExhausted();

  std::shared_ptr<const CheckedRobot> robot_;
  UsedBody body_;  ///< never placed
  double step_m_;
  double unit_m_;  ///< between two places, by what the cursor moves
  double margin_max_m_;
  WaySpeeds speeds_;
  MotionBound bound_;
  MotionBound bound_grown_;
  MotionBound cursor_bound_;  ///< whose lever arms padding and ways do not change
  Kinematics kinematics_;     ///< halfway
  std::vector<Part> parts_;
  Halting halting_{};
  const Posture* here_ = nullptr;
  PathCursor cursor_;
  Pose T_fixed_shape_ = Pose::Identity();  ///< where the cursor is
  bool is_here_ = false;                   ///< at the way's begin
  std::vector<LinkChain> link_chains_;     ///< of all links
  std::vector<Pose> T_fixed_links_;        ///< where the cursor is; those with regions alone
  double halfway_s_ = 0.0;
  double end_m_ = 0.0;  ///< of the primitive's way, by the cursor
  Leaving leaving_;     ///< where the cursor is
  std::optional<Found> touch_, margin_;
  std::optional<TooFast> too_fast_;
  std::size_t poses_ = 0;
  std::size_t work_ = 0;      ///< without that of the collision check
  std::size_t work_end_ = 0;  ///< of both
  bool is_too_long_ = false;
  std::vector<double> positions_, begin_, halfway_, end_;  ///< reused
};

}  // namespace tccm
