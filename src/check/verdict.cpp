#include "tccm_monitor/verdict.h"

namespace tccm {

const char* name(Reason reason) {
  switch (reason) {
    case Reason::kClear:
      return "CLEAR";
    case Reason::kMovingOut:
      return "MOVING_OUT";
    case Reason::kReleasing:
      return "RELEASING";
    case Reason::kAwaitingReset:
      return "AWAITING_RESET";
    case Reason::kInit:
      return "INIT";
    case Reason::kSpeedGoverned:
      return "SPEED_GOVERNED";
    case Reason::kUnseenAhead:
      return "UNSEEN_AHEAD";
    case Reason::kEvidenceOld:
      return "EVIDENCE_OLD";
    case Reason::kOcclusionAhead:
      return "OCCLUSION_AHEAD";
    case Reason::kOcclusion:
      return "OCCLUSION";
    case Reason::kCollisionAhead:
      return "COLLISION_AHEAD";
    case Reason::kCollision:
      return "COLLISION";
    case Reason::kBadTrajectory:
      return "BAD_TRAJECTORY";
    case Reason::kMapOverflow:
      return "MAP_OVERFLOW";
    case Reason::kNoMap:
      return "NO_MAP";
    case Reason::kMapLate:
      return "MAP_LATE";
    case Reason::kSweepIncomplete:
      return "SWEEP_INCOMPLETE";
    case Reason::kBlind:
      return "BLIND";
    case Reason::kNoJoints:
      return "NO_JOINTS";
    case Reason::kNoTransform:
      return "NO_TRANSFORM";
    case Reason::kFuture:
      return "FUTURE_STAMP";
    case Reason::kCheckLate:
      return "CHECK_LATE";
    case Reason::kNoClock:
      return "NO_CLOCK";
    case Reason::kInternal:
      return "INTERNAL";
    case Reason::kBadQuestion:
      return "BAD_QUESTION";
  }
  return "UNKNOWN";
}

Level levelOf(Reason reason) {
  if (reason == Reason::kClear) return Level::kOk;
  for (const Reason slow : {Reason::kMovingOut, Reason::kSpeedGoverned, Reason::kUnseenAhead}) {
    if (reason == slow) return Level::kSlow;
  }
  return reason <= Reason::kBadTrajectory ? Level::kStop : Level::kFault;
}

}  // namespace tccm
