#include "simulation/monitored_simulation.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "base/stopwatch.h"
#include "simulation/robot/dual_arm.h"

namespace tccm::simulation {
namespace {

std::vector<std::string> jointNames(const RobotModel& model) {
  std::vector<std::string> names;
  for (const JointVariable& variable : model.variables()) names.push_back(variable.name);
  return names;
}

}  // namespace

MonitoredSimulation::MonitoredSimulation(const Simulator::Config& simulator,
                                         const Monitor::Config& monitor,
                                         std::shared_ptr<const RobotModel> model)
    : simulator_(simulator),
      monitor_(monitor, std::move(model)),
      sensors_(sensorsOf(simulator, simulator_.model())),
      joints_(jointNames(simulator_.model())) {
  monitor_.checker().setRootPose(0, simulator_.now(), Pose::Identity(), true);
}

std::vector<MonitoredSimulation::Sensor> MonitoredSimulation::sensorsOf(
    const Simulator::Config& config, const RobotModel& model) {
  std::vector<Sensor> sensors;
  for (const SensorKind kind : config.sensors) {
    Mount mount{"laser_link", Pose::Identity()};
    if (kind == SensorKind::kCamera) mount = config.clouds.camera_mount;
    if (kind == SensorKind::kLidar) mount = config.clouds.lidar_mount;
    sensors.push_back({kind, linkIndex(model, mount.link), mount.T_link_sensor});
  }
  return sensors;
}

Time MonitoredSimulation::Waiting::first() const {
  const auto* scan = std::get_if<SimulatedScan>(&measured);
  return scan != nullptr ? scan->scan.stamp : std::get<SimulatedCloud>(measured).cloud.first();
}

Time MonitoredSimulation::Waiting::last() const {
  const auto* scan = std::get_if<SimulatedScan>(&measured);
  return scan != nullptr ? scan->scan.lastBeamTime()
                         : std::get<SimulatedCloud>(measured).cloud.last();
}

void MonitoredSimulation::obey(Obedience obedience) {
  obedience_ = obedience;
  simulator_.setStop(true);
}

void MonitoredSimulation::obey(Guardian& guardian, Obedience obedience) {
  obey(obedience);
  guardian_ = &guardian;
}

void MonitoredSimulation::stampJointsLate(double late_s) {
  constexpr double kSample = 0.01;  // [s]
  joints_late_ = static_cast<std::size_t>(std::lround(std::clamp(late_s, 0.0, 0.1) / kSample));
}

bool MonitoredSimulation::step() {
  StepOutput output = simulator_.step();
  if (guardian_ != nullptr) {
    const Guardian::Word word = guardian_->watch(simulator_, output);
    if (output.robot) tell(word);
  }
  wait(output);
  if (!output.robot) return false;
  addRobot(*output.robot);
  mapReady();
  return true;
}

void MonitoredSimulation::wait(StepOutput& output) {
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    if (sensors_[i].kind == SensorKind::kLaser) {
      if (output.scan) waiting_.push_back({i, std::move(*output.scan)});
    } else {
      auto& cloud =
          sensors_[i].kind == SensorKind::kCamera ? output.clouds.camera : output.clouds.lidar;
      if (cloud) waiting_.push_back({i, std::move(*cloud)});
    }
  }
}

void MonitoredSimulation::addRobot(const RobotSample& sample) {
  constexpr std::size_t kKept = 14;  // at 10 ms each: more than a lidar's turn and its wait
  if (recent_.size() == kKept) recent_.erase(recent_.begin());
  recent_.push_back(sample);
  const RobotSample& heard =
      recent_[recent_.size() - 1 - std::min(joints_late_, recent_.size() - 1)];
  monitor_.addJoints(sample.stamp, sample.stamp, joints_, heard.positions, heard.velocities);
  check();
}

void MonitoredSimulation::mapReady() {
  const auto isReady = [this](const Waiting& waiting) {
    return waiting.last() <= recent_.back().stamp;
  };
  while (true) {
    const auto ready = std::find_if(waiting_.begin(), waiting_.end(), isReady);
    if (ready == waiting_.end()) return;
    const Waiting next = std::move(*ready);
    waiting_.erase(ready);
    // The very first scan began before the robot was heard of.
    if (next.first() >= recent_.front().stamp) map(next);
  }
}

void MonitoredSimulation::map(const Waiting& waiting) {
  const Sensor& sensor = sensors_[waiting.sensor];
  PosePath T_fixed_sensor;
  std::vector<PosePath> T_fixed_roots(1);
  for (const RobotSample& sample : recent_) {
    T_fixed_sensor.add(sample.stamp, sample.link_poses[sensor.link] * sensor.T_link_sensor);
    T_fixed_roots.front().add(sample.stamp, Pose::Identity());
  }
  const auto* scan = std::get_if<SimulatedScan>(&waiting.measured);
  const auto* cloud = std::get_if<SimulatedCloud>(&waiting.measured);
  const Time now = simulator_.now();
  Stopwatch stopwatch;
  const Monitor::ScanOutcome outcome =
      scan != nullptr
          ? monitor_.addScan(now, scan->scan, T_fixed_sensor, T_fixed_roots, waiting.sensor)
          : monitor_.addCloud(now, cloud->cloud, T_fixed_sensor, T_fixed_roots, waiting.sensor);
  processing_us_ = stopwatch.lapMicroseconds();
  if (!outcome.dropped.empty()) {
    throw std::runtime_error("a scan of the " + name(sensor.kind) +
                             " was dropped: " + outcome.dropped);
  }
  if (scan != nullptr && on_scan_) on_scan_(*scan);
  if (cloud != nullptr && on_cloud_) tellOf(*cloud, waiting.sensor, T_fixed_sensor);
  stopwatch.lapMicroseconds();
  check();
  processing_us_ += stopwatch.lapMicroseconds();
}

void MonitoredSimulation::tellOf(const SimulatedCloud& simulated, std::size_t sensor,
                                 const PosePath& T_fixed_sensor) const {
  const Cloud& cloud = simulated.cloud;
  MappedCloud mapped{simulated, sensor, {}, monitor_.kinds(sensor)};
  mapped.p_fixed.reserve(cloud.points.size());
  Pose T_fixed_cloud = *T_fixed_sensor.at(cloud.first());
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (!cloud.offsets_s.empty() && isMeasured(cloud.points[i])) {
      T_fixed_cloud =
          *T_fixed_sensor.at(cloud.stamp + fromSeconds(static_cast<double>(cloud.offsets_s[i])));
    }
    mapped.p_fixed.emplace_back(T_fixed_cloud * cloud.points[i].cast<double>());
  }
  on_cloud_(mapped);
}

void MonitoredSimulation::check() {
  if (monitor_.map() == nullptr) return;
  const Verdict& verdict = monitor_.checker().check(simulator_.now());
  if (guardian_ == nullptr) tell({verdict.stop, verdict.speed_scale, name(verdict.reason)});
  if (on_verdict_) on_verdict_(verdict);
}

void MonitoredSimulation::tell(const Guardian::Word& word) {
  if (obedience_) simulator_.setStop(word.stop);
  if (obedience_ == Obedience::kStopAndScale) simulator_.setSpeedScale(word.speed_scale);
  if (on_permission_) on_permission_(!word.stop, word.reason);
}

}  // namespace tccm::simulation
