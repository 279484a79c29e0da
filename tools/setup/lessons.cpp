#include "lessons.h"

#include <algorithm>
#include <utility>

#include "check/pose_check.h"
#include "draft.h"
#include "tools/bag_stream.h"

namespace tccm {
namespace {

/// Of those that are no fault.
void noteLargest(double age_s, double at_most_s, double& largest_s) {
  if (age_s <= at_most_s) largest_s = std::max(largest_s, age_s);
}

/// Of the ranges that were measured; nothing where none was.
std::optional<double> robotShareOf(const BeamCounts& beams) {
  const auto of = [&beams](BeamKind kind) {
    return static_cast<double>(beams[static_cast<std::size_t>(kind)]);
  };
  const double measured = of(BeamKind::kReturn) + of(BeamKind::kMixedPixel) + of(BeamKind::kSelf) +
                          of(BeamKind::kShadow);
  if (measured == 0.0) return std::nullopt;
  return of(BeamKind::kSelf) / measured;
}

}  // namespace

void HeardRobot::play(const MonitorConfig& settings, const std::string& joint_states,
                      Evaluation& evaluation) const {
  BagStream::Topics topics{{}, joint_states, false};
  for (const SensorConfig& sensor : settings.sensors()) {
    topics.sensors.push_back({sensor.topic, sensor.cloud_assembler.has_value()});
  }
  tccm::play(BagStream(bag, topics), evaluation, progressBar());
}

Lessons learn(const HeardRobot& robot, const SetupDraft& draft) {
  constexpr std::size_t kPointsMax = 400000;
  constexpr std::size_t kEvery = 7;  // that a cloud's points are thinned to
  const MonitorConfig settings = draft.trialSettings();
  Lessons lessons;
  std::map<std::string, std::pair<double, std::size_t>> visible;
  Evaluation::Observer observer;
  std::size_t count = 0;
  const std::size_t sensors = draft.sensors().size();
  lessons.map_ages_s.resize(sensors, 0.0);
  std::vector<std::optional<Time>> newest(sensors);
  observer.mapped = [&](const Monitor& monitor, std::size_t sensor) {
    newest[sensor] = monitor.map(sensor)->stamp;
    for (const Vector3& p : monitor.returns(sensor).points) {
      if (++count % kEvery == 0 && lessons.points.size() < kPointsMax) lessons.points.push_back(p);
    }
  };
  observer.checked = [&](const Verdict& verdict, const Checker& checker) {
    noteLargest(toSeconds(verdict.stamp - verdict.joints_stamp), SetupDraft::kGapMax,
                lessons.joint_age_s);
    for (std::size_t i = 0; i < sensors; ++i) {
      if (!newest[i]) continue;
      const double rate = std::max(1.0, draft.sensors()[i].heard->rate());
      noteLargest(toSeconds(verdict.stamp - *newest[i]), SetupDraft::kPeriodsMax / rate,
                  lessons.map_ages_s[i]);
    }
    if (!verdict.placed || !verdict.known) return;
    for (const LinkVisibility& link : verdict.now.links) {
      if (link.silhouette < settings.checker.checker.pose.occlusion.silhouette_min_pixels) continue;
      auto& [sum, times] = visible[checker.model()->links()[link.link]];
      sum += link.visible_fraction;
      ++times;
    }
  };
  Evaluation evaluation(settings, robot.model, observer);
  robot.play(settings, draft.jointTopic(), evaluation);
  for (const auto& [link, of_link] : visible) {
    lessons.visible[link] = of_link.first / static_cast<double>(of_link.second);
  }
  for (std::size_t i = 0; i < draft.sensors().size(); ++i) {
    const ScanTotals& totals = evaluation.totals().sensors[i];
    lessons.points_in_area.push_back(totals.points_mapped);
    lessons.robot_shares.push_back(robotShareOf(totals.beams));
    const auto period = evaluation.monitor().mapper(i).tiltPeriod();
    lessons.tilt_periods_s.push_back(period ? std::optional<double>(toSeconds(*period))
                                            : std::nullopt);
  }
  return lessons;
}

OwnReturns measureOwnReturns(const HeardRobot& robot, const SetupDraft& draft) {
  MonitorConfig settings = draft.settings();
  const auto see_all = [](auto& sensor) {
    sensor.assembler.scan.self_filter = false;
    if (sensor.cloud_assembler) sensor.cloud_assembler->cloud.self_filter = false;
  };
  settings.assembler.scan.self_filter = settings.cloud_assembler.cloud.self_filter = false;
  for (SensorConfig& sensor : settings.named_sensors) see_all(sensor);
  settings.checker.checker.pose.check_occlusion = false;
  OwnReturns own(robot.model);
  std::vector<std::size_t> fresh;  // sensors that were mapped since the last check
  const Monitor* monitor = nullptr;
  Evaluation::Observer observer;
  observer.mapped = [&](const Monitor& of, std::size_t sensor) {
    monitor = &of;
    fresh.push_back(sensor);
  };
  observer.checked = [&](const Verdict& verdict, const Checker& checker) {
    for (const std::size_t sensor : verdict.placed ? fresh : std::vector<std::size_t>()) {
      const double lowest_m = settings.sensors()[sensor].mapper.mapper.map.grid.height_min_m;
      own.add(monitor->returns(sensor), checker.checkHere().posture().T_fixed_shapes, lowest_m);
    }
    fresh.clear();
  };
  Evaluation evaluation(settings, robot.model, observer);
  robot.play(settings, draft.jointTopic(), evaluation);
  return own;
}

}  // namespace tccm
