#include "monitor.h"

#include "base/stopwatch.h"
#include "tccm_monitor/config_error.h"

namespace tccm {

Look::End lookEndOf(BeamKind kind) {
  if (kind == BeamKind::kReturn) return Look::End::kSurface;
  if (kind == BeamKind::kNoReturn) return Look::End::kNothing;
  return kind == BeamKind::kSelf ? Look::End::kRobot : Look::End::kUnclear;
}

void takeReturns(const AssembledScan& scan, ScanReturns& returns) {
  returns.stamp = scan.stamp;
  returns.tilt = scan.beams.front().tilt;
  returns.viewpoint = scan.beams.back().viewpoint;
  returns.points.clear();
  returns.looks.clear();
  for (const Beam& beam : scan.beams) {
    if (beam.kind == BeamKind::kReturn) returns.points.push_back(beam.p_fixed);
    returns.looks.push_back({beam.viewpoint, beam.p_fixed, lookEndOf(beam.kind)});
  }
}

Monitor::Monitor(const Config& config, std::shared_ptr<const RobotModel> model)
    : assembler_(config.assembler), mapper_(config.mapper) {
  if (!model) return;
  if (config.self_filter) body_ = std::make_unique<BodySampler>(model, config.body);
  checker_ = std::make_unique<Checker>(std::move(model), config.checker);
}

void Monitor::addJoints(Time now, Time stamp, const std::vector<std::string>& names,
                        const std::vector<double>& positions,
                        const std::vector<double>& velocities) {
  if (body_) body_->joints().add(stamp, names, positions, velocities);
  if (checker_) checker_->addJoints(now, stamp, names, positions, velocities);
}

void Monitor::scanArrived(Time now, Time stamp) {
  if (checker_) checker_->inputs().addScanReport(now, {stamp, ScanReport::Outcome::kWaiting});
}

void Monitor::scanDropped(Time now, Time stamp, const std::string& reason) {
  if (!checker_) return;
  checker_->inputs().addScanReport(now, {stamp, ScanReport::Outcome::kDropped, reason});
}

void Monitor::reset() {
  if (body_) body_->joints().reset();
  mapper_.clear();
  if (checker_) checker_->startAnew();
  maps_ = {};
}

Monitor::ScanOutcome Monitor::addScan(Time now, const LaserScan& scan,
                                      const PosePath& T_fixed_sensor,
                                      const std::vector<PosePath>& T_fixed_roots) {
  ScanOutcome outcome = mapScan(scan, T_fixed_sensor, T_fixed_roots);
  if (!outcome.dropped.empty()) {
    scanDropped(now, scan.stamp, outcome.dropped);
    return outcome;
  }
  if (checker_) {
    checker_->inputs().addScanReport(now, {scan.stamp, ScanReport::Outcome::kAssembled});
  }
  Stopwatch stopwatch;
  publishMap(now);
  outcome.snapshot_us = stopwatch.lapMicroseconds();
  mapper_.settle();
  return outcome;
}

Monitor::ScanOutcome Monitor::mapScan(const LaserScan& scan, const PosePath& T_fixed_sensor,
                                      const std::vector<PosePath>& T_fixed_roots) {
  ScanOutcome outcome;
  Stopwatch stopwatch;
  static const std::vector<BodySample> kNobody;
  if (body_) {
    outcome.dropped = body_->sample(scan.stamp, scan.lastBeamTime(), T_fixed_roots);
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
  return outcome;
}

void Monitor::publishMap(Time now) {
  newest_ = 1 - newest_;
  if (!maps_[newest_]) {
    maps_[newest_] = std::make_shared<CuboidMap>();
    mapper_.reserve(*maps_[newest_]);
  }
  mapper_.snapshot(*maps_[newest_]);
  if (checker_) checker_->setMap(now, maps_[newest_]);
}

void Monitor::attach(Time now, const AttachedObject& object, double forget_padding_m) {
  const auto T_fixed_link = checker_->linkPose(now, object.link);
  if (!T_fixed_link) {
    throw ConfigError("object '" + object.name + "': link '" + object.link +
                      "' cannot be placed: joints or transforms are missing or too old");
  }
  const PlacedShape seen{object.primitive.shape, *T_fixed_link * object.primitive.pose};
  const Region region{{seen, forget_padding_m}};
  validate(region);
  checker_->attach(object);
  if (body_) body_->setModel(checker_->sharedModel());
  mapper_.forget(region, now);
  if (maps_[newest_]) publishMap(now);
}

bool Monitor::detach(const std::string& object) {
  if (!checker_->detach(object)) return false;
  if (body_) body_->setModel(checker_->sharedModel());
  return true;
}

}  // namespace tccm
