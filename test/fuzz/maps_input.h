#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "fuzz/fuzzed_checker.h"

/// What the fuzz target of maps and the test of its corpus do with an input: a robot that moves, a
/// map with cuboids and flags of any kind, and the same with more in it.
namespace tccm::test {

/// How the robot moves, and how it is watched.
struct MapScene {
  Checker::Config config = fuzzedChecker();
  double slide = 0.0, turn = 0.0;
  double slide_speed = 0.0, turn_speed = 0.0;
};

inline MapScene fuzzedScene(ByteReader& bytes) {
  MapScene scene;
  const std::uint8_t kind = bytes.byte();
  scene.config.pose.check_occlusion = (kind & 1U) != 0;
  scene.config.pose.occlusion.stops = (kind & 2U) == 0;
  scene.config.pose.collision.support_points = (kind & 4U) != 0 ? 1 : 3;
  scene.config.governed_speed.appear_distance_m = (kind & 8U) != 0 ? 0.15 : 0.0;
  scene.config.braking.stop_duration_s = (kind & 16U) != 0 ? 0.5 : 0.0;
  scene.slide = bytes.uniform(-0.4, 0.95);
  scene.turn = bytes.uniform(-3.2, 3.2);
  scene.slide_speed = bytes.flag() ? bytes.uniform(-1.0, 1.0) : 0.0;
  scene.turn_speed = bytes.flag() ? bytes.uniform(-4.0, 4.0) : 0.0;
  return scene;
}

/// What else a map says, mostly as a healthy one does.
inline void fuzzFlags(ByteReader& bytes, CuboidMap& map, Duration& age) {
  const std::uint8_t kind = bytes.byte();
  map.complete = kind < 0xf0U;
  map.overflowed = (kind & 0xf0U) == 0xe0U;
  map.tilt_stopped = (kind & 0xf0U) == 0xd0U;
  age = std::chrono::milliseconds(bytes.seldom() ? bytes.oneOf({501, 100000, -101, -5000, 499, 0})
                                                 : static_cast<int>(bytes.count(200)));
  if (bytes.seldom()) map.self_share = bytes.number(0.0, 1.0);
  if (bytes.seldom()) map.look_period = std::max(Duration(0), bytes.step(0, 200));
  if (bytes.seldom()) map.window = bytes.step(0, 200);
  if (bytes.seldom()) map.thickness = static_cast<Height>(bytes.count(1000));
}

/// Whether nobody may be told from it that the way is free.
inline bool isToBeTrusted(const CuboidMap& map, Duration age) {
  return map.complete && !map.overflowed && !map.tilt_stopped &&
         age <= std::chrono::milliseconds(500) && age >= -std::chrono::milliseconds(100) &&
         !(map.self_share && *map.self_share > 0.9);
}

/// The second of two checks, 10 ms apart, since the speed rises from 0; of a checker that has just
/// been made.
inline Verdict judged(const MapScene& scene, const CuboidMap& map, Duration age,
                      const std::vector<KeepOutRegion>& regions) {
  const auto robot = fuzzedRobot();
  Checker checker(robot, scene.config);
  checker.setRootPose(0, Time(), Pose::Identity(), true);
  for (const KeepOutRegion& region : regions) checker.setKeepOut(region);
  Time now{std::chrono::seconds(100)};
  for (std::uint32_t i = 1; i <= 2; ++i) {
    now += std::chrono::milliseconds(10);
    checker.setMap(now, seenAt(map, now - age, i));
    checker.addJoints(now, now, {"slide", "turn"}, {scene.slide, scene.turn},
                      {scene.slide_speed, scene.turn_speed});
    const Verdict& verdict = checker.check(now);
    requireVerdict(verdict);
    promise(isToBeTrusted(map, age) || verdict.stop, "it goes by a map that is not to be trusted");
    if (!verdict.placed) continue;
    requireContacts(verdict, *checker.map(), *robot, checker.inputs().joints()->positions);
  }
  return checker.check(now);
}

/// Where shares are compared, or a link comes out of where it is hidden, more may be milder: see
/// docs/failures.md, Limits.
inline bool isByShare(Reason reason) {
  return reason == Reason::kOcclusion || reason == Reason::kOcclusionAhead ||
         reason == Reason::kUnseenAhead || reason == Reason::kEvidenceOld;
}

inline void requireNeverMilder(const std::string& what, const Verdict& one, const Verdict& more) {
  const std::string told = what + ": " + name(one.reason) + " (" + one.detail + ") becomes " +
                           name(more.reason) + " (" + more.detail + ")";
  promise(isByShare(one.reason) || more.level >= one.level, told);
  if (std::any_of(one.reasons.begin(), one.reasons.end(), isByShare)) return;
  promise(more.speed_scale <= one.speed_scale + 1e-9,
          told + ", scale " + std::to_string(one.speed_scale) + " becomes " +
              std::to_string(more.speed_scale));
}

inline void runMaps(const std::string& input) {
  ByteReader bytes(input);
  const MapScene scene = fuzzedScene(bytes);
  CuboidMap map = fuzzedMap();
  Duration age{0};
  fuzzFlags(bytes, map, age);
  addCuboids(bytes, 6, map);
  const Verdict one = judged(scene, map, age, {});
  CuboidMap more = map;
  addCuboids(bytes, 6, more);
  requireNeverMilder("more cuboids", one, judged(scene, more, age, {}));
  std::vector<KeepOutRegion> regions;
  for (std::size_t i = bytes.count(2); i > 0; --i) {
    KeepOutRegion region{"r" + std::to_string(i), "", Box{Vector3::Zero()}};
    for (int k = 0; k < 3; ++k) region.box.half_extents[k] = bytes.uniform(0.005, 0.15);
    region.T_frame_box.linear() =
        Eigen::AngleAxisd(bytes.uniform(-3.0, 3.0), Vector3::UnitZ()).toRotationMatrix();
    region.T_frame_box.translation() << bytes.uniform(-0.2, 1.2), bytes.uniform(-0.6, 0.5),
        bytes.uniform(0.3, 0.7);
    regions.push_back(region);
  }
  if (!regions.empty()) {
    requireNeverMilder("more regions", one, judged(scene, map, age, regions));
  }
}

/// What the verdicts on a map and on more broke of their promises, or nothing.
inline std::string mapsDefect(const std::string& input) {
  return brokenPromise([&] { runMaps(input); });
}

}  // namespace tccm::test
