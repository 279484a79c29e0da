#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tccm_monitor/check/collision_check.h"
#include "tccm_monitor/check/occlusion_check.h"
#include "tccm_monitor/time.h"

namespace tccm {

/// Worse levels are larger.
enum class Level : std::uint8_t { kOk = 0, kStop = 2, kFault = 3 };

/// Why the level is what it is; of several the last in this list.
enum class Reason : std::uint8_t {
  kClear,
  kReleasing,       ///< clear, but not for long enough
  kInit,            ///< the map does not hold a whole window yet
  kOcclusionAhead,  ///< at the pose horizon_s ahead
  kOcclusion,
  kCollisionAhead,
  kCollision,
  kMapOverflow,  ///< points were left out of the map
  kNoMap,        ///< no scan for too long
  kMapLate,      ///< scans come, but what is in the map is too old
  kNoJoints,     ///< a joint was never heard of, or not for too long
  kNoTransform,  ///< the robot's root in the fixed frame is unknown or too old
  kFuture,       ///< a map or joint state is stamped in the future
  kNoClock,      ///< simulated time stands still, so that nothing can grow old by it
  kBadQuestion,  ///< a state to be checked names an unknown joint or is not finite
};

/// As published, e.g. "COLLISION_AHEAD".
[[nodiscard]] const char* name(Reason reason);
[[nodiscard]] Level levelOf(Reason reason);

/// What is found at one pose of the robot.
struct PoseFindings {
  std::vector<Contact> contacts;
  std::vector<LinkVisibility> links;             ///< of the links watched for occlusion
  std::vector<std::uint32_t> occluding_cuboids;  ///< indices into the map's cuboids
  bool collision = false;
  bool occlusion = false;
  double collision_us = 0.0;  ///< wall time that the check took, forward kinematics included
  double occlusion_us = 0.0;
};

/// One answer: may the robot go on?
struct Verdict {
  Time stamp;                ///< the time the check was asked for
  Time joints_stamp;         ///< of the oldest joint position used; the epoch where there is none
  std::uint32_t serial = 0;  ///< of the newest scan in the map; 0 where there is none
  bool collision = false;    ///< now or ahead, as found in this check
  bool occlusion = false;
  /// The flags rest on a whole map and fresh input; where false, their false does not mean free.
  bool known = false;
  bool placed = false;  ///< now and ahead are of this check: map, joints and root were all there
  bool stop = true;
  Level level = Level::kFault;
  Reason reason = Reason::kInit;
  std::string detail;  ///< one line for people: which link, joint, age; empty where clear
  std::string link;    ///< the first link concerned, where the reason has one
  PoseFindings now;
  PoseFindings ahead;  ///< at the pose horizon_s ahead
};

}  // namespace tccm
