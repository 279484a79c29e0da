#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "check/check_inputs.h"
#include "check/checker_config.h"
#include "fuzz/byte_reader.h"
#include "fuzz/promises.h"
#include "geometry/distance.h"
#include "support/look_around.h"
#include "support/placed.h"
#include "support/small_map.h"
#include "support/tiny_robot.h"

/// A small robot before a small map, for the fuzz targets that ask a checker.
namespace tccm::test {

/// Balls of 50 mm half a metre high: "hand" slides along x from -0.5 to 1.0 m, "follower" by half
/// of it at y = 0.3, and "arm" turns without limits about (0.3, -0.3), 0.2 m away.
inline std::shared_ptr<const RobotModel> fuzzedRobot() {
  static const std::shared_ptr<const RobotModel> robot = modelOf(
      robotOf(linkOf("base") + ballLink("hand") + ballLink("follower") +
              linkOf("arm", collisionOf(sphereOf("0.05"), "0.2 0 0")) +
              jointOf("slide", "prismatic", "base", "hand",
                      "<origin xyz=\"0 0 0.5\"/>" + axisOf("1 0 0") + limitOf("-0.5", "1.0")) +
              jointOf("follow", "prismatic", "base", "follower",
                      "<origin xyz=\"0 0.3 0.5\"/>" + axisOf("1 0 0") + limitOf("-5", "5") +
                          "<mimic joint=\"slide\" multiplier=\"0.5\"/>") +
              jointOf("turn", "continuous", "base", "arm",
                      "<origin xyz=\"0.3 -0.3 0.5\"/>" + axisOf("0 0 1"))));
  return robot;
}

constexpr double kFuzzedPadding = 0.03;  // [m]
constexpr double kFuzzedRadius = 0.05;   // [m] of each ball

/// Nothing holds, and coarse pictures.
inline Checker::Config fuzzedChecker() {
  Checker::Config config;
  config.pose.collision_use.expansion.padding_m = kFuzzedPadding;
  config.pose.occlusion.resolution_rad = 0.1;
  config.permission.hold_until_reset = false;
  config.permission.release_checks = 1;
  config.permission.speed_scale_rise_per_s = 1000.0;
  return config;
}

/// 29 x 23 cells from (-0.2, -0.6) on, up to 0.8 m, whose sensor looks everywhere from above and
/// meets nothing.
inline CuboidMap fuzzedMap() {
  static const CuboidMap empty = [] {
    Grid::Config grid = smallGrid(1.45, 1.15, 0.8);
    grid.origin_x_m = -0.2;
    grid.origin_y_m = -0.6;
    grid.cell_size_m = 0.05;
    CuboidMap map;
    map.grid = Grid(grid);
    map.looks = LookImage(0.15);
    map.serial = map.window_scans = 1;
    map.complete = true;
    map.thickness = 20;
    map.viewpoint = Vector3(0.3, 0.0, 1.5);
    indexCells(map);
    lookAround(map);
    return map;
  }();
  return empty;
}

/// The same cuboids, seen and looked at just now. Another image would take longer than all else.
inline std::shared_ptr<CuboidMap> seenAt(const CuboidMap& map, Time stamp, std::uint32_t serial) {
  static const CuboidMap looked = fuzzedMap();
  auto copy = std::make_shared<CuboidMap>(map);
  copy->stamp = stamp;
  copy->serial = serial;
  copy->looks.begin(stamp - std::chrono::milliseconds(500), looked.looks.viewpoint());
  for (int row = looked.looks.rowBegin(); row < looked.looks.rowEnd(); ++row) {
    for (int column = 0; column < looked.looks.grid().columns(); ++column) {
      copy->looks.edit(row, column) = looked.looks.passes(looked.looks.grid().index(row, column));
    }
  }
  return copy;
}

inline bool meets(const Cuboid& a, const Cuboid& b) {
  return a.cell == b.cell && a.bottom <= b.top && b.bottom <= a.top;
}

/// About as high as the robot's balls are; what meets one of the map is left out.
inline void addCuboids(ByteReader& bytes, std::size_t most, CuboidMap& map) {
  for (std::size_t i = bytes.count(most); i > 0; --i) {
    Cuboid cuboid;
    cuboid.cell = static_cast<CellIndex>(bytes.count(map.grid.cells() - 1));
    cuboid.bottom = static_cast<Height>(bytes.count(790));
    cuboid.top = static_cast<Height>(
        std::min<std::size_t>(800, static_cast<std::size_t>(cuboid.bottom) + 1 + bytes.count(200)));
    cuboid.points = static_cast<std::uint32_t>(1 + bytes.count(5));
    const std::uint8_t kind = bytes.byte();
    cuboid.held = (kind & 7U) == 1;
    cuboid.appeared = (kind & 7U) == 2;
    if (cuboid.held) cuboid.unseen_ms = static_cast<std::uint32_t>(bytes.count(5000));
    const auto& all = map.cuboids;
    if (std::any_of(all.begin(), all.end(),
                    [&](const Cuboid& other) { return meets(cuboid, other); })) {
      continue;
    }
    map.appeared += cuboid.appeared ? 1 : 0;
    map.cuboids.push_back(cuboid);
  }
  std::sort(map.cuboids.begin(), map.cuboids.end(), [](const Cuboid& a, const Cuboid& b) {
    return a.cell != b.cell ? a.cell < b.cell : a.bottom < b.bottom;
  });
  indexCells(map);
}

/// Where the balls are, by the text above [m].
inline std::vector<Vector3> ballsAt(double slide, double turn) {
  return {{slide, 0.0, 0.5},
          {0.5 * slide, 0.3, 0.5},
          {0.3 + 0.2 * std::cos(turn), -0.3 + 0.2 * std::sin(turn), 0.5}};
}

/// Of the balls to cuboids that count whatever lies beside them; infinite where there are none.
inline double nearestOf(const CuboidMap& map, const std::vector<Vector3>& balls) {
  double nearest = INFINITY;
  for (const Cuboid& cuboid : map.cuboids) {
    if (cuboid.points < 3) continue;
    for (const Vector3& ball : balls) {
      nearest = std::min(nearest, map.box(cuboid).exteriorDistance(ball) - kFuzzedRadius);
    }
  }
  return nearest;
}

/// What holds of every verdict, whatever was fed.
inline void requireVerdict(const Verdict& verdict) {
  const std::string reason = name(verdict.reason);
  promise(verdict.level == levelOf(verdict.reason) || verdict.level == Level::kSlow ||
              (verdict.reason == Reason::kUnseenAhead && verdict.level == Level::kStop),
          reason + " is of another level");
  promise(verdict.stop == (verdict.level >= Level::kStop), reason + ": level and stop differ");
  promise(verdict.speed_scale >= 0.0 && verdict.speed_scale <= 1.0, reason + ": no scale");
  promise(!verdict.stop || verdict.speed_scale == 0.0, reason + ": it stops at a speed");
  promise(verdict.detail.empty() == (verdict.reason == Reason::kClear), reason + ": its detail");
  if (!verdict.detail.empty()) requireOneLine(verdict.detail);
  const bool is_fault = verdict.level == Level::kFault || verdict.reason == Reason::kInit;
  promise(!is_fault || !verdict.known, reason + " is known");
  promise(verdict.stop || verdict.known, reason + ": it goes without knowing");
  promise(verdict.stop || verdict.level == Level::kSlow ||
              !(verdict.collision || verdict.occlusion || verdict.keep_out),
          reason + ": it is clear of what was found");
  for (const LinkVisibility& link : verdict.now.links) {
    const double sum = link.visible_fraction + link.occluded_fraction + link.unseen_fraction;
    promise(link.visible_fraction >= 0.0 && link.occluded_fraction >= 0.0 &&
                link.unseen_fraction >= 0.0 && std::abs(sum - 1.0) < 1e-6,
            "a link's fractions are none");
  }
  promise(verdict.governed_scale >= 0.0 && verdict.governed_scale <= 1.0, "no governed scale");
}

/// By its name.
inline std::size_t variableOf(const RobotModel& model, const std::string& name) {
  std::size_t v = 0;
  while (model.variables().at(v).name != name) ++v;
  return v;
}

/// Where the balls are when the robot's variables are there.
inline std::vector<Vector3> ballsAt(const RobotModel& model, const std::vector<double>& positions) {
  return ballsAt(positions.at(variableOf(model, "slide")), positions.at(variableOf(model, "turn")));
}

/// What touches is found; contacts name what there is.
inline void requireContacts(const Verdict& verdict, const CuboidMap& map, const RobotModel& model,
                            const std::vector<double>& positions) {
  for (const PoseFindings* found : {&verdict.now, &verdict.ahead}) {
    for (const Contact& contact : found->contacts) {
      promise(contact.shape < model.shapes().size(), "a contact is of no shape");
      promise(contact.cuboid < map.cuboids.size(), "a contact is with no cuboid");
    }
  }
  const double free_m = nearestOf(map, ballsAt(model, positions)) - kFuzzedPadding;
  promise(free_m > -1e-6 || verdict.collision, "a contact is not found");
  promise(free_m > -1e-6 || verdict.level >= Level::kSlow, "a contact is clear");
  for (const LinkClearance& clearance : verdict.clearances) {
    promise(clearance.distance_m >= 0.0, "a clearance is negative");
    promise(clearance.is_region || !std::isfinite(clearance.distance_m) ||
                clearance.cuboid < map.cuboids.size(),
            "a clearance is to no cuboid");
  }
}

}  // namespace tccm::test
