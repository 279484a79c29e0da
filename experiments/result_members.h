#pragma once

#include "experiments/archive.h"
#include "experiments/dynamic_trial.h"
#include "experiments/ghost_trial.h"
#include "experiments/governed_trial.h"
#include "experiments/hover_trial.h"
#include "experiments/occlusion_trial.h"
#include "experiments/place_speeds.h"
#include "experiments/self_filter_trial.h"
#include "experiments/small_object_trial.h"
#include "experiments/stopping_trial.h"
#include "experiments/visibility_trial.h"

/// All members of what trials find, for Archive. A member more, and it compiles no longer.
namespace tccm::simulation {

inline auto membersOf(StoppingTrial::Result& result) {
  auto& [seed, gap, aside, turn, reaches_from, phase, outcome, reason, left, beam, way_beam,
         support, due, stop, contact, contact_speed, delay, from_beam, from_support, cause,
         simulated, processing] = result;
  return std::tie(seed, gap, aside, turn, reaches_from, phase, outcome, reason, left, beam,
                  way_beam, support, due, stop, contact, contact_speed, delay, from_beam,
                  from_support, cause, simulated, processing);
}

inline auto membersOf(HoverTrial::Result& result) {
  auto& [seed, object, approach, gap, noise, outcome, reason, left, stop_left, held_max, held_mean,
         simulated] = result;
  return std::tie(seed, object, approach, gap, noise, outcome, reason, left, stop_left, held_max,
                  held_mean, simulated);
}

inline auto membersOf(GhostTrial::Result& result) {
  auto& [seed, seen_max, held_max, hidden, gone_after, left, left_held, simulated] = result;
  return std::tie(seed, seen_max, held_max, hidden, gone_after, left, left_held, simulated);
}

inline auto membersOf(OcclusionTrial::Link& link) {
  auto& [name, hidden, occluded, found] = link;
  return std::tie(name, hidden, occluded, found);
}

inline auto membersOf(OcclusionTrial::Result& result) {
  auto& [seed, scene, obstacle, phase, link, beam, false_flag, simulated] = result;
  return std::tie(seed, scene, obstacle, phase, link, beam, false_flag, simulated);
}

inline auto membersOf(SmallObjectTrial::Result& result) {
  auto& [seed, place, yaw, phase, beam, found, simulated] = result;
  return std::tie(seed, place, yaw, phase, beam, found, simulated);
}

inline auto membersOf(LinkComparison& comparison) {
  auto& [link, silhouette, in_range, truly, visible, occluded, unseen] = comparison;
  return std::tie(link, silhouette, in_range, truly, visible, occluded, unseen);
}

inline auto membersOf(VisibilityTrial::Result& result) {
  auto& [seed, scene, obstacle, links, simulated] = result;
  return std::tie(seed, scene, obstacle, links, simulated);
}

inline auto membersOf(GovernedTrial::Case& one) {
  auto& [stamp, link, way, left, wait, looked] = one;
  return std::tie(stamp, link, way, left, wait, looked);
}

inline auto membersOf(DynamicTally& tally) {
  auto& [standing, standing_static, moving, moving_static, both, both_static] = tally;
  return std::tie(standing, standing_static, moving, moving_static, both, both_static);
}

inline auto membersOf(DynamicTrial::JudgedCuboid& cuboid) {
  auto& [x, y, bottom, top, source, called_static] = cuboid;
  return std::tie(x, y, bottom, top, source, called_static);
}

inline auto membersOf(DynamicTrial::Result& result) {
  auto& [seed, scene, period, height, speed, tally, phase, maps, simulated, cuboids] = result;
  return std::tie(seed, scene, period, height, speed, tally, phase, maps, simulated, cuboids);
}

inline auto membersOf(GovernedTrial::Result& result) {
  auto& [seed, motion, cases, violations, reached, worst, way, permitted, slowed, standing,
         simulated] = result;
  return std::tie(seed, motion, cases, violations, reached, worst, way, permitted, slowed, standing,
                  simulated);
}

inline auto membersOf(PlaceSpeeds::Result& result) {
  auto& [tilt, part_tilts, allowed, mean, travelled, simulated] = result;
  return std::tie(tilt, part_tilts, allowed, mean, travelled, simulated);
}

inline auto membersOf(BeamFates& fates) {
  auto& [anywhere, in_area] = fates;
  return std::tie(anywhere, in_area);
}

inline auto membersOf(FalseContact& contact) {
  auto& [stamp, ahead, link, supporters] = contact;
  return std::tie(stamp, ahead, link, supporters);
}

inline auto membersOf(SelfFilterTally& tally) {
  auto& [scans, checks, fates, checks_with_contact, contacts_now, contacts_with, with_body, first,
         stops, permitted, slowed] = tally;
  return std::tie(scans, checks, fates, checks_with_contact, contacts_now, contacts_with, with_body,
                  first, stops, permitted, slowed);
}

}  // namespace tccm::simulation
