#include "evaluation.h"

#include <algorithm>
#include <utility>

#include "base/stopwatch.h"
#include "check/model_agreement.h"
#include "ros/agreement_transforms.h"
#include "ros/conversions.h"

namespace tccm {
namespace {

constexpr Duration kJumpMin = std::chrono::seconds(1);  // less is jitter between messages

/// All sensors ask one history: the strictest of them counts.
Duration gapMaxOf(const MonitorConfig& settings) {
  double gap_max_s = settings.sensors().front().placing().transform_gap_max_s;
  for (const SensorConfig& sensor : settings.sensors()) {
    gap_max_s = std::min(gap_max_s, sensor.placing().transform_gap_max_s);
  }
  return fromSeconds(gap_max_s);
}

}  // namespace

Evaluation::Evaluation(const MonitorConfig& settings, std::shared_ptr<const RobotModel> model,
                       Observer observer)
    : monitor_(settings.monitor(), std::move(model)),
      observer_(std::move(observer)),
      fixed_frame_(withoutSlash(settings.checker.fixed_frame)),
      root_frames_(monitor_.hasRobot() ? monitor_.checker().model()->rootFrames()
                                       : std::vector<std::string>()),
      transforms_(gapMaxOf(settings)) {
  for (const SensorConfig& sensor : settings.sensors()) openSource(sensor);
}

void Evaluation::openSource(const SensorConfig& sensor) {
  const std::size_t index = sources_.size();
  const auto roots = monitor_.body(index) ? root_frames_ : std::vector<std::string>();
  readers_.emplace_back();
  if (sensor.cloud_assembler) {
    readers_.back().emplace(sensor.cloud_assembler->cloud.limits);
    sources_.emplace_back(std::in_place_type<CloudSource>, *sensor.cloud_assembler, roots,
                          transforms_);
  } else {
    sources_.emplace_back(std::in_place_type<ScanSource>, sensor.assembler, roots, transforms_);
  }
  totals_.sensors.emplace_back();
  const auto note = [this, index](const ScanReport& report) {
    countScans(index,
               [&](ScanTotals& totals) { ++totals.drop_details[report.dropped][report.detail]; });
    if (now_) monitor_.scanDropped(*now_, report, index);
  };
  std::visit([&](auto& source) { source.onDrop(note); }, sources_.back());
}

void Evaluation::noteArrival(const std_msgs::Header& header, std::size_t sensor,
                             const std::string& publisher) {
  moveClock(toTime(header.stamp), publisher);
  countScans(sensor, [](ScanTotals& totals) { ++totals.scans_received; });
  monitor_.scanArrived(*now_, toTime(header.stamp), sensor);
  if (monitor_.hasRobot()) {
    monitor_.checker().agreement().watchSensor(withoutSlash(header.frame_id));
  }
}

void Evaluation::add(const sensor_msgs::LaserScan& message, std::size_t sensor,
                     const std::string& publisher) {
  noteArrival(message.header, sensor, publisher);
  fromMessage(message, scan_);
  std::get<ScanSource>(sources_[sensor]).add(scan_, message.header.frame_id, *now_);
  compareWithModel();
  mapReady();
}

void Evaluation::add(const sensor_msgs::PointCloud2& message, std::size_t sensor,
                     const std::string& publisher) {
  noteArrival(message.header, sensor, publisher);
  const auto cloud = boost::make_shared<Cloud>();
  const std::string defect = readers_[sensor]->read(message, *cloud);
  cloud->stamp = toTime(message.header.stamp);
  std::get<CloudSource>(sources_[sensor]).add(cloud, message.header.frame_id, *now_, defect);
  compareWithModel();
  mapReady();
}

void Evaluation::add(const sensor_msgs::JointState& message, const std::string& publisher) {
  const Time stamp = toTime(message.header.stamp);
  moveClock(stamp, publisher);
  monitor_.addJoints(*now_, stamp, message.name, message.position, message.velocity, publisher);
  mapReady();
  compareWithModel();
  if (monitor_.hasRobot()) check();
}

void Evaluation::add(const tf2_msgs::TFMessage& message, bool is_static) {
  for (const auto& transform : message.transforms) {
    frames_.insert(withoutSlash(transform.header.frame_id));
    frames_.insert(withoutSlash(transform.child_frame_id));
  }
  transforms_.add(message, is_static);
  if (now_) mapReady();
}

void Evaluation::compareWithModel() {
  if (!monitor_.hasRobot()) return;
  monitor_.checker().agreement().compare(*now_, transformsOf(transforms_));
}

void Evaluation::finish() {
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    std::visit(
        [&](auto& source) {
          source.drain(filteredJoints(i));
          for (const auto& [reason, count] : source.dropped()) countDropped(i, reason, count);
        },
        sources_[i]);
  }
  totals_.last_stamp = now_;
}

void Evaluation::moveClock(Time stamp, const std::string& publisher) {
  const auto newest = newest_.find(publisher);
  if (newest != newest_.end() && stamp < newest->second - kJumpMin) resetAfterJump();
  Time& newest_of_publisher = newest_[publisher];
  newest_of_publisher = std::max(newest_of_publisher, stamp);
  now_ = now_ ? std::max(*now_, stamp) : stamp;
  if (!totals_.first_stamp) totals_.first_stamp = now_;
}

void Evaluation::resetAfterJump() {
  ++totals_.time_jumps;
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    std::visit(
        [&](auto& source) {
          if (source.waiting() > 0) countDropped(i, "time_jump", source.waiting());
          source.clear();
        },
        sources_[i]);
  }
  transforms_.clear();
  monitor_.reset();
  newest_.clear();
  now_.reset();
  in_a_run_ = false;
}

const JointStates* Evaluation::filteredJoints(std::size_t sensor) const {
  return monitor_.body(sensor) ? &monitor_.body(sensor)->joints() : nullptr;
}

void Evaluation::mapReady() {
  for (std::size_t i = 0; i < sources_.size(); ++i) mapReady(i);
}

void Evaluation::mapReady(std::size_t sensor) {
  std::visit([&](auto& source) { mapReady(source, sensor); }, sources_[sensor]);
}

template <typename SourceOf>
void Evaluation::mapReady(SourceOf& source, std::size_t sensor) {
  while (const auto* ready = source.next(filteredJoints(sensor), *now_)) {
    Stopwatch stopwatch;
    const Monitor::ScanOutcome outcome = addTo(*ready, sensor);
    if (!outcome.dropped.empty()) {
      countDropped(sensor, outcome.dropped, 1);
      continue;
    }
    if (monitor_.hasRobot()) {
      check();
      totals_.timings.scan_to_verdict.push_back(stopwatch.lapMicroseconds());
      totals_.timings.verdict_at.push_back(*now_);
    }
    count(outcome, sensor);
    if (observer_.mapped) observer_.mapped(monitor_, sensor);
  }
}

void Evaluation::count(const Monitor::ScanOutcome& outcome, std::size_t sensor) {
  const CuboidMap& map = *monitor_.map(sensor);
  const std::size_t held = heldIn(map);
  countScans(sensor, [&](ScanTotals& totals) {
    ++totals.scans_mapped;
    for (std::size_t kind = 0; kind < kBeamKinds; ++kind) totals.beams[kind] += outcome.beams[kind];
    totals.points_mapped += outcome.added.mapped;
    totals.points_out_of_area += outcome.added.out_of_area;
    totals.cuboids_sum += map.cuboids.size();
    totals.cuboids_max = std::max(totals.cuboids_max, map.cuboids.size());
    totals.overflowed_maps += map.overflowed ? 1 : 0;
    totals.complete_maps += map.complete ? 1 : 0;
  });
  totals_.sight.held_sum += held;
  totals_.sight.held_max = std::max(totals_.sight.held_max, held);
  totals_.timings.assemble.push_back(outcome.assemble_us);
  totals_.timings.integrate.push_back(outcome.integrate_us);
  totals_.timings.snapshot.push_back(outcome.snapshot_us);
}

void Evaluation::countDropped(std::size_t sensor, const std::string& reason, std::size_t scans) {
  countScans(sensor, [&](ScanTotals& totals) { totals.scans_dropped[reason] += scans; });
}

void Evaluation::check() {
  Checker& checker = monitor_.checker();
  for (std::size_t i = 0; i < root_frames_.size(); ++i) {
    const auto root = transforms_.newest(fixed_frame_, root_frames_[i]);
    if (root) checker.setRootPose(i, root->stamp, root->pose, root->is_static);
  }
  const Verdict& verdict = checker.check(*now_);
  ++totals_.checks;
  totals_.checks_unknown += verdict.known ? 0 : 1;
  totals_.collisions += verdict.collision ? 1 : 0;
  totals_.occlusions += verdict.occlusion ? 1 : 0;
  totals_.stops += verdict.stop ? 1 : 0;
  totals_.slows += verdict.level == Level::kSlow ? 1 : 0;
  if (verdict.level == Level::kSlow) ++totals_.slow_reasons[verdict.reason];
  if (verdict.stop) ++totals_.stop_reasons[verdict.reason];
  if (verdict.placed) {
    const CheckTimes& times = checker.times();
    totals_.timings.collision.push_back(times.collision_us + times.way_us);
    totals_.timings.clearance.push_back(times.clearance_us);
    totals_.timings.occlusion.push_back(times.occlusion_us);
    totals_.timings.evidence.push_back(times.evidence_us);
    noteSight(verdict);
  }
  noteStop(verdict);
  if (observer_.checked) observer_.checked(verdict, checker);
}

void Evaluation::noteSight(const Verdict& verdict) {
  SightTotals& sight = totals_.sight;
  const Checker& checker = monitor_.checker();
  ++sight.checks;
  sight.unseen_sum += verdict.unseen_fraction;
  const bool is_above = verdict.unseen_fraction > checker.config().evidence.unseen_fraction_max;
  sight.unseen_above += is_above ? 1 : 0;
  sight.governed_sum += verdict.governed_scale;
  sight.governed_min = std::min(sight.governed_min, verdict.governed_scale);
  std::optional<double> oldest_s;
  for (const LinkEvidence& link : checker.evidence().findings().links) {
    if (link.age_s) oldest_s = std::max(oldest_s.value_or(0.0), *link.age_s);
  }
  if (!oldest_s) return;
  ++sight.ages;
  sight.age_sum_s += *oldest_s;
  sight.age_max_s = std::max(sight.age_max_s, *oldest_s);
}

void Evaluation::noteStop(const Verdict& verdict) {
  std::vector<StopRun>& runs = totals_.stop_runs;
  if (in_a_run_) runs.back().to = verdict.stamp;
  const bool goes_on = in_a_run_ && verdict.stop && runs.back().reason == verdict.reason;
  if (verdict.stop && !goes_on) {
    runs.push_back(
        {verdict.stamp, verdict.stamp, verdict.reason, verdict.link, verdict.detail, !stopped_});
  }
  in_a_run_ = verdict.stop;
  stopped_ = verdict.stop;
}

void play(const Recording& recording, Evaluation& evaluation,
          const std::function<void(double fraction)>& progress) {
  Recording::Sink sink;
  const auto add = [&](const auto& message, std::size_t sensor, const auto& from) {
    evaluation.add(message, sensor, from);
  };
  sink.scan = add;
  sink.cloud = add;
  sink.joint_states = [&](const auto& message, const auto& from) { evaluation.add(message, from); };
  sink.transforms = [&](const auto& message, bool fixed) { evaluation.add(message, fixed); };
  sink.progress = progress;
  recording.play(sink);
  evaluation.finish();
}

}  // namespace tccm
