#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tccm_monitor/shape.h"
#include "tccm_monitor/time.h"

namespace tccm {

/// Worse levels are larger.
enum class Level : std::uint8_t { kOk = 0, kSlow = 1, kStop = 2, kFault = 3 };

/// Why the level is what it is; of several of one level the last in this list.
enum class Reason : std::uint8_t {
  kClear,
  kMovingOut,       ///< in contact or hidden, but what the robot does ends it
  kSpeedGoverned,   ///< what appears ahead would be seen too late at a higher speed
  kUnseenAhead,     ///< too much of the way ahead was never seen, or is hidden
  kReleasing,       ///< clear, but not for long enough
  kAwaitingReset,   ///< clear, but only a reset lifts the stop
  kInit,            ///< the map does not hold a whole window yet
  kEvidenceOld,     ///< the sensor looks no more where a link is
  kOcclusionAhead,  ///< at the end of the way ahead
  kOcclusion,
  kApproached,      ///< what was not there a moment ago is near
  kKeepOutAhead,    ///< a link enters a region to keep out of, on the way ahead
  kCollisionAhead,  ///< on the way ahead
  kKeepOut,         ///< a link is in a region to keep out of
  kCollision,
  kBadTrajectory,      ///< what was commanded cannot be understood
  kMapOverflow,        ///< points were left out of the map
  kOutsideArea,        ///< nothing of the robot that moves is inside the map's area
  kModelDisagrees,     ///< transforms put a link elsewhere than the URDF and joint states do
  kNoMap,              ///< no scan for too long
  kMapLate,            ///< scans come, but what is in the map is too old
  kSweepIncomplete,    ///< the tilt stands still, or turns too late or too early
  kBlind,              ///< hardly a beam measures anything, or nearly all is taken for the robot
  kFrameChanged,       ///< scans of another frame come on the same topic
  kNoJoints,           ///< a joint was never heard of, or not for too long
  kNoTransform,        ///< the pose of the robot's root or of the sensor is unknown or too old
  kJointOutOfRange,    ///< a joint is said to be where, or as fast as, no such joint is
  kJointContradicted,  ///< a joint is said to be at two places at one time
  kFuture,             ///< a scan, map or joint state is stamped in the future
  kCheckLate,          ///< checks take too long
  kNoClock,      ///< time stands still, or goes to and fro, so that nothing can grow old by it
  kInternal,     ///< the check itself failed
  kBadQuestion,  ///< a state or trajectory to be checked cannot be understood
};

/// As published, e.g. "COLLISION_AHEAD".
[[nodiscard]] const char* name(Reason reason);
/// At least; what is ahead may slow the robot down only.
[[nodiscard]] Level levelOf(Reason reason);

/// One thing that speaks against moving.
struct Cause {
  Reason reason = Reason::kClear;
  Level level = Level::kOk;
  std::string detail = {};   ///< one line for people: which link, joint, age
  std::string link = {};     ///< the first link concerned, where there is one
  double speed_scale = 1.0;  ///< at most, of the commanded speed

  Cause() = default;
  /// At the reason's own level.
  Cause(Reason why, std::string text, std::string of_link = {})
      : reason(why),
        level(levelOf(why)),
        detail(std::move(text)),
        link(std::move(of_link)),
        speed_scale(0.0) {}
  /// Stops the robot, whatever the reason's own level is.
  [[nodiscard]] static Cause stopping(Reason why, std::string text, std::string of_link) {
    Cause cause(why, std::move(text), std::move(of_link));
    cause.level = Level::kStop;
    return cause;
  }
  /// Slows the robot down.
  [[nodiscard]] static Cause slowing(Reason why, double speed_scale, std::string text,
                                     std::string of_link) {
    Cause cause(why, std::move(text), std::move(of_link));
    cause.level = Level::kSlow;
    cause.speed_scale = speed_scale;
    return cause;
  }

  [[nodiscard]] bool isWorseThan(const Cause& other) const {
    if (level != other.level) return level > other.level;
    // Of what slows the robot down, that it touches something is the gravest.
    const bool moves_out = reason == Reason::kMovingOut;
    if (moves_out != (other.reason == Reason::kMovingOut)) return moves_out;
    return reason > other.reason;
  }
};

/// A primitive and a cuboid, or a region to keep out of, that have a point in common.
struct Contact {
  std::uint32_t shape;   ///< index into the body's shapes; of findings into the model's
  std::uint32_t cuboid;  ///< index into the map's cuboids, or into the regions
};

/// How much of one link the sensor can see. The fractions are of its silhouette and add up to 1.
struct LinkVisibility {
  std::uint32_t link = 0;          ///< as the caller numbers links
  double silhouette = 0.0;         ///< its share of the picture, in pixels at the horizon
  double visible_fraction = 1.0;   ///< seen as far as to the link; 1 where it does not show at all
  double occluded_fraction = 0.0;  ///< surroundings stand before it
  double unseen_fraction = 0.0;    ///< nobody looked there, or the robot itself stood before it
};

/// What is found at one pose of the robot.
struct PoseFindings {
  std::vector<Contact> contacts;                 ///< with the map
  std::vector<Contact> keep_out;                 ///< with regions to keep out of
  std::vector<LinkVisibility> links;             ///< of the links watched for occlusion
  std::vector<std::uint32_t> occluding_cuboids;  ///< indices into the map's cuboids
  bool collision = false;                        ///< with the map
  bool occlusion = false;
};

/// A contact along a way.
struct WayContact {
  Contact contact;              ///< of the model's shapes and the map's cuboids
  double time_s = 0.0;          ///< from the way's start
  double distance_m = 0.0;      ///< of the padded primitive at the way's start to that cuboid
  double link_speed_mps = 0.0;  ///< the most that a point of the primitive moves at
  bool by_margin = false;       ///< only the margin for its speed touches
};

/// How near a link is to the map, or to a region to keep out of.
struct LinkClearance {
  std::size_t link = 0;  ///< index into the model's links
  /// Of the primitives without padding; infinite where neither lies within the radius.
  double distance_m = std::numeric_limits<double>::infinity();
  std::uint32_t cuboid = 0;  ///< the nearest, or the region, where the distance is finite
  bool is_region = false;    ///< what is nearest
};

/// One answer: may the robot go on?
struct Verdict {
  Time stamp;                ///< the time the check was asked for
  Time joints_stamp;         ///< of the oldest joint position used; the epoch where there is none
  std::uint32_t serial = 0;  ///< of the newest scan in the map; 0 where there is none
  bool collision = false;    ///< now or ahead, as found in this check
  bool occlusion = false;
  bool keep_out = false;  ///< a link is in a region to keep out of, now or ahead
  /// The flags rest on a whole map and fresh input; where false, their false does not mean free.
  bool known = false;
  bool placed = false;  ///< now and ahead are of this check: map, joints and root were all there
  bool stop = true;     ///< not permitted
  double speed_scale = 0.0;  ///< of the commanded speed; 0 at a stop
  Level level = Level::kFault;
  Reason reason = Reason::kInit;
  std::string detail;  ///< one line for people: which link, joint, age; empty where clear
  std::string link;    ///< the first link concerned, where the reason has one
  /// All that apply, the gravest first; the first is `reason`, unless it is clear.
  std::vector<Reason> reasons;
  Reason latched = Reason::kClear;  ///< what only a reset lifts
  PoseFindings now;
  PoseFindings ahead;                       ///< at the end of the way ahead
  std::optional<WayContact> first_contact;  ///< the gravest of all ways; from now on, at 0 s
  /// What has appeared near the robot: no contact, but within approach_distance_m.
  std::optional<Contact> approached = {};
  bool follows_trajectory = false;             ///< a commanded trajectory is one of the ways
  std::size_t way_poses = 0;                   ///< looked at between now and the end
  std::vector<LinkClearance> clearances = {};  ///< of the links with collision primitives
  /// Of all that the links go through until the horizon; 0 where nothing was placed.
  double unseen_fraction = 0.0;
  /// Of the commanded speed: at more something that appears ahead would be seen too late; 1 where
  /// that limits nothing.
  double governed_scale = 1.0;
};

/// What became of a scan before it reached the map.
struct ScanReport {
  enum class Outcome { kWaiting, kAssembled, kDropped };
  Time stamp;
  Outcome outcome = Outcome::kWaiting;
  std::string dropped = {};  ///< why: blind, future_stamp, no_transform ...
  std::string detail = {};   ///< the same for people, with names and figures
  /// Of ASSEMBLED: the link that most returns were lately taken for; empty where none were.
  std::string self_link = {};
};

/// For a while a link may touch what lies in a region: to grasp, to dock.
struct Exemption {
  enum class State {
    kInForce,
    kAwaitsGoal,   ///< no goal of its owner is under way
    kNoTransform,  ///< its frame was never heard of
    kTransformOld,
    kTransformOfFuture,
  };
  std::string owner;
  std::string link;    ///< name, or a pattern that means one link
  PlacedShape region;  ///< in its frame
  Time until;          ///< while it waits for a goal: it lapses then
  /// That the region moves with: a link of the robot, or one that transforms place; empty: the
  /// fixed frame.
  std::string frame = {};
  bool with_goal = false;  ///< in force only while a goal of its owner is under way
  State state = State::kInForce;
  Duration transform_age{0};  ///< of its frame, where transforms place it
};

/// A box that no link may enter, named.
struct KeepOutRegion {
  std::string name;
  /// A link that no joint moves, by its name or as transforms call it; empty: the fixed frame.
  std::string frame;
  Box box;
  Pose T_frame_box = Pose::Identity();
};

/// May the robot be in a state?
struct StateAnswer {
  Cause cause;  ///< CLEAR: the pose is free
  PoseFindings findings;
};

/// May the robot go along a trajectory?
struct TrajectoryAnswer {
  Cause cause;                       ///< CLEAR: all of it is free
  std::optional<std::size_t> index;  ///< of the waypoint at the end of the stretch concerned
  double time_s = 0.0;               ///< of the first violation, from the trajectory's start
  std::optional<Contact> contact;    ///< with the map
  /// At each waypoint, of all links to the nearest cuboid or region [m]; infinite beyond the
  /// radius.
  std::vector<double> clearances_m;
};

}  // namespace tccm
