#include "ros/stops/stop_recorder.h"

#include <tf2_eigen/tf2_eigen.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <utility>

#include "check/check_inputs.h"
#include "ros/conversions.h"
#include "ros/stops/message_delta.h"
#include "ros/transform_history.h"

namespace tccm {
namespace {

constexpr Duration kCloudPeriod = std::chrono::milliseconds(200);  // of those of cameras
constexpr Duration kEndsLate = std::chrono::seconds(1);            // that a trajectory may
constexpr std::size_t kCallsWaiting = 4;

/// What a file may be called.
std::string fileNameOf(const std::string& text) {
  std::string name = text;
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  return name.substr(0, 60);
}

tccm_monitor::Exemption toMessage(const Exemption& exemption) {
  tccm_monitor::Exemption message;
  message.owner = exemption.owner;
  message.link = exemption.link;
  message.frame = exemption.frame;
  message.with_goal = exemption.with_goal && exemption.state == Exemption::State::kAwaitsGoal;
  message.region = tccm::toMessage(exemption.region);
  message.until = toRos(exemption.until);
  return message;
}

tccm_monitor::KeepOutRegion toMessage(const KeepOutRegion& region) {
  tccm_monitor::KeepOutRegion message;
  message.name = region.name;
  message.frame = region.frame;
  message.pose = tf2::toMsg(region.T_frame_box);
  const Vector3 size = 2.0 * region.box.half_extents;
  message.size.x = size.x();
  message.size.y = size.y();
  message.size.z = size.z();
  return message;
}

tccm_monitor::AttachedObject toMessage(const AttachedObject& object) {
  tccm_monitor::AttachedObject message;
  message.name = object.name;
  message.link = object.link;
  message.primitive = tccm::toMessage(object.primitive);
  return message;
}

Duration lengthOf(const trajectory_msgs::JointTrajectory& trajectory) {
  if (trajectory.points.empty()) return {};
  return std::chrono::nanoseconds(trajectory.points.back().time_from_start.toNSec());
}

/// As for CommandedTrajectories::command(): one that names no joint concerns all.
bool shareJoint(const trajectory_msgs::JointTrajectory& a,
                const trajectory_msgs::JointTrajectory& b) {
  if (a.joint_names.empty() || b.joint_names.empty()) return true;
  return std::find_first_of(a.joint_names.begin(), a.joint_names.end(), b.joint_names.begin(),
                            b.joint_names.end()) != a.joint_names.end();
}

}  // namespace

StopRecorder::StopRecorder(const StopsConfig& config, StopWriter::Preamble preamble,
                           const std::vector<std::string>& sensors)
    : topics_(stopTopics(sensors)),
      ring_(static_cast<std::size_t>(1e6 * config.memory_mb)),
      writer_(config.folder, static_cast<std::size_t>(config.bags_max), std::move(preamble),
              topics_),
      maps_(sensors.size()),
      waiting_(kCallsWaiting),
      clouds_(sensors.size()) {
  chunks_.reserve(RecordRing::kHistory);
  name_.reserve(200);
}

StopRecorder::Call& StopRecorder::begin(std::uint8_t call, Time now, std::size_t sensor) {
  now_ = now;
  call_.call = call;
  call_.now = toRos(now);
  call_.sensor = static_cast<std::uint8_t>(sensor);
  call_.publisher.clear();
  call_.outside_reason.clear();
  call_.outside_detail.clear();
  call_.reason.clear();
  call_.link.clear();
  call_.detail.clear();
  call_.clock_stalls = call_.stop = 0;
  call_.latency_s = 0.0;
  call_.level = 0;
  return call_;
}

void StopRecorder::joints(Time now, const sensor_msgs::JointState& message,
                          const std::string& publisher) {
  begin(Call::JOINTS, now).publisher = publisher;
  append(call_, topicIndex(StopTopicId::kJoints), message);
}

void StopRecorder::transforms(Time now, const tf2_msgs::TFMessage& message, bool is_static) {
  if (is_static) {
    auto& known = state_.static_transforms;
    for (const auto& transform : message.transforms) {
      const auto same = std::find_if(known.begin(), known.end(), [&transform](const auto& other) {
        return other.child_frame_id == transform.child_frame_id;
      });
      if (same == known.end()) {
        if (known.size() < TransformHistory::kNamesMax) known.push_back(transform);
      } else {
        *same = transform;
      }
    }
  }
  const Call& call = begin(is_static ? Call::STATIC_TRANSFORMS : Call::TRANSFORMS, now);
  append(call, topicIndex(is_static ? StopTopicId::kStaticTransforms : StopTopicId::kTransforms),
         message);
}

void StopRecorder::report(Time now, const tccm_monitor::ScanReport& message, std::size_t sensor) {
  append(begin(Call::REPORT, now, sensor), topicIndex(sensor, SensorTopicId::kReport), message);
}

void StopRecorder::points(Time now, const sensor_msgs::PointCloud2& message, std::size_t sensor) {
  append(begin(Call::POINTS, now, sensor), topicIndex(sensor, SensorTopicId::kPoints), message);
}

void StopRecorder::points(Time now, const tccm_monitor::CloudScan& message, std::size_t sensor) {
  std::optional<Time>& last = clouds_[sensor];
  if (last && now >= *last && now - *last < kCloudPeriod) return;
  last = now;
  append(begin(Call::POINTS, now, sensor), topicIndex(sensor, SensorTopicId::kCloud), message);
}

void StopRecorder::trajectory(Time now, const trajectory_msgs::JointTrajectory& message) {
  append(begin(Call::TRAJECTORY, now), topicIndex(StopTopicId::kTrajectory), message);
  forgetEnded(now);
  for (std::size_t i = state_.trajectories.size(); i-- > 0;) {
    const bool replaced = shareJoint(state_.trajectories[i], message);
    if (!replaced && state_.trajectories.size() < kTrajectories) continue;
    state_.trajectories.erase(state_.trajectories.begin() + static_cast<std::ptrdiff_t>(i));
    state_.commanded.erase(state_.commanded.begin() + static_cast<std::ptrdiff_t>(i));
  }
  state_.trajectories.push_back(message);
  state_.commanded.push_back(toRos(now));
}

void StopRecorder::forgetEnded(Time now) {
  if (misunderstands_) return;  // until something else is commanded
  for (std::size_t i = state_.trajectories.size(); i-- > 0;) {
    const auto& trajectory = state_.trajectories[i];
    // Not as ROS has it, which throws where a stamp is near the end of its times.
    const Time start =
        toTime(trajectory.header.stamp.isZero() ? state_.commanded[i] : trajectory.header.stamp);
    if (start + lengthOf(trajectory) + kEndsLate > now) continue;
    state_.trajectories.erase(state_.trajectories.begin() + static_cast<std::ptrdiff_t>(i));
    state_.commanded.erase(state_.commanded.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

void StopRecorder::startAnew(Time now) {
  state_.trajectories.clear();
  state_.commanded.clear();
  note(begin(Call::START_ANEW, now));
}

void StopRecorder::mapComes(Time now, const PublishedMap::ConstPtr& published, std::size_t sensor) {
  coming_call_ = begin(Call::MAP, now, sensor);
  coming_ = published;
}

void StopRecorder::commit() {
  if (!coming_) return;
  appendMap();
  coming_.reset();
  for (std::size_t i = 0; i < waits_; ++i) note(waiting_[i]);
  waits_ = 0;
}

void StopRecorder::appendMap() {
  const std::size_t sensor = coming_call_.sensor;
  message_.resize(ros::serialization::serializationLength(*coming_));
  ros::serialization::OStream stream(message_.data(), static_cast<std::uint32_t>(message_.size()));
  ros::serialization::serialize(stream, *coming_);
  // What differs is never much longer than all of it.
  if (!makeRoomFor(coming_call_, message_.size() + message_.size() / 4 + 100)) return;
  place(topicIndex(StopTopicId::kCalls), coming_call_);
  std::vector<std::uint8_t>& last = maps_[sensor];
  if (last.empty()) {
    const std::uint8_t topic = topicIndex(sensor, SensorTopicId::kMap);
    std::uint8_t* bytes = placeFor(topic, message_.size());
    if (!bytes) return;
    std::copy(message_.begin(), message_.end(), bytes);
  } else {
    toChange(last, message_, change_);
    place(topicIndex(sensor, SensorTopicId::kMapChange), change_);
  }
  std::swap(last, message_);
}

void StopRecorder::check(Time now, const Cause& outside, const Verdict& verdict,
                         const Checker& checker, CheckerConfig& config) {
  followState(now, checker, config);
  Call& call = begin(Call::CHECK, now);
  call.clock_stalls = static_cast<std::uint8_t>(checker.inputs().clockStalls());
  call.latency_s = checker.latency();
  call.outside_reason = name(outside.reason);
  call.outside_detail = outside.detail;
  noteVerdict(call, verdict);
}

void StopRecorder::fail(Time now, const Cause& cause, const Verdict& verdict) {
  Call& call = begin(Call::FAIL, now);
  call.outside_reason = name(cause.reason);
  call.outside_detail = cause.detail;
  noteVerdict(call, verdict);
}

void StopRecorder::noteVerdict(Call& call, const Verdict& verdict) {
  misunderstands_ =
      std::count(verdict.reasons.begin(), verdict.reasons.end(), Reason::kBadTrajectory) > 0;
  call.level = static_cast<std::uint8_t>(verdict.level);
  call.reason = name(verdict.reason);
  call.link = verdict.link;
  call.detail = verdict.detail;
  call.stop = static_cast<std::uint8_t>(verdict.stop);
  if (verdict.stop && std::exchange(was_permitted_, false)) {
    char stamp[32];
    std::snprintf(stamp, sizeof stamp, "%014.3f", toSeconds(verdict.stamp.time_since_epoch()));
    name_ = fileNameOf(std::string(stamp) + "_" + call.reason + "_" + call.link);
    stops_ = true;
  }
  if (!verdict.stop) was_permitted_ = true;
  note(call);
}

void StopRecorder::note(const Call& call) {
  if (coming_) {
    if (waits_ == waiting_.size()) waiting_.emplace_back();
    waiting_[waits_++] = call;
    return;
  }
  if (std::exchange(state_changed_, false)) appendState();
  append(call);
  if (std::exchange(stops_, false)) writeStop();
}

void StopRecorder::followState(Time now, const Checker& checker, CheckerConfig& config) {
  if (revision_ == checker.revision()) return;
  revision_ = checker.revision();
  forgetEnded(now);
  state_.attached_objects.clear();
  for (const auto& object : checker.attached()) {
    state_.attached_objects.push_back(toMessage(object));
  }
  state_.exemptions.clear();
  for (const auto& exemption : checker.exemptions()) {
    state_.exemptions.push_back(toMessage(exemption));
  }
  state_.keep_out.clear();
  for (const auto& region : checker.keepOut()) state_.keep_out.push_back(toMessage(region));
  state_.parameters.clear();
  const ParameterTable table = tableOf(config);
  for (const ParameterTable::Row& row : table.rows()) {
    state_.parameters += row.key + ": " + textOf(row.member) + "\n";
  }
  state_changed_ = true;
}

void StopRecorder::append(const Call& call) {
  startChunkFor(ros::serialization::serializationLength(call));
  place(topicIndex(StopTopicId::kCalls), call);
}

template <typename Message>
void StopRecorder::append(const Call& call, std::uint8_t topic, const Message& message) {
  if (!makeRoomFor(call, ros::serialization::serializationLength(message))) return;
  place(topicIndex(StopTopicId::kCalls), call);
  place(topic, message);
}

bool StopRecorder::makeRoomFor(const Call& call, std::size_t size) {
  const std::size_t both =
      ros::serialization::serializationLength(call) + RecordRing::kHeader + size;
  startChunkFor(both);
  const bool fits = !ring_.startsChunk(both);
  if (!fits) ++lost_;
  return fits;
}

template <typename Message>
void StopRecorder::place(std::uint8_t topic, const Message& message) {
  const std::uint32_t size = ros::serialization::serializationLength(message);
  std::uint8_t* bytes = placeFor(topic, size);
  if (!bytes) return;
  ros::serialization::OStream stream(bytes, size);
  ros::serialization::serialize(stream, message);
}

void StopRecorder::startChunkFor(std::size_t size) {
  if (!ring_.startsChunk(size)) return;
  ring_.endChunk();
  for (auto& map : maps_) map.clear();  // the first in a chunk is whole
  state_changed_ = false;
  appendState();
}

void StopRecorder::appendState() {
  Call call;
  call.call = Call::STATE;
  place(topicIndex(StopTopicId::kCalls), call);
  place(topicIndex(StopTopicId::kState), state_);
}

std::uint8_t* StopRecorder::placeFor(std::uint8_t topic, std::size_t size) {
  // Bags are read by their stamps: no two records have the same.
  stamp_ = std::max(now_, stamp_ + Duration(1));
  std::uint8_t* place = ring_.append(topic, stamp_, size);
  if (!place) ++lost_;
  return place;
}

void StopRecorder::writeStop() {
  if (!writer_.isIdle()) {
    ++missed_;
    return;
  }
  ring_.pin(chunks_);
  writer_.write(name_, chunks_);
}

StopRecorder::Report StopRecorder::report() {
  return {writer_.report(), missed_, lost_, ring_.bytes()};
}

}  // namespace tccm
