#pragma once

#include <algorithm>
#include <cmath>
#include <deque>
#include <set>
#include <string>
#include <vector>

#include "fuzz/fuzzed_checker.h"
#include "fuzz/mapped_union.h"
#include "monitor_config.h"

/// What the fuzz target of attached objects and the test of its corpus do with an input: scans, and
/// objects of any shape at any place that the robot takes and lets go of.
namespace tccm::test {

inline Shape fuzzedShape(ByteReader& bytes) {
  const auto size = [&bytes] { return bytes.number(0.01, 0.15); };
  const double first = size(), second = size(), third = size();
  switch (bytes.count(3)) {
    case 0:
      return Sphere{first};
    case 1:
      return Box{Vector3(first, second, third)};
    case 2:
      return Cylinder{first, second};
    default:
      return Capsule{first, second};
  }
}

inline AttachedObject fuzzedObject(ByteReader& bytes) {
  AttachedObject object;
  object.name = bytes.oneOf<const char*>({"cup", "pan", "lid", ""});
  object.link = bytes.oneOf<const char*>({"hand", "arm", "base", "follower", "nobody", ""});
  if (bytes.seldom()) object.name = bytes.text(4);
  if (bytes.seldom()) object.link = bytes.text(4);
  object.primitive = {fuzzedShape(bytes), bytes.pose(0.1)};
  return object;
}

/// Whether the rules allow it, in plain words.
inline bool isAllowed(const AttachedObject& object, double padding_m) {
  const std::set<std::string> links{"hand", "arm", "base", "follower"};
  if (object.name.empty() || links.count(object.link) == 0) return false;
  if (!(padding_m >= 0.0 && padding_m <= 1.0) || !isRigid(object.primitive.pose)) return false;
  const auto isLength = [](double value) { return value > 0.0 && value < INFINITY; };
  const Shape& shape = object.primitive.shape;
  double reach = 0.0;
  if (const auto* box = std::get_if<Box>(&shape)) {
    const Vector3& half = box->half_extents;
    if (!isLength(half.x()) || !isLength(half.y()) || !isLength(half.z())) return false;
    reach = half.norm();
  } else if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    if (!isLength(sphere->radius)) return false;
    reach = sphere->radius;
  } else if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    if (!isLength(cylinder->radius) || !isLength(cylinder->half_length)) return false;
    reach = std::hypot(cylinder->radius, cylinder->half_length);
  } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    const double half = capsule->half_length;
    if (!isLength(capsule->radius) || !(half >= 0.0 && half < INFINITY)) return false;
    reach = capsule->radius + half;
  }
  return object.primitive.pose.translation().norm() + reach <= 3.0;
}

/// Robot, sensor and what they are told.
class AttachingRobot {
 public:
  explicit AttachingRobot(ByteReader& bytes) : monitor_(configOf(bytes), fuzzedRobot()) {
    slide_ = bytes.uniform(-0.2, 0.9);
    monitor_.checker().setRootPose(0, Time(), Pose::Identity(), true);
    feedJoints();
  }

  void scan(ByteReader& bytes) {
    const bool is_late = bytes.seldom();
    if (!is_late) now_ += std::chrono::milliseconds(25);
    feedJoints();
    LaserScan scan;
    scan.stamp = now_;
    scan.range_min = 0.05;
    scan.range_max = 3.0;
    scan.angle_min = -0.4;
    scan.angle_increment = 0.1;
    for (int i = 0; i < 8; ++i) {
      scan.ranges.push_back(static_cast<float>(bytes.uniform(0.6, 1.4)));
    }
    Pose sensor(Eigen::AngleAxisd(M_PI / 2.0 + bytes.uniform(-0.3, 0.3), Vector3::UnitY()));
    sensor.pretranslate(Vector3(0.3, 0.0, 1.4));
    PosePath path, root;
    path.add(now_ - std::chrono::seconds(1), sensor);
    path.add(now_ + std::chrono::seconds(1), sensor);
    root.add(now_ - std::chrono::seconds(1), Pose::Identity());
    root.add(now_ + std::chrono::seconds(1), Pose::Identity());
    monitor_.scanArrived(now_, scan.stamp);
    if (!monitor_.addScan(now_, scan, path, {root}).dropped.empty()) return;
    parts_.emplace_back();
    for (const Vector3& point : monitor_.returns().points) parts_.back().push_back({point});
    if (parts_.size() > kWindow) parts_.pop_front();
    // What was being attached as it came is left out of a scan of the same stamp.
    for (const Forgotten& forgotten : forgotten_) {
      if (forgotten.until >= scan.stamp) forget(parts_.back(), forgotten, 0.0);
    }
  }

  void attach(const AttachedObject& object, double padding_m) {
    const std::vector<Run> before = live();
    const std::size_t revision = monitor_.checker().revision();
    const std::set<std::string> names = attachedNames();
    bool taken = true;
    try {
      monitor_.attach(now_, object, padding_m);
    } catch (const ConfigError& error) {
      requireOneLine(error.what());
      taken = false;
    }
    promise(taken == isAllowed(object, padding_m),
            taken ? "it takes what is not allowed" : "it refuses what is allowed");
    std::set<std::string> expected = names;
    if (taken) expected.insert(object.name);
    promise(attachedNames() == expected, "the robot holds something else");
    promise(taken || monitor_.checker().revision() == revision, "a refusal changes something");
    promise(taken || live() == before, "a refusal changes the map");
    if (!taken) return;
    const Pose T_fixed_object = poseOf(object.link) * object.primitive.pose;
    forgotten_.push_back({object.primitive.shape, T_fixed_object.inverse(), padding_m, now_});
    const Grid::Config grid = gridConfig();
    const double doubt = std::sqrt(2.0) * grid.cell_size_m + grid.height_quantum_m;
    for (std::vector<Point>& part : parts_) forget(part, forgotten_.back(), doubt);
  }

  void detach(const std::string& name) {
    const bool is_held = attachedNames().count(name) > 0;
    promise(monitor_.detach(name) == is_held, "it lets go of what it does not hold");
    promise(attachedNames().count(name) == 0, "it holds what it has let go of");
  }

  void require() {
    const RobotModel& model = *monitor_.checker().model();
    promise(model.shapes().size() == 3 + attachedNames().size(), "a shape is missing or left");
    requireMap();
    const Verdict& verdict = monitor_.checker().check(now_);
    requireVerdict(verdict);
    const CuboidMap* map = monitor_.checker().map();
    if (!verdict.placed) return;
    requireContacts(verdict, *map, model, monitor_.checker().inputs().joints()->positions);
    for (const AttachedObject& object : monitor_.checker().attached()) {
      const auto* sphere = std::get_if<Sphere>(&object.primitive.shape);
      if (!sphere) continue;
      const Vector3 centre = (poseOf(object.link) * object.primitive.pose).translation();
      const double free_m = nearestOf(*map, {centre}) + kFuzzedRadius - sphere->radius;
      promise(free_m > kFuzzedPadding - 1e-6 || verdict.collision, "what is held touches unseen");
    }
  }

 private:
  static constexpr std::size_t kWindow = 4;
  struct Point {
    Vector3 p_fixed;
    bool is_gone = false;      ///< it was in something that was taken
    bool may_be_gone = false;  ///< or so near to it that its cell does not tell
  };
  struct Forgotten {
    Shape shape;
    Pose T_shape_fixed;
    double padding_m;
    Time until;
  };

  static Grid::Config gridConfig() { return fuzzedMap().grid.config(); }
  static Monitor::Config configOf(ByteReader& bytes) {
    Monitor::Config config;
    Monitor::Config::Sensor& sensor = config.sensors.front();
    sensor.scan.self_filter = bytes.flag();
    sensor.scan.assembler.mixed_pixel.separation_m = 0.0;
    sensor.mapper.map.grid = gridConfig();
    sensor.mapper.map.returns_max = 1000;
    sensor.mapper.map.intervals_max = 1000;
    sensor.mapper.map.scans_max = 16;
    sensor.mapper.window_scans = kWindow;
    sensor.mapper.looks.resolution_rad = 0.15;
    sensor.mapper.hold.longest_s = bytes.flag() ? 1.0 : 0.0;
    sensor.mapper.hold.intervals_max = 1000;
    config.checker = fuzzedChecker();
    return config;
  }
  void feedJoints() {
    for (const int ms : {-30, 0, 20}) {
      monitor_.addJoints(now_, now_ + std::chrono::milliseconds(ms), {"slide", "turn"},
                         {slide_, 0.0}, {0.0, 0.0});
    }
  }
  [[nodiscard]] Pose poseOf(const std::string& link) const {
    Pose pose = Pose::Identity();
    if (link == "hand") pose.translation() = ballsAt(slide_, 0.0)[0];
    if (link == "follower") pose.translation() = ballsAt(slide_, 0.0)[1];
    if (link == "arm") pose.translation() << 0.3, -0.3, 0.5;
    return pose;
  }
  [[nodiscard]] std::set<std::string> attachedNames() const {
    std::set<std::string> names;
    for (const AttachedObject& object : monitor_.checker().attached()) {
      promise(names.insert(object.name).second, "an object is held twice");
    }
    return names;
  }
  [[nodiscard]] std::vector<Run> live() const {
    std::vector<Run> runs;
    if (!monitor_.map()) return runs;
    for (const Cuboid& c : monitor_.map()->cuboids) {
      if (!c.held) runs.push_back({c.cell, c.bottom, c.top, c.points});
    }
    return runs;
  }
  static void forget(std::vector<Point>& part, const Forgotten& forgotten, double doubt_m) {
    for (Point& point : part) {
      const double beyond =
          distance(forgotten.shape, forgotten.T_shape_fixed * point.p_fixed) - forgotten.padding_m;
      point.is_gone = point.is_gone || beyond <= -1e-9;
      point.may_be_gone = point.may_be_gone || beyond <= doubt_m + 1e-9;
    }
  }
  void requireMap() const {
    if (!monitor_.map()) return;
    requireWellFormed(*monitor_.map());
    std::deque<std::vector<MappedReturn>> least, most;
    for (const std::vector<Point>& part : parts_) {
      std::vector<Vector3> kept, left;
      for (const Point& point : part) {
        if (!point.is_gone) left.push_back(point.p_fixed);
        if (!point.is_gone && !point.may_be_gone) kept.push_back(point.p_fixed);
      }
      least.push_back(mappedReturns(monitor_.map()->grid, kept));
      most.push_back(mappedReturns(monitor_.map()->grid, left));
    }
    HeightSet seen, must_be, may_be;
    insertRuns(live(), seen);
    insertRuns(clippedAt(0, unionOf(least, 20)), must_be);
    insertRuns(clippedAt(0, unionOf(most, 20)), may_be);
    promise(std::includes(may_be.begin(), may_be.end(), seen.begin(), seen.end()),
            "what is in the hand is in the map");
    promise(std::includes(seen.begin(), seen.end(), must_be.begin(), must_be.end()),
            "what is not in the hand has left the map");
  }

  Monitor monitor_;
  double slide_ = 0.0;
  Time now_{std::chrono::seconds(100)};
  std::deque<std::vector<Point>> parts_;  ///< of the window
  std::vector<Forgotten> forgotten_;
};

inline void runAttachedObjects(const std::string& input) {
  ByteReader bytes(input);
  AttachingRobot robot(bytes);
  for (int i = 0; i < 24 && !bytes.isEmpty(); ++i) {
    const std::uint8_t kind = bytes.byte() & 7U;
    if (kind < 4) {
      robot.scan(bytes);
    } else if (kind < 7) {
      const AttachedObject object = fuzzedObject(bytes);
      robot.attach(object, bytes.number(0.0, 0.1));
    } else {
      robot.detach(bytes.oneOf<const char*>({"cup", "pan", "lid", ""}));
    }
    robot.require();
  }
}

/// What attached objects broke of the promises made about them, or nothing.
inline std::string attachedObjectsDefect(const std::string& input) {
  return brokenPromise([&] { runAttachedObjects(input); });
}

}  // namespace tccm::test
