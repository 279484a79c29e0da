#include "tccm_monitor/monitor.h"

#include <array>
#include <deque>
#include <utility>
#include <variant>

#include "base/stopwatch.h"
#include "map/place_ages.h"
#include "monitor_config.h"

namespace tccm {

namespace {

/// The first of a sensor's stages: that of a laser, or that of a camera or lidar.
using FirstStage = std::variant<ScanStage, CloudStage>;

FirstStage firstStageOf(const Monitor::Config::Sensor& config,
                        const std::shared_ptr<const RobotModel>& model) {
  if (config.cloud) return FirstStage(std::in_place_type<CloudStage>, *config.cloud, model);
  return FirstStage(std::in_place_type<ScanStage>, config.scan, model);
}

}  // namespace

/// From a sensor's scans to its map.
struct Monitor::Stages {
  Stages(const Config::Sensor& config, const std::shared_ptr<const RobotModel>& model)
      : first(firstStageOf(config, model)), mapper(config.mapper), ages(mapper.map()) {}

  [[nodiscard]] ScanStage& scan() { return std::get<ScanStage>(first); }
  [[nodiscard]] CloudStage& cloud() { return std::get<CloudStage>(first); }
  [[nodiscard]] const ScanReturns& taken() const {
    const auto* cloud_stage = std::get_if<CloudStage>(&first);
    return cloud_stage ? cloud_stage->returns() : returns;
  }
  /// Calls what both kinds of first stage have.
  template <typename Call>
  decltype(auto) ofFirst(Call&& call) {
    return std::visit(std::forward<Call>(call), first);
  }

  /// A snapshot for the checker, which may hold the one before.
  const std::shared_ptr<CuboidMap>& snapshot() {
    newest = 1 - newest;
    // Of a sensor that has failed the checker keeps the last map that was good.
    if (!maps[newest] || maps[newest].use_count() > 1) {
      maps[newest] = std::make_shared<CuboidMap>();
      mapper.reserve(*maps[newest]);
    }
    mapper.snapshot(*maps[newest]);
    mapper.apply(ages, *maps[newest]);
    return maps[newest];
  }

  FirstStage first;
  Mapper mapper;
  PlaceAges ages;
  ScanReturns returns;                             ///< of a laser's last scan
  std::array<std::shared_ptr<CuboidMap>, 2> maps;  ///< the checker holds one while the other fills
  std::size_t newest = 0;
};

struct Monitor::Parts {
  Parts(const Config& config, std::shared_ptr<const RobotModel> model) {
    for (const Config::Sensor& sensor : config.sensors) sensors.emplace_back(sensor, model);
    if (model) checker = std::make_unique<Checker>(std::move(model), config.checker);
  }

  /// From what the sensor's first stage has assembled to the map that the checker sees.
  void map(Time now, Time stamp, std::size_t sensor, ScanOutcome& outcome) {
    Stages& stages = sensors[sensor];
    Stopwatch stopwatch;
    const Mapper::Outcome mapped = stages.mapper.add(stages.taken());
    outcome.dropped = mapped.dropped;
    outcome.added = mapped.added;
    outcome.integrate_us = stopwatch.lapMicroseconds();
    if (!outcome.dropped.empty()) return;
    assembled.stamp = stamp;
    assembled.self_link = stages.ofFirst([](const auto& stage) { return stage.selfLink(); });
    if (checker) checker->addScanReport(now, assembled, sensor);
    publishMap(now, sensor);
    outcome.snapshot_us = stopwatch.lapMicroseconds();
    stages.ages.follow(stages.mapper.map(), stages.mapper.looks());
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
  return parts_->sensors[sensor].ofFirst([](const auto& stage) { return stage.body(); });
}
const Mapper& Monitor::mapper(std::size_t sensor) const { return parts_->sensors[sensor].mapper; }
const AssembledScan& Monitor::assembled(std::size_t sensor) const {
  return parts_->sensors[sensor].scan().scan();
}
const ScanReturns& Monitor::returns(std::size_t sensor) const {
  return parts_->sensors[sensor].taken();
}
const std::vector<BeamKind>& Monitor::kinds(std::size_t sensor) const {
  return parts_->sensors[sensor].cloud().kinds();
}

void Monitor::addJoints(Time now, Time stamp, const std::vector<std::string>& names,
                        const std::vector<double>& positions, const std::vector<double>& velocities,
                        const std::string& publisher) {
  for (Stages& sensor : parts_->sensors) {
    sensor.ofFirst([&](auto& stage) { stage.addJoints(now, stamp, names, positions, velocities); });
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
    sensor.ofFirst([](auto& stage) { stage.reset(); });
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
  outcome.dropped = stages.scan().assemble(scan, T_fixed_sensor, T_fixed_roots);
  if (outcome.dropped.empty()) {
    takeReturns(stages.scan().scan(), stages.returns);
    outcome.beams = stages.scan().scan().counts();
    outcome.assemble_us = stopwatch.lapMicroseconds();
    parts_->map(now, scan.stamp, sensor, outcome);
  }
  if (!outcome.dropped.empty()) {
    scanDropped(now, {scan.stamp, ScanReport::Outcome::kDropped, outcome.dropped}, sensor);
  }
  return outcome;
}

Monitor::ScanOutcome Monitor::addCloud(Time now, const Cloud& cloud, const PosePath& T_fixed_sensor,
                                       const std::vector<PosePath>& T_fixed_roots,
                                       std::size_t sensor) {
  CloudStage& stage = parts_->sensors[sensor].cloud();
  ScanOutcome outcome;
  Stopwatch stopwatch;
  outcome.dropped = stage.assemble(cloud, T_fixed_sensor, T_fixed_roots);
  if (outcome.dropped.empty()) {
    outcome.beams = stage.counts();
    outcome.assemble_us = stopwatch.lapMicroseconds();
    parts_->map(now, cloud.first(), sensor, outcome);
  }
  if (!outcome.dropped.empty()) {
    scanDropped(now, {cloud.stamp, ScanReport::Outcome::kDropped, outcome.dropped}, sensor);
  }
  return outcome;
}

void Monitor::attach(Time now, const AttachedObject& object, double forget_padding_m) {
  const Region region{{checker().placeOf(now, object), forget_padding_m}};
  validate(region);
  checker().attach(object);
  for (std::size_t i = 0; i < sensors(); ++i) {
    parts_->sensors[i].ofFirst([&](auto& stage) { stage.hold(checker().attached()); });
    parts_->sensors[i].mapper.forget(region, now);
    if (map(i) != nullptr) parts_->publishMap(now, i);
  }
}

bool Monitor::detach(const std::string& object) {
  if (!checker().detach(object)) return false;
  for (Stages& sensor : parts_->sensors) {
    sensor.ofFirst([&](auto& stage) { stage.hold(checker().attached()); });
  }
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
