#include "scan/assembled_scan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/line_of.h"

namespace tccm {
namespace {

constexpr double kNoRange = 0.01;  // [m]
constexpr Duration kLongestScan = std::chrono::seconds(1);

BeamKind kindOf(float range, const LaserScan& scan) {
  if (std::isnan(range)) return BeamKind::kUnknown;
  if (range < scan.range_min || range == 0.0F) return BeamKind::kTooClose;
  // The stored limit is a float made double: compare on the float's side of it.
  const auto range_max = static_cast<float>(scan.range_max);
  if (range < range_max) return BeamKind::kReturn;
  return range == range_max || std::isinf(range) ? BeamKind::kNoReturn : BeamKind::kUnknown;
}

double rangeOf(BeamKind kind, float measured, const LaserScan& scan) {
  if (kind == BeamKind::kReturn) return static_cast<double>(measured);
  return kind == BeamKind::kNoReturn ? scan.range_max : kNoRange;
}

/// Drivers round, and count the last beam or not: one increment more or less is no contradiction.
std::string defectOfAngles(const LaserScan& scan) {
  constexpr double kRounding = 1e-4;  // [rad]
  const double begin = scan.angle_min, step = scan.angle_increment;
  const double said = scan.angle_max.value_or(begin);
  if (!std::isfinite(begin) || !std::isfinite(step) || !std::isfinite(said)) {
    return "angle_min, angle_max or angle_increment is not finite";
  }
  const std::size_t beams = scan.ranges.size();
  if (beams == 1 && step == 0.0) return {};
  if (step == 0.0) return "angle_increment is 0: all beams would go one way";
  const double end = begin + static_cast<double>(beams - 1) * step;
  if (!std::isfinite(end)) return "the angle of its last beam is not finite";
  if (!scan.angle_max || std::abs(said - end) <= 1.01 * std::abs(step) + kRounding) return {};
  return lineOf(
      "angle_min %.4f rad and %zu beams, angle_increment %.6f rad apart, end at %.4f rad, but "
      "angle_max is %.4f: at most one increment between them",
      begin, beams, step, end, said);
}

/// Where the beams of scans of one kind leave: it is the same scan after scan.
class Fan {
 public:
  const std::vector<Eigen::Vector2d>& directionsOf(const LaserScan& scan) {
    const bool is_same = scan.angle_min == angle_min_ && scan.angle_increment == angle_increment_;
    if (!is_same) directions_.clear();
    angle_min_ = scan.angle_min;
    angle_increment_ = scan.angle_increment;
    while (directions_.size() < scan.ranges.size()) {
      const double angle = angle_min_ + static_cast<double>(directions_.size()) * angle_increment_;
      directions_.emplace_back(std::cos(angle), std::sin(angle));
    }
    return directions_;
  }

 private:
  double angle_min_ = 0.0, angle_increment_ = 0.0;
  std::vector<Eigen::Vector2d> directions_;
};

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
  if (scan.ranges.size() > max_beams) {
    return lineOf("it has %zu beams, scan_beams_max is %zu", scan.ranges.size(), max_beams);
  }
  std::string angles = defectOfAngles(scan);
  if (!angles.empty()) return angles;
  // Ranges are floats.
  constexpr double kRangeMost = std::numeric_limits<float>::max();
  if (!(scan.range_min >= 0.0) || !(scan.range_max > scan.range_min) ||
      !(scan.range_max <= kRangeMost)) {
    return lineOf("range_min %.3g and range_max %.3g m contradict each other", scan.range_min,
                  scan.range_max);
  }
  if (scan.time_increment < Duration::zero()) return "time_increment is negative";
  if (scan.lastBeamTime() - scan.stamp > kLongestScan) {
    return lineOf("it takes %.1f s, at most 1 s is believed; see time_increment",
                  toSeconds(scan.lastBeamTime() - scan.stamp));
  }
  return {};
}

bool project(const LaserScan& scan, const PosePath& T_fixed_sensor, AssembledScan& result) {
  result.stamp = scan.stamp;
  result.beams.clear();
  if (!T_fixed_sensor.covers(scan.stamp, scan.lastBeamTime())) return false;
  thread_local Fan fan;  // reused
  const std::vector<Eigen::Vector2d>& directions = fan.directionsOf(scan);
  Pose pose = *T_fixed_sensor.at(scan.stamp);
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    Beam beam;
    beam.stamp = scan.beamTime(i);
    if (scan.time_increment > Duration::zero() && i > 0) pose = *T_fixed_sensor.at(beam.stamp);
    beam.kind = kindOf(scan.ranges[i], scan);
    const double range = rangeOf(beam.kind, scan.ranges[i], scan);
    beam.p_fixed = pose * Vector3(range * directions[i].x(), range * directions[i].y(), 0.0);
    beam.viewpoint = pose.translation();
    beam.tilt = elevationOfX(pose);
    result.beams.push_back(beam);
  }
  return true;
}

}  // namespace tccm
