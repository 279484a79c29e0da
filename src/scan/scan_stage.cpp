#include "scan/scan_stage.h"

namespace tccm {

Seen seenBy(BeamKind kind) {
  if (kind == BeamKind::kReturn) return Seen::kSurface;
  if (kind == BeamKind::kNoReturn) return Seen::kNothing;
  // It measured nothing, or its end lies between two surfaces or in the robot's shadow.
  return kind == BeamKind::kSelf ? Seen::kRobot : Seen::kUnclear;
}

void takeReturns(const AssembledScan& scan, ScanReturns& returns) {
  returns.stamp = scan.stamp;
  returns.tilt = scan.beams.front().tilt;
  returns.viewpoint = scan.beams.back().viewpoint;
  returns.points.clear();
  returns.looks.clear();
  for (const Beam& beam : scan.beams) {
    if (beam.kind == BeamKind::kReturn) returns.points.push_back(beam.p_fixed);
    returns.looks.push_back({beam.viewpoint, beam.p_fixed, seenBy(beam.kind)});
  }
}

void ScanStage::Config::describe(ParameterTable& table) {
  table.add("self_filter", &self_filter,
            "false: the robot is not filtered out, and need not be known");
  body.describe(table);
  assembler.describe(table);
  table.add("future_max_s", &future_max_s, "s", {0.0, 10.0},
            "a scan or joint state stamped further ahead is dropped");
}

ScanStage::ScanStage(const Config& config, std::shared_ptr<const RobotModel> model)
    : config_(validated(config)),
      robot_(config.body, config.self_filter ? std::move(model) : nullptr) {}

bool ScanStage::addJoints(Time now, Time stamp, const std::vector<std::string>& names,
                          const std::vector<double>& positions,
                          const std::vector<double>& velocities) {
  if (stamp - now > fromSeconds(config_.future_max_s)) return false;
  if (robot_.body()) robot_.body()->joints().add(stamp, names, positions, velocities);
  return true;
}

std::string ScanStage::assemble(const LaserScan& scan, const PosePath& T_fixed_sensor,
                                const std::vector<PosePath>& T_fixed_roots) {
  std::string unknown = robot_.sample(scan.stamp, scan.lastBeamTime(), T_fixed_roots);
  if (!unknown.empty()) return unknown;
  std::string dropped = config_.assembler.assemble(scan, T_fixed_sensor, robot_.samples(), scan_);
  if (dropped.empty()) robot_.count(scan_.self_counts);
  return dropped;
}

}  // namespace tccm
