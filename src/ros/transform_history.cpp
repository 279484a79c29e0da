#include "ros/transform_history.h"

#include <tf2/exceptions.h>
#include <tf2_eigen/tf2_eigen.h>

#include <algorithm>
#include <cmath>

#include "base/line_of.h"
#include "ros/conversions.h"
#include "ros/handles.h"

namespace tccm {
namespace {

using Status = TransformHistory::Status;

constexpr std::size_t kNamesMax = 2000;                  // of frames; tf2 never forgets one
constexpr std::size_t kLongestChain = 1000;              // of frames; more is a loop
constexpr Duration kJumpBack = std::chrono::seconds(1);  // more is time beginning anew
// As long as tf2 keeps them.
constexpr Duration kKept = std::chrono::seconds(tf2::BufferCore::DEFAULT_CACHE_TIME);

/// Quaternions are often written with three digits. tf2 takes those for rotations and refuses what
/// is further off, which is left as it is here.
void normalize(geometry_msgs::Quaternion& q) {
  const double length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  if (!(std::abs(length - 1.0) < 5e-3)) return;
  q.x /= length;
  q.y /= length;
  q.z /= length;
  q.w /= length;
}

}  // namespace

void TransformHistory::add(const tf2_msgs::TFMessage& message, bool is_static) {
  for (geometry_msgs::TransformStamped transform : message.transforms) {
    transform.header.frame_id = withoutSlash(transform.header.frame_id);
    transform.child_frame_id = withoutSlash(transform.child_frame_id);
    normalize(transform.transform.rotation);
    if (!knows(transform.header.frame_id) || !knows(transform.child_frame_id)) {
      ++passed_over_;
      continue;
    }
    const Time stamp = toTime(transform.header.stamp);
    const auto known = frames_.find(transform.child_frame_id);
    const bool is_known = !is_static && known != frames_.end() && !known->second.stamps.empty();
    if (is_known && known->second.stamps.back() - stamp > kJumpBack) clear();
    if (!buffer_.setTransform(transform, "tccm_monitor", is_static)) continue;
    Frame& frame = frames_[transform.child_frame_id];
    // Nothing is interpolated from one parent to another.
    if (frame.parent != transform.header.frame_id) frame.stamps.clear();
    frame.parent = transform.header.frame_id;
    frame.is_static = is_static;
    if (is_static) continue;
    // Usually at the end; several publishers may be out of step.
    std::deque<Time>& stamps = frame.stamps;
    const auto at = std::upper_bound(stamps.begin(), stamps.end(), stamp);
    if (at == stamps.begin() || *(at - 1) != stamp) stamps.insert(at, stamp);
    while (stamps.back() - stamps.front() > kKept) stamps.pop_front();
  }
}

bool TransformHistory::knows(const std::string& frame) {
  if (names_.count(frame) > 0) return true;
  if (names_.size() == kNamesMax) return false;
  names_.insert(frame);
  return true;
}

std::string TransformHistory::defect() const {
  if (passed_over_ == 0) return "";
  return lineOf(
      "%zu transforms were passed over: there are more than %zu frame names; see who "
      "publishes ever new ones on /tf",
      passed_over_, kNamesMax);
}

void TransformHistory::clear() {
  buffer_.clear();
  for (auto& entry : frames_) entry.second.stamps.clear();
}

std::vector<const TransformHistory::Frame*> TransformHistory::movingFrames(
    const std::string& frame) const {
  std::vector<const Frame*> moving;
  auto above = frames_.find(frame);
  for (std::size_t i = 0; above != frames_.end() && i < kLongestChain; ++i) {
    if (!above->second.is_static) moving.push_back(&above->second);
    above = frames_.find(above->second.parent);
  }
  return moving;
}

std::vector<const TransformHistory::Frame*> TransformHistory::movingFrames(
    const std::string& target, const std::string& source) const {
  std::vector<const Frame*> way = movingFrames(target), from_source = movingFrames(source);
  // What both share lies above their common ancestor and takes no part.
  while (!way.empty() && !from_source.empty() && way.back() == from_source.back()) {
    way.pop_back();
    from_source.pop_back();
  }
  way.insert(way.end(), from_source.begin(), from_source.end());
  return way;
}

Status TransformHistory::around(const std::deque<Time>& stamps, Time stamp, Duration gap_max) {
  const auto after = std::lower_bound(stamps.begin(), stamps.end(), stamp);
  if (after == stamps.end()) return Status::kNotYet;
  if (*after == stamp) return Status::kFound;
  if (after == stamps.begin()) return Status::kNever;
  return *after - *(after - 1) > gap_max ? Status::kGap : Status::kFound;
}

TransformHistory::Lookup TransformHistory::at(const std::string& target, const std::string& source,
                                              Time stamp, Duration gap_max) const {
  for (const Frame* frame : movingFrames(target, source)) {
    const Status status = around(frame->stamps, stamp, gap_max);
    if (status != Status::kFound) return {status, Pose::Identity()};
  }
  try {
    return {Status::kFound,
            Pose(tf2::transformToEigen(buffer_.lookupTransform(target, source, toRos(stamp))))};
  } catch (const tf2::ExtrapolationException&) {
    return {Status::kNever, Pose::Identity()};
  } catch (const tf2::TransformException&) {
    return {Status::kNotYet, Pose::Identity()};
  }
}

Status TransformHistory::path(const std::string& target, const std::string& source, Time first,
                              Time last, Duration step, PosePath& path) const {
  path.clear();
  const auto intervals = std::max<Duration::rep>(1, (last - first + step) / step);
  for (Duration::rep i = 0; i <= intervals; ++i) {
    const Time stamp = first + (last - first) * i / intervals;
    if (i > 0 && last == first) break;
    const Lookup lookup = at(target, source, stamp);
    if (lookup.status != Status::kFound || !path.add(stamp, lookup.pose)) {
      path.clear();
      return lookup.status == Status::kFound ? Status::kNever : lookup.status;
    }
  }
  return Status::kFound;
}

std::optional<TransformHistory::Newest> TransformHistory::newest(const std::string& target,
                                                                 const std::string& source) const {
  if (target == source) return Newest{Time(), Pose::Identity(), true};
  try {
    const auto transform = buffer_.lookupTransform(target, source, ros::Time(0));
    return Newest{toTime(transform.header.stamp), Pose(tf2::transformToEigen(transform)),
                  movingFrames(target, source).empty()};
  } catch (const tf2::TransformException&) {
    return std::nullopt;
  }
}

std::vector<ros::Subscriber> hearTransforms(ros::NodeHandle node, TransformHistory& history,
                                            const std::function<void()>& heard) {
  const auto hear = [&](const std::string& topic, std::uint32_t queue, bool is_static) {
    return required(node.subscribe<tf2_msgs::TFMessage>(
                        topic, queue,
                        [&history, heard, is_static](const tf2_msgs::TFMessage::ConstPtr& message) {
                          history.add(*message, is_static);
                          heard();
                        },
                        ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay()),
                    node, topic);
  };
  return {hear("/tf", 1000, false), hear("/tf_static", 100, true)};
}

}  // namespace tccm
