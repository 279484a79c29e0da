#pragma once

#include <memory>
#include <string>
#include <vector>

#include "fuzz/fuzzed_mapper.h"
#include "fuzz/mapped_union.h"
#include "scan/scan_stage.h"
#include "support/tiny_robot.h"

/// What the fuzz target of a laser's scans and the test of its corpus do with an input: how the map
/// is configured, and scan after scan with the poses of its sensor.
namespace tccm::test {

/// By what REP 117 says of ranges.
inline bool isRangeWithin(float range, const LaserScan& scan) {
  return range > 0.0F && range >= scan.range_min && range < static_cast<float>(scan.range_max);
}

/// A scan as it is where nothing is wrong with it: 0.1 to 0.7 m from a sensor above the map.
inline LaserScan fuzzedScan(ByteReader& bytes, Time stamp) {
  LaserScan scan;
  scan.stamp = stamp;
  scan.range_min = bytes.number(0.01, 0.2);
  scan.range_max = bytes.number(0.5, 2.0);
  scan.angle_min = bytes.number(-0.5, 0.5);
  scan.angle_increment = bytes.number(0.01, 0.2);
  scan.time_increment =
      std::chrono::microseconds(bytes.oneOf({100, 0, 1000, 2000, 20000, 1000000, -1, -1000000}));
  for (std::size_t i = bytes.count(12); i > 0; --i) {
    scan.ranges.push_back(static_cast<float>(bytes.number(0.1, 0.7)));
  }
  if (bytes.flag()) return scan;
  scan.angle_max = bytes.seldom() ? bytes.number(-3.0, 3.0)
                                  : scan.angle_min + static_cast<double>(scan.ranges.size()) *
                                                         scan.angle_increment;
  return scan;
}

/// Every beam is where it was measured, and counted once.
inline void requireBeams(const LaserScan& scan, const ScanStage& stage) {
  const AssembledScan& assembled = stage.scan();
  promise(assembled.beams.size() == scan.ranges.size(), "a beam is missing");
  const BeamCounts counts = assembled.counts();
  std::size_t own = 0;
  for (const std::size_t count : assembled.self_counts) own += count;
  promise(own == counts[static_cast<std::size_t>(BeamKind::kSelf)], "self_counts do not add up");
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const Beam& beam = assembled.beams[i];
    promise(beam.measured() == isRangeWithin(scan.ranges[i], scan), "a beam is of a wrong kind");
    promise(beam.p_fixed.allFinite() && beam.viewpoint.allFinite(), "a beam is not finite");
    promise(std::isfinite(beam.tilt), "a tilt is not finite");
    if (!beam.measured()) continue;
    const double range = (beam.p_fixed - beam.viewpoint).norm();
    const double allowed = 1e-6 * (1.0 + beam.viewpoint.norm() + std::abs(scan.ranges[i]));
    promise(std::abs(range - scan.ranges[i]) <= allowed, "a beam does not end where it hit");
  }
  if (!stage.body()) return;
  for (const Beam& beam : assembled.beams) {
    if (beam.kind != BeamKind::kReturn) continue;
    const auto& samples = stage.body()->samples();
    promise(std::any_of(samples.begin(), samples.end(),
                        [&beam](const BodySample& sample) {
                          const Body& body = sample.body;
                          for (std::size_t k = 0; k < body.shapes.size(); ++k) {
                            const Vector3 p_shape = body.poses[k].inverse() * beam.p_fixed;
                            if (distance(body.shapes[k], p_shape) <= body.paddings_m[k]) {
                              return false;
                            }
                          }
                          return true;
                        }),
            "a return lies in the robot");
  }
}

inline void feedJoints(ByteReader& bytes, ScanStage& stage, Time stamp) {
  const double slide = bytes.number(-0.1, 0.2), glide = bytes.number(-0.1, 0.1);
  for (const Duration before : {Duration(std::chrono::milliseconds(20)), Duration(0),
                                -Duration(std::chrono::milliseconds(20))}) {
    stage.addJoints(stamp + std::chrono::seconds(1), stamp - before, {"slide", "glide"},
                    {slide, glide}, {});
  }
}

inline void runScans(const std::string& input) {
  ByteReader bytes(input);
  const Mapper::Config config = fuzzedMapper(bytes);
  ScanStage::Config stage_config;
  stage_config.assembler.mixed_pixel.separation_m = bytes.oneOf({0.0, 0.06, 0.5});
  stage_config.assembler.scan_beams_max = 10;
  static const std::shared_ptr<const RobotModel> robot = sliderModel();
  const bool has_robot = bytes.flag();
  ScanStage stage(stage_config, has_robot ? robot : nullptr);
  Mapper mapper(config);
  MappedUnion expected(config);
  CuboidMap map;
  ScanReturns returns;
  Time stamp{std::chrono::seconds(100)};
  Pose down(Eigen::AngleAxisd(M_PI / 2.0, Vector3::UnitY()));
  down.pretranslate(Vector3(0.0, 0.0, 0.5));
  for (int i = 0; i < 16 && !bytes.isEmpty(); ++i) {
    stamp += bytes.step(5, 60);
    const LaserScan scan = fuzzedScan(bytes, stamp);
    const PosePath path =
        fuzzedPath(bytes, scan.stamp, std::max(scan.stamp, scan.lastBeamTime()), down, 0.1);
    if (has_robot) feedJoints(bytes, stage, stamp);
    PosePath root;
    root.add(stamp - std::chrono::seconds(10), Pose::Identity());
    root.add(stamp + std::chrono::seconds(20), Pose::Identity());
    const std::string dropped = stage.assemble(scan, path, {root});
    if (!dropped.empty()) {
      promise(dropped == "malformed" || dropped == "no_transform" || dropped == "blind" ||
                  dropped == "no_joint_states",
              "a scan is dropped as '" + dropped + "'");
      requireOneLine(defectOf(scan, 10) + ".");
      continue;
    }
    promise(defectOf(scan, 10).empty(), "a malformed scan is assembled");
    requireBeams(scan, stage);
    takeReturns(stage.scan(), returns);
    expected.follow(returns, mapper.add(returns), mapper);
    mapper.snapshot(map);
    expected.require(map);
  }
}

/// What scans and the map made of them broke of their promises, or nothing.
inline std::string scansDefect(const std::string& input) {
  return brokenPromise([&] { runScans(input); });
}

}  // namespace tccm::test
