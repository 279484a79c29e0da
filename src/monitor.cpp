#include "tccm_monitor/monitor.h"

#include <array>

#include "base/stopwatch.h"
#include "map/place_ages.h"
#include "monitor_config.h"

namespace tccm {

struct Monitor::Parts {
  Parts(const Config& config, std::shared_ptr<const RobotModel> model)
      : scan(config.scan, model), mapper(config.mapper), ages(mapper.map()) {
    if (model) checker = std::make_unique<Checker>(std::move(model), config.checker);
  }

  /// A snapshot for the checker, which may hold the one before.
  void publishMap(Time now) {
    newest = 1 - newest;
    if (!maps[newest]) {
      maps[newest] = std::make_shared<CuboidMap>();
      mapper.reserve(*maps[newest]);
    }
    mapper.snapshot(*maps[newest]);
    ages.apply(mapper.map(), *maps[newest]);
    if (checker) checker->setMap(now, maps[newest]);
  }

  ScanStage scan;
  Mapper mapper;
  PlaceAges ages;
  std::unique_ptr<Checker> checker;
  ScanReturns returns;
  ScanReport assembled{{}, ScanReport::Outcome::kAssembled};  ///< reused
  std::array<std::shared_ptr<CuboidMap>, 2> maps;  ///< the checker holds one while the other fills
  std::size_t newest = 0;
};

Monitor::Monitor(const Config& config, std::shared_ptr<const RobotModel> model)
    : parts_(std::make_unique<Parts>(config, std::move(model))) {}
Monitor::Monitor(Monitor&& other) noexcept = default;
Monitor::~Monitor() = default;

bool Monitor::hasRobot() const { return parts_->checker != nullptr; }
Checker& Monitor::checker() { return *parts_->checker; }
const Checker& Monitor::checker() const { return *parts_->checker; }
const CuboidMap* Monitor::map() const { return parts_->maps[parts_->newest].get(); }
const BodySampler* Monitor::body() const { return parts_->scan.body(); }
const Mapper& Monitor::mapper() const { return parts_->mapper; }
const AssembledScan& Monitor::assembled() const { return parts_->scan.scan(); }
const ScanReturns& Monitor::returns() const { return parts_->returns; }

void Monitor::addJoints(Time now, Time stamp, const std::vector<std::string>& names,
                        const std::vector<double>& positions, const std::vector<double>& velocities,
                        const std::string& publisher) {
  parts_->scan.addJoints(now, stamp, names, positions, velocities);
  if (hasRobot()) checker().addJoints(now, stamp, names, positions, velocities, publisher);
}

void Monitor::scanArrived(Time now, Time stamp) {
  if (hasRobot()) checker().addScanReport(now, {stamp, ScanReport::Outcome::kWaiting});
}

void Monitor::scanDropped(Time now, const ScanReport& report) {
  if (hasRobot()) checker().addScanReport(now, report);
}

void Monitor::reset() {
  parts_->scan.reset();
  parts_->mapper.clear();
  if (hasRobot()) checker().startAnew();
  parts_->maps = {};
}

Monitor::ScanOutcome Monitor::addScan(Time now, const LaserScan& scan,
                                      const PosePath& T_fixed_sensor,
                                      const std::vector<PosePath>& T_fixed_roots) {
  auto& [stage, mapper, ages, checker, returns, assembled, maps, newest] = *parts_;
  ScanOutcome outcome;
  Stopwatch stopwatch;
  outcome.dropped = stage.assemble(scan, T_fixed_sensor, T_fixed_roots);
  if (outcome.dropped.empty()) {
    takeReturns(stage.scan(), returns);
    outcome.beams = stage.scan().counts();
    outcome.assemble_us = stopwatch.lapMicroseconds();
    const Mapper::Outcome mapped = mapper.add(returns);
    outcome.dropped = mapped.dropped;
    outcome.added = mapped.added;
    outcome.integrate_us = stopwatch.lapMicroseconds();
  }
  if (!outcome.dropped.empty()) {
    scanDropped(now, {scan.stamp, ScanReport::Outcome::kDropped, outcome.dropped});
    return outcome;
  }
  assembled.stamp = scan.stamp;
  assembled.self_link = stage.selfLink();
  if (checker) checker->addScanReport(now, assembled);
  parts_->publishMap(now);
  outcome.snapshot_us = stopwatch.lapMicroseconds();
  ages.follow(mapper.map(), mapper.looks());
  return outcome;
}

void Monitor::attach(Time now, const AttachedObject& object, double forget_padding_m) {
  const Region region{{checker().placeOf(now, object), forget_padding_m}};
  validate(region);
  checker().attach(object);
  parts_->scan.hold(checker().attached());
  parts_->mapper.forget(region, now);
  if (map() != nullptr) parts_->publishMap(now);
}

bool Monitor::detach(const std::string& object) {
  if (!checker().detach(object)) return false;
  parts_->scan.hold(checker().attached());
  return true;
}

Monitor loadMonitor(const std::string& config, const std::string& urdf,
                    const RobotResources& resources) {
  const MonitorConfig settings = readMonitorConfig(config);
  std::shared_ptr<const RobotModel> model;
  if (!urdf.empty()) model = std::make_shared<RobotModel>(urdf, settings.robot, resources);
  return Monitor(settings.monitor(), std::move(model));
}

}  // namespace tccm
