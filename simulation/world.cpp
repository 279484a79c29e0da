#include "simulation/world.h"

#include <algorithm>
#include <cmath>

#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

const Eigen::Vector3f kWood(0.72F, 0.53F, 0.34F);
const Eigen::Vector3f kGrey(0.55F, 0.55F, 0.55F);
const Eigen::Vector3f kWhite(0.90F, 0.90F, 0.92F);
const Eigen::Vector3f kGreen(0.20F, 0.60F, 0.35F);
const Eigen::Vector3f kBlue(0.25F, 0.45F, 0.80F);
const Eigen::Vector3f kYellow(0.90F, 0.75F, 0.25F);

Shape box(double x, double y, double z) { return Box{0.5 * Vector3(x, y, z)}; }
Shape cylinder(double radius, double length) { return Cylinder{radius, 0.5 * length}; }

World floorOnly() { return {{"floor", box(8.0, 8.0, 0.1), at(0.0, 0.0, -0.05), kGrey}}; }

void addTable(World& world) {
  for (const SceneObject& part : bareTable()) world.push_back(part);
}

void addTableware(World& world) {
  world.push_back({"mug", cylinder(0.04, 0.10), at(0.66, 0.12, kTableTop + 0.05), kWhite});
  world.push_back({"mug", box(0.012, 0.04, 0.06), at(0.66, 0.175, kTableTop + 0.05), kWhite});
  world.push_back({"bottle", cylinder(0.035, 0.18), at(0.82, 0.32, kTableTop + 0.09), kGreen});
  world.push_back({"bottle", cylinder(0.014, 0.07), at(0.82, 0.32, kTableTop + 0.215), kGreen});
  Pose box_pose = at(0.62, 0.50, kTableTop + 0.06);
  box_pose.rotate(Eigen::AngleAxisd(0.4, Vector3::UnitZ()));
  world.push_back({"box", box(0.18, 0.10, 0.12), box_pose, kYellow});
  world.push_back({"can", cylinder(0.033, 0.115), at(0.72, -0.57, kTableTop + 0.0575), kBlue});
}

void addShelf(World& world) {
  constexpr double kFront = 0.95;
  constexpr double kDepth = 0.30;
  constexpr double kBoard = 0.02;
  constexpr double kMiddle = kFront + 0.5 * kDepth;
  for (const double y : {-0.44, 0.44}) {
    world.push_back({"shelf", box(kDepth, kBoard, 1.20), at(kMiddle, y, 0.60), kWood});
  }
  for (const double z : {0.05, 0.42, 0.70, 0.90, 1.19}) {
    world.push_back({"shelf", box(kDepth, 0.86, kBoard), at(kMiddle, 0.0, z), kWood});
  }
  world.push_back({"shelf", box(0.01, 0.86, 1.20), at(kFront + kDepth - 0.005, 0.0, 0.60), kWood});
}

/// Pulled out by 0.20 m, on the left half of the shelf.
void addDrawer(World& world) {
  constexpr double kMiddle = 0.88;
  constexpr double kY = 0.22;
  world.push_back({"drawer", box(0.26, 0.38, 0.01), at(kMiddle, kY, 0.725), kWhite});
  world.push_back({"drawer", box(0.015, 0.40, 0.15), at(kMiddle - 0.13, kY, 0.80), kWhite});
  for (const double y : {kY - 0.185, kY + 0.185}) {
    world.push_back({"drawer", box(0.26, 0.01, 0.13), at(kMiddle, y, 0.79), kWhite});
  }
}

}  // namespace

Time Entrance::arrives() const {
  return offset.isZero() ? appears : appears + fromSeconds(offset.norm() / speed_mps);
}

Time Departure::gone() const { return leaves + fromSeconds(offset.norm() / speed_mps); }

Vector3 Shuttle::offsetAt(Time stamp) const {
  if (stamp <= starts) return Vector3::Zero();
  const double length = offset.norm();
  const double way = std::fmod(toSeconds(stamp - starts) * speed_mps, 2.0 * length);
  return std::min(way, 2.0 * length - way) / length * offset;
}

std::optional<Pose> SceneObject::poseAt(Time stamp) const {
  if (entrance && stamp < entrance->appears) return std::nullopt;
  if (departure && stamp >= departure->gone()) return std::nullopt;
  Pose pose = T_fixed_shape;
  if (shuttle) pose.pretranslate(shuttle->offsetAt(stamp));
  if (departure && stamp > departure->leaves) {
    const double way = toSeconds(stamp - departure->leaves) * departure->speed_mps;
    pose.pretranslate(way * departure->offset.normalized());
  } else if (entrance && stamp < entrance->arrives()) {
    const double left = toSeconds(entrance->arrives() - stamp) * entrance->speed_mps;
    pose.pretranslate(left * entrance->offset.normalized());
  }
  return pose;
}

Body bodyOf(const World& world) {
  Body body;
  for (const SceneObject& part : world) {
    body.shapes.push_back(part.shape);
    body.poses.push_back(part.T_fixed_shape);
  }
  return body;
}

World bareTable() {
  World world;
  world.push_back({"table", box(0.50, 1.40, 0.03), at(0.70, 0.0, 0.735), kWood});
  for (const double x : {0.50, 0.90}) {
    for (const double y : {-0.65, 0.65}) {
      world.push_back({"table", cylinder(0.02, 0.72), at(x, y, 0.36), kGrey});
    }
  }
  return world;
}

Pose at(double x, double y, double z) { return Pose(Eigen::Translation3d(x, y, z)); }

std::vector<std::string> sceneNames() { return {"table", "shelf", "empty"}; }

World scene(const std::string& name) {
  World world = floorOnly();
  if (name == "table") {
    addTable(world);
    addTableware(world);
  } else if (name == "shelf") {
    addShelf(world);
    addDrawer(world);
  } else if (name != "empty") {
    throw ConfigError("scene: " + name + " is none of table, shelf, empty");
  }
  return world;
}

}  // namespace tccm::simulation
