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
      sensor_(linkIndex(simulator_.model(), "laser_link")),
      joints_(jointNames(simulator_.model())) {
  monitor_.checker().setRootPose(0, simulator_.now(), Pose::Identity(), true);
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
  if (output.scan) waiting_.push_back(std::move(*output.scan));
  if (!output.robot) return false;
  addRobot(*output.robot);
  mapReady();
  return true;
}

void MonitoredSimulation::addRobot(const RobotSample& sample) {
  constexpr std::size_t kKept = 12;  // at 10 ms each: more than a scan and its wait
  if (recent_.size() == kKept) recent_.erase(recent_.begin());
  recent_.push_back(sample);
  const RobotSample& heard =
      recent_[recent_.size() - 1 - std::min(joints_late_, recent_.size() - 1)];
  monitor_.addJoints(sample.stamp, sample.stamp, joints_, heard.positions, heard.velocities);
  check();
}

void MonitoredSimulation::mapReady() {
  PosePath T_fixed_sensor;
  std::vector<PosePath> T_fixed_roots(1);
  for (const RobotSample& sample : recent_) {
    T_fixed_sensor.add(sample.stamp, sample.link_poses[sensor_]);
    T_fixed_roots.front().add(sample.stamp, Pose::Identity());
  }
  while (!waiting_.empty() && waiting_.front().scan.lastBeamTime() <= recent_.back().stamp) {
    const SimulatedScan scan = std::move(waiting_.front());
    waiting_.erase(waiting_.begin());
    // The very first scan began before the robot was heard of.
    if (scan.scan.stamp < recent_.front().stamp) continue;
    Stopwatch stopwatch;
    const auto outcome =
        monitor_.addScan(simulator_.now(), scan.scan, T_fixed_sensor, T_fixed_roots);
    processing_us_ = stopwatch.lapMicroseconds();
    if (!outcome.dropped.empty()) {
      throw std::runtime_error("a scan was dropped: " + outcome.dropped);
    }
    if (on_scan_) on_scan_(scan);
    stopwatch.lapMicroseconds();
    check();
    processing_us_ += stopwatch.lapMicroseconds();
  }
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
