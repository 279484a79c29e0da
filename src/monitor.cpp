#include "tccm_monitor/monitor.h"

#include <array>
#include <deque>
#include <utility>

#include "base/stopwatch.h"
#include "map/place_ages.h"
#include "monitor_config.h"

namespace tccm {

/// From a sensor's scans to its map.
struct Monitor::Stages {
  Stages(const Config::Sensor& config, const std::shared_ptr<const RobotModel>& model)
      : scan(config.scan, model), mapper(config.mapper), ages(mapper.map()) {}

  /// A snapshot for the checker, which may hold the one before.
  const std::shared_ptr<CuboidMap>& snapshot() {
    newest = 1 - newest;
    // Of a sensor that has failed the checker keeps the last map that was good.
    if (!maps[newest] || maps[newest].use_count() > 1) {
      maps[newest] = std::make_shared<CuboidMap>();
      mapper.reserve(*maps[newest]);
    }
    mapper.snapshot(*maps[newest]);
    ages.apply(mapper.map(), *maps[newest]);
    return maps[newest];
  }

  ScanStage scan;
  Mapper mapper;
  PlaceAges ages;
  ScanReturns returns;
  std::array<std::shared_ptr<CuboidMap>, 2> maps;  ///< the checker holds one while the other fills
  std::size_t newest = 0;
};

struct Monitor::Parts {
  Parts(const Config& config, std::shared_ptr<const RobotModel> model) {
    for (const Config::Sensor& sensor : config.sensors) sensors.emplace_back(sensor, model);
    if (model) checker = std::make_unique<Checker>(std::move(model), config.checker);
  }

  void publishMap(Time now, std::size_t sensor) {
    const std::shared_ptr<CuboidMap>& map = sensors[sensor].snapshot();
    if (checker) checker->setMap(now, map, sensor);
  }

  std::deque<Stages> sensors;
  std::unique_ptr<Checker> checker;
  ScanReport assembled{{}, ScanReport::Outcome::kAssembled};  ///< reused
};

Monitor::Monitor(const Config& config, std::shared_ptr<const RobotModel> model)
    : parts_(std::make_unique<Parts>(config, std::move(model))) {}
Monitor::Monitor(Monitor&& other) noexcept = default;
Monitor::~Monitor() = default;

bool Monitor::hasRobot() const { return parts_->checker != nullptr; }
Checker& Monitor::checker() { return *parts_->checker; }
const Checker& Monitor::checker() const { return *parts_->checker; }
std::size_t Monitor::sensors() const { return parts_->sensors.size(); }
const CuboidMap* Monitor::map(std::size_t sensor) const {
  return parts_->sensors[sensor].maps[parts_->sensors[sensor].newest].get();
}
const BodySampler* Monitor::body(std::size_t sensor) const {
  return parts_->sensors[sensor].scan.body();
}
const Mapper& Monitor::mapper(std::size_t sensor) const { return parts_->sensors[sensor].mapper; }
const AssembledScan& Monitor::assembled(std::size_t sensor) const {
  return parts_->sensors[sensor].scan.scan();
}
const ScanReturns& Monitor::returns(std::size_t sensor) const {
  return parts_->sensors[sensor].returns;
}

void Monitor::addJoints(Time now, Time stamp, const std::vector<std::string>& names,
                        const std::vector<double>& positions, const std::vector<double>& velocities,
                        const std::string& publisher) {
  for (Stages& sensor : parts_->sensors) {
    sensor.scan.addJoints(now, stamp, names, positions, velocities);
  }
  if (hasRobot()) checker().addJoints(now, stamp, names, positions, velocities, publisher);
}

void Monitor::scanArrived(Time now, Time stamp, std::size_t sensor) {
  if (hasRobot()) checker().addScanReport(now, {stamp, ScanReport::Outcome::kWaiting}, sensor);
}

void Monitor::scanDropped(Time now, const ScanReport& report, std::size_t sensor) {
  if (hasRobot()) checker().addScanReport(now, report, sensor);
}

void Monitor::reset() {
  for (Stages& sensor : parts_->sensors) {
    sensor.scan.reset();
    sensor.mapper.clear();
    sensor.maps = {};
  }
  if (hasRobot()) checker().startAnew();
}

Monitor::ScanOutcome Monitor::addScan(Time now, const LaserScan& scan,
                                      const PosePath& T_fixed_sensor,
                                      const std::vector<PosePath>& T_fixed_roots,
                                      std::size_t sensor) {
  Stages& stages = parts_->sensors[sensor];
  ScanOutcome outcome;
  Stopwatch stopwatch;
  outcome.dropped = stages.scan.assemble(scan, T_fixed_sensor, T_fixed_roots);
  if (outcome.dropped.empty()) {
    takeReturns(stages.scan.scan(), stages.returns);
    outcome.beams = stages.scan.scan().counts();
    outcome.assemble_us = stopwatch.lapMicroseconds();
    const Mapper::Outcome mapped = stages.mapper.add(stages.returns);
    outcome.dropped = mapped.dropped;
    outcome.added = mapped.added;
    outcome.integrate_us = stopwatch.lapMicroseconds();
  }
  if (!outcome.dropped.empty()) {
    scanDropped(now, {scan.stamp, ScanReport::Outcome::kDropped, outcome.dropped}, sensor);
    return outcome;
  }
  ScanReport& assembled = parts_->assembled;
  assembled.stamp = scan.stamp;
  assembled.self_link = stages.scan.selfLink();
  if (hasRobot()) checker().addScanReport(now, assembled, sensor);
  parts_->publishMap(now, sensor);
  outcome.snapshot_us = stopwatch.lapMicroseconds();
  stages.ages.follow(stages.mapper.map(), stages.mapper.looks());
  return outcome;
}

void Monitor::attach(Time now, const AttachedObject& object, double forget_padding_m) {
  const Region region{{checker().placeOf(now, object), forget_padding_m}};
  validate(region);
  checker().attach(object);
  for (std::size_t i = 0; i < sensors(); ++i) {
    parts_->sensors[i].scan.hold(checker().attached());
    parts_->sensors[i].mapper.forget(region, now);
    if (map(i) != nullptr) parts_->publishMap(now, i);
  }
}

bool Monitor::detach(const std::string& object) {
  if (!checker().detach(object)) return false;
  for (Stages& sensor : parts_->sensors) sensor.scan.hold(checker().attached());
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
