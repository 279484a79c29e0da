#include "monitor.h"

#include "base/stopwatch.h"
#include "tccm_monitor/config_error.h"

namespace tccm {

Monitor::Monitor(const Config& config, std::shared_ptr<const RobotModel> model)
    : scan_(config.scan, model), mapper_(config.mapper), ages_(mapper_.map()) {
  if (model) checker_ = std::make_unique<Checker>(std::move(model), config.checker);
}

void Monitor::addJoints(Time now, Time stamp, const std::vector<std::string>& names,
                        const std::vector<double>& positions,
                        const std::vector<double>& velocities) {
  scan_.addJoints(now, stamp, names, positions, velocities);
  if (checker_) checker_->addJoints(now, stamp, names, positions, velocities);
}

void Monitor::scanArrived(Time now, Time stamp) {
  if (checker_) checker_->addScanReport(now, {stamp, ScanReport::Outcome::kWaiting});
}

void Monitor::scanDropped(Time now, Time stamp, const std::string& reason) {
  if (checker_) checker_->addScanReport(now, {stamp, ScanReport::Outcome::kDropped, reason});
}

void Monitor::reset() {
  scan_.reset();
  mapper_.clear();
  if (checker_) checker_->startAnew();
  maps_ = {};
}

Monitor::ScanOutcome Monitor::addScan(Time now, const LaserScan& scan,
                                      const PosePath& T_fixed_sensor,
                                      const std::vector<PosePath>& T_fixed_roots) {
  ScanOutcome outcome;
  Stopwatch stopwatch;
  outcome.dropped = scan_.assemble(scan, T_fixed_sensor, T_fixed_roots);
  if (outcome.dropped.empty()) {
    takeReturns(scan_.scan(), returns_);
    outcome.beams = scan_.scan().counts();
    outcome.assemble_us = stopwatch.lapMicroseconds();
    const Mapper::Outcome mapped = mapper_.add(returns_);
    outcome.dropped = mapped.dropped;
    outcome.added = mapped.added;
    outcome.integrate_us = stopwatch.lapMicroseconds();
  }
  if (!outcome.dropped.empty()) {
    scanDropped(now, scan.stamp, outcome.dropped);
    return outcome;
  }
  if (checker_) checker_->addScanReport(now, {scan.stamp, ScanReport::Outcome::kAssembled});
  publishMap(now);
  outcome.snapshot_us = stopwatch.lapMicroseconds();
  ages_.follow(mapper_.map(), mapper_.looks());
  return outcome;
}

void Monitor::publishMap(Time now) {
  newest_ = 1 - newest_;
  if (!maps_[newest_]) {
    maps_[newest_] = std::make_shared<CuboidMap>();
    mapper_.reserve(*maps_[newest_]);
  }
  mapper_.snapshot(*maps_[newest_]);
  ages_.apply(mapper_.map(), *maps_[newest_]);
  if (checker_) checker_->setMap(now, maps_[newest_]);
}

void Monitor::attach(Time now, const AttachedObject& object, double forget_padding_m) {
  const Region region{{checker_->placeOf(now, object), forget_padding_m}};
  validate(region);
  checker_->attach(object);
  scan_.hold(checker_->attached());
  mapper_.forget(region, now);
  if (maps_[newest_]) publishMap(now);
}

bool Monitor::detach(const std::string& object) {
  if (!checker_->detach(object)) return false;
  scan_.hold(checker_->attached());
  return true;
}

}  // namespace tccm
