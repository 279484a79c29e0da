#include "tccm_monitor/monitor.h"

#include "tccm_monitor/stopwatch.h"

namespace tccm {

void takeReturns(const AssembledScan& scan, ScanReturns& returns) {
  returns.stamp = scan.stamp;
  returns.tilt = scan.beams.front().tilt;
  returns.viewpoint = scan.beams.back().viewpoint;
  returns.points.clear();
  for (const Beam& beam : scan.beams) {
    if (beam.kind == BeamKind::kReturn) returns.points.push_back(beam.p_fixed);
  }
}

Monitor::Monitor(const Config& config, const std::string& urdf)
    : assembler_(config.assembler), mapper_(config.mapper) {
  if (urdf.empty()) return;
  if (config.self_filter) {
    body_ = std::make_unique<BodySampler>(
        std::make_shared<const RobotModel>(urdf, config.filtered_links), config.body);
  }
  checker_ = std::make_unique<Checker>(
      std::make_shared<const RobotModel>(urdf, config.checked_links), config.checker);
}

void Monitor::addJoints(Time stamp, const std::vector<std::string>& names,
                        const std::vector<double>& positions,
                        const std::vector<double>& velocities) {
  if (body_) body_->joints().add(stamp, names, positions, velocities);
  if (checker_) checker_->addJoints(stamp, names, positions, velocities);
}

void Monitor::reset() {
  if (body_) body_->joints().reset();
  mapper_.clear();
  if (checker_) checker_->reset();
  maps_ = {};
}

Monitor::ScanOutcome Monitor::addScan(Time now, const LaserScan& scan,
                                      const PosePath& T_fixed_sensor,
                                      const PosePath& T_fixed_root) {
  ScanOutcome outcome;
  Stopwatch stopwatch;
  static const std::vector<BodySample> kNobody;
  if (body_) {
    outcome.dropped = body_->sample(scan.stamp, scan.lastBeamTime(), T_fixed_root);
    if (!outcome.dropped.empty()) return outcome;
  }
  outcome.dropped =
      assembler_.assemble(scan, T_fixed_sensor, body_ ? body_->samples() : kNobody, assembled_);
  if (!outcome.dropped.empty()) return outcome;
  takeReturns(assembled_, returns_);
  outcome.beams = assembled_.counts();
  outcome.assemble_us = stopwatch.lapMicroseconds();
  const Mapper::Outcome mapped = mapper_.add(returns_);
  outcome.dropped = mapped.dropped;
  if (!outcome.dropped.empty()) return outcome;
  outcome.added = mapped.added;
  outcome.integrate_us = stopwatch.lapMicroseconds();
  newest_ = 1 - newest_;
  if (!maps_[newest_]) {
    maps_[newest_] = std::make_shared<CuboidMap>();
    mapper_.reserve(*maps_[newest_]);
  }
  mapper_.snapshot(*maps_[newest_]);
  outcome.snapshot_us = stopwatch.lapMicroseconds();
  if (checker_) checker_->setMap(now, maps_[newest_]);
  return outcome;
}

}  // namespace tccm
