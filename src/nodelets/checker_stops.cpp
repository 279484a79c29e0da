/// What a CollisionChecker keeps of stops.

#include <yaml-cpp/yaml.h>

#include "nodelets/collision_checker.h"
#include "ros/server_config.h"
#include "ros/stops/recorded_robot.h"

namespace tccm {

void CollisionChecker::makeRecorder() {
  std::vector<std::string> sensors;
  for (const SensorInput& sensor : checker_->inputs().sensors()) sensors.push_back(sensor.name());
  recorder_ = std::make_unique<StopRecorder>(
      config_.stops,
      RecordedRobot::preambleOf(YAML::Dump(parametersOf(privateNode())),
                                YAML::Dump(robotParameters(node())), robotDescription(node()),
                                *checker_->model()),
      sensors);
  for (SensorFeed& feed : feeds_) feed.hearPoints(node(), *recorder_);
  NODELET_INFO("Stops are written to %s: at most %d bags of %.3g MB.", config_.stops.folder.c_str(),
               config_.stops.bags_max, 0.5 * config_.stops.memory_mb);
}

void CollisionChecker::tellStopDefect() {
  const std::string defect = recorder_->report().writer.defect;
  if (defect == told_stop_defect_) return;
  told_stop_defect_ = defect;
  if (!defect.empty()) NODELET_ERROR("A stop could not be written: %s.", defect.c_str());
}

void CollisionChecker::diagnoseStops(diagnostic_updater::DiagnosticStatusWrapper& status) const {
  const StopRecorder::Report report = recorder_->report();
  status.add("stops written", report.writer.written);
  if (!report.writer.last.empty()) status.add("last stop written", report.writer.last);
  if (report.missed > 0) status.add("stops not written, as another one was", report.missed);
  if (report.lost > 0) status.add("records of stops too large: raise stops_memory_mb", report.lost);
  status.add("kept for the next stop [bytes]", report.bytes);
  if (report.writer.defect.empty()) return;
  status.add("last stop could not be written", report.writer.defect);
  status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN, "a stop could not be written");
}

}  // namespace tccm
