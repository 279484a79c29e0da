#include "tccm_monitor/verdict.h"

#include <iterator>

namespace tccm {
namespace {

/// In the order of Reason.
constexpr const char* kNames[] = {"CLEAR",
                                  "MOVING_OUT",
                                  "SPEED_GOVERNED",
                                  "UNSEEN_AHEAD",
                                  "RELEASING",
                                  "AWAITING_RESET",
                                  "INIT",
                                  "EVIDENCE_OLD",
                                  "OCCLUSION_AHEAD",
                                  "OCCLUSION",
                                  "APPROACHED",
                                  "KEEP_OUT_AHEAD",
                                  "COLLISION_AHEAD",
                                  "KEEP_OUT",
                                  "COLLISION",
                                  "BAD_TRAJECTORY",
                                  "MAP_OVERFLOW",
                                  "OUTSIDE_AREA",
                                  "MODEL_DISAGREES",
                                  "NO_MAP",
                                  "MAP_LATE",
                                  "SWEEP_INCOMPLETE",
                                  "BLIND",
                                  "FRAME_CHANGED",
                                  "NO_JOINTS",
                                  "NO_TRANSFORM",
                                  "JOINT_OUT_OF_RANGE",
                                  "JOINT_CONTRADICTED",
                                  "FUTURE_STAMP",
                                  "CHECK_LATE",
                                  "NO_CLOCK",
                                  "INTERNAL",
                                  "BAD_QUESTION"};
static_assert(std::size(kNames) == static_cast<std::size_t>(Reason::kBadQuestion) + 1);

}  // namespace

const char* name(Reason reason) {
  const auto index = static_cast<std::size_t>(reason);
  return index < std::size(kNames) ? kNames[index] : "UNKNOWN";
}

Level levelOf(Reason reason) {
  if (reason == Reason::kClear) return Level::kOk;
  if (reason <= Reason::kUnseenAhead) return Level::kSlow;
  return reason <= Reason::kBadTrajectory ? Level::kStop : Level::kFault;
}

}  // namespace tccm
