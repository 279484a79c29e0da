#pragma once

#include <utility>
#include <vector>

#include "simulation/snapshot.h"

namespace tccm::test {

using Targets = std::vector<std::pair<Shape, Pose>>;

/// Of a sensor at the origin; each target has a label of its own.
inline simulation::Snapshot snapshotOf(Time stamp, const Targets& targets) {
  simulation::Snapshot snapshot{stamp, Pose::Identity(), {}, {}};
  for (const auto& [shape, pose] : targets) {
    snapshot.labels.push_back(snapshot.labels.size());
    snapshot.targets.shapes.push_back(shape);
    snapshot.targets.poses.push_back(pose);
  }
  return snapshot;
}

/// Targets that stand still for 0.1 s, as long as a turn of the slowest of the sensors.
inline std::vector<simulation::Snapshot> standing(const Targets& targets) {
  return {snapshotOf(Time{}, targets), snapshotOf(Time{std::chrono::milliseconds(100)}, targets)};
}

}  // namespace tccm::test
