#pragma once

#include <memory>
#include <string>
#include <vector>

#include "fuzz/fuzzed_mapper.h"
#include "fuzz/mapped_union.h"
#include "scan/cloud_stage.h"
#include "support/tiny_robot.h"

/// What the fuzz target of clouds and the test of its corpus do with an input: how the map is
/// configured, and the clouds of a camera or lidar with the poses of its sensor.
namespace tccm::test {

/// As CloudReader leaves it: sizes and times fit each other, points may be anything.
inline void timePoints(ByteReader& bytes, Cloud& cloud) {
  if (!bytes.flag()) return;
  const double span = bytes.uniform(0.0, 0.1), first = bytes.uniform(-0.05, 0.05);
  bool any = false;
  for (const Eigen::Vector3f& point : cloud.points) {
    cloud.offsets_s.push_back(static_cast<float>(first + span * bytes.byte() / 255.0));
    if (!isMeasured(point)) continue;
    const auto offset = static_cast<double>(cloud.offsets_s.back());
    cloud.first_offset_s = any ? std::min(cloud.first_offset_s, offset) : offset;
    cloud.last_offset_s = any ? std::max(cloud.last_offset_s, offset) : offset;
    any = true;
  }
}

/// A camera's frame or a lidar's turn, from 0.1 to 0.7 m; some of its points are none.
inline Cloud fuzzedCloud(ByteReader& bytes, Time stamp) {
  Cloud cloud;
  cloud.stamp = stamp;
  cloud.height = bytes.flag() ? 1 + bytes.count(5) : 1;
  cloud.width = 1 + bytes.count(cloud.organised() ? 7 : 40);
  const double pitch = bytes.number(0.02, 0.1);
  for (std::size_t i = 0; i < cloud.width * cloud.height; ++i) {
    const double range = bytes.number(0.1, 0.7);
    const auto angle = static_cast<double>(i);
    const double u = pitch * (static_cast<double>(i % cloud.width) - 3.0);
    const double v = pitch * (static_cast<double>(i / cloud.width) - 2.0);
    const Vector3 direction =
        cloud.organised() ? Vector3(u, v, 1.0).normalized()
                          : Vector3(std::cos(angle + u), std::sin(angle + u), 1.0).normalized();
    cloud.points.push_back((range * direction).cast<float>());
    if (bytes.seldom()) {
      cloud.points.back()[static_cast<int>(bytes.count(2))] =
          static_cast<float>(bytes.number(-1.0, 1.0));
    }
  }
  timePoints(bytes, cloud);
  return cloud;
}

/// What is taken was measured within the limits, and lies where the sensor saw it.
inline void requirePoints(const Cloud& cloud, const CloudStage::Config& config,
                          const PosePath& path, const CloudStage& stage) {
  const std::vector<BeamKind>& kinds = stage.kinds();
  const std::vector<Vector3>& points = stage.returns().points;
  promise(kinds.size() == cloud.points.size(), "a point has no kind");
  BeamCounts counts{};
  std::size_t taken = 0;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    ++counts.at(static_cast<std::size_t>(kinds[i]));
    const double range = cloud.points[i].cast<double>().norm();
    const bool is_within = range > 1e-18 &&  // at 0 there is no measurement
                           range >= config.range_min_m * (1.0 + 1e-6) &&
                           range <= config.range_max_m * (1.0 - 1e-6);
    const bool is_outside =
        !(range >= config.range_min_m * (1.0 - 1e-6) && range <= config.range_max_m * (1.0 + 1e-6));
    const bool is_none = kinds[i] == BeamKind::kUnknown || kinds[i] == BeamKind::kTooClose;
    promise(!is_within || !is_none, "a point that was measured says nothing");
    promise(!is_outside || is_none, "a point that was not measured says something");
    if (kinds[i] != BeamKind::kReturn) continue;
    const Vector3& p_fixed = points.at(taken++);
    const Time time =
        cloud.stamp +
        fromSeconds(cloud.offsets_s.empty() ? 0.0 : static_cast<double>(cloud.offsets_s[i]));
    const Pose from = *path.at(cloud.first()), to = *path.at(cloud.last());
    const auto pose = path.at(std::clamp(time, cloud.first(), cloud.last()));
    // Placed to a quarter of a millisecond.
    const double share =
        std::min(1.0, 3e-4 / std::max(1e-9, toSeconds(cloud.last() - cloud.first())));
    const double moved = share * displacement(from, to, range);
    const Vector3 expected = *pose * cloud.points[i].cast<double>();
    promise((p_fixed - expected).norm() <= moved + 1e-5 * (1.0 + pose->translation().norm()),
            "a point is not where it was seen");
  }
  promise(taken == points.size(), "there are more points than returns");
  promise(counts == stage.counts(), "points are miscounted");
  for (const Look& look : stage.returns().looks) {
    promise(look.end.allFinite() && look.viewpoint.allFinite(), "a look is not finite");
  }
}

inline CloudStage::Config fuzzedCloudStage(ByteReader& bytes) {
  CloudStage::Config config;
  config.range_min_m = bytes.oneOf({0.05, 0.0, 0.3});
  config.range_max_m = bytes.oneOf({2.0, 0.6});
  config.thinning.spacing_m = bytes.oneOf({0.0, 0.1});
  config.flying.separation_m = bytes.oneOf({0.0, 0.02});
  config.support.points_min = bytes.oneOf<std::size_t>({1, 3});
  config.looks.block_rad = bytes.oneOf({0.05, 0.2});
  return config;
}

inline void feedJoints(ByteReader& bytes, CloudStage& stage, Time stamp) {
  const double slide = bytes.number(-0.1, 0.2);
  for (int ms = -160; ms <= 160; ms += 80) {
    stage.addJoints(stamp + std::chrono::seconds(1), stamp + std::chrono::milliseconds(ms),
                    {"slide", "glide"}, {slide, 0.0}, {});
  }
}

inline void runClouds(const std::string& input) {
  ByteReader bytes(input);
  const Mapper::Config config = fuzzedMapper(bytes);
  const CloudStage::Config stage_config = fuzzedCloudStage(bytes);
  static const std::shared_ptr<const RobotModel> robot = sliderModel();
  const bool has_robot = bytes.flag();
  CloudStage stage(stage_config, has_robot ? robot : nullptr);
  Mapper mapper(config);
  MappedUnion expected(config);
  CuboidMap map;
  Time stamp{std::chrono::seconds(100)};
  Pose down(Eigen::AngleAxisd(M_PI, Vector3::UnitY()));
  down.pretranslate(Vector3(0.0, 0.0, 0.55));
  for (int i = 0; i < 12 && !bytes.isEmpty(); ++i) {
    stamp += bytes.step(10, 60);
    const Cloud cloud = fuzzedCloud(bytes, stamp);
    const PosePath path = fuzzedPath(bytes, cloud.first(), cloud.last(), down, 0.1);
    if (has_robot) feedJoints(bytes, stage, stamp);
    PosePath root;
    root.add(stamp - std::chrono::seconds(1), Pose::Identity());
    root.add(stamp + std::chrono::seconds(1), Pose::Identity());
    const std::string dropped = stage.assemble(cloud, path, {root});
    if (!dropped.empty()) {
      promise(dropped == "no_transform" || dropped == "blind" || dropped == "no_joint_states",
              "a cloud is dropped as '" + dropped + "'");
      continue;
    }
    requirePoints(cloud, stage_config, path, stage);
    expected.follow(stage.returns(), mapper.add(stage.returns()), mapper);
    mapper.snapshot(map);
    expected.require(map);
  }
}

/// What clouds and the map made of them broke of their promises, or nothing.
inline std::string cloudsDefect(const std::string& input) {
  return brokenPromise([&] { runClouds(input); });
}

}  // namespace tccm::test
