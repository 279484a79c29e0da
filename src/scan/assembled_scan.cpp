#include "scan/assembled_scan.h"

#include <algorithm>
#include <cmath>

namespace tccm {
namespace {

constexpr double kNoRange = 0.01;  // [m]
constexpr Duration kLongestScan = std::chrono::seconds(1);

BeamKind kindOf(float range, const LaserScan& scan) {
  if (std::isnan(range)) return BeamKind::kUnknown;
  if (range < scan.range_min || range == 0.0F) return BeamKind::kTooClose;
  // The stored limit is a float made double: compare on the float's side of it.
  if (range >= static_cast<float>(scan.range_max)) return BeamKind::kNoReturn;
  return BeamKind::kReturn;
}

double rangeOf(BeamKind kind, float measured, const LaserScan& scan) {
  if (kind == BeamKind::kReturn) return static_cast<double>(measured);
  return kind == BeamKind::kNoReturn ? scan.range_max : kNoRange;
}

double elevationOfX(const Pose& T_fixed_sensor) {
  return std::asin(std::clamp(T_fixed_sensor.linear()(2, 0), -1.0, 1.0));
}

}  // namespace

BeamCounts AssembledScan::counts() const {
  BeamCounts counts{};
  for (const Beam& beam : beams) ++counts[static_cast<std::size_t>(beam.kind)];
  return counts;
}

std::string defectOf(const LaserScan& scan, std::size_t max_beams) {
  if (scan.ranges.empty()) return "it has no beams";
  if (scan.ranges.size() > max_beams) return "it has more beams than scan_beams_max";
  if (!std::isfinite(scan.angle_min) || !std::isfinite(scan.angle_increment)) {
    return "angle_min or angle_increment is not finite";
  }
  if (scan.ranges.size() > 1 && scan.angle_increment == 0.0) {
    return "angle_increment is 0: all beams would go one way";
  }
  if (!(scan.range_min >= 0.0) || !(scan.range_max > scan.range_min) ||
      !std::isfinite(scan.range_max)) {
    return "range_min and range_max contradict each other";
  }
  if (scan.time_increment < Duration::zero()) return "time_increment is negative";
  if (scan.lastBeamTime() - scan.stamp > kLongestScan) return "it takes longer than a second";
  return {};
}

bool project(const LaserScan& scan, const PosePath& T_fixed_sensor, AssembledScan& result) {
  result.stamp = scan.stamp;
  result.beams.clear();
  if (!T_fixed_sensor.covers(scan.stamp, scan.lastBeamTime())) return false;
  Pose pose = *T_fixed_sensor.at(scan.stamp);
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    Beam beam;
    beam.stamp = scan.beamTime(i);
    if (scan.time_increment > Duration::zero() && i > 0) pose = *T_fixed_sensor.at(beam.stamp);
    const double angle = scan.angle_min + static_cast<double>(i) * scan.angle_increment;
    beam.kind = kindOf(scan.ranges[i], scan);
    const double range = rangeOf(beam.kind, scan.ranges[i], scan);
    beam.p_fixed = pose * Vector3(range * std::cos(angle), range * std::sin(angle), 0.0);
    beam.viewpoint = pose.translation();
    beam.tilt = elevationOfX(pose);
    result.beams.push_back(beam);
  }
  return true;
}

}  // namespace tccm
