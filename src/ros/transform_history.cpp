#include "ros/transform_history.h"

#include <tf2/exceptions.h>
#include <tf2_eigen/tf2_eigen.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "ros/conversions.h"

namespace tccm {
namespace {

constexpr std::size_t kLongestChain = 1000;  // of frames; more is a loop

constexpr Duration kJumpBack = std::chrono::seconds(1);  // more is time beginning anew

using Status = TransformHistory::Status;

/// The frames from one up to the root of its tree.
std::vector<std::string> chainOf(const std::map<std::string, std::string>& parents,
                                 const std::string& frame) {
  std::vector<std::string> chain{frame};
  for (auto it = parents.find(frame); it != parents.end() && chain.size() < kLongestChain;
       it = parents.find(it->second)) {
    chain.push_back(it->second);
  }
  return chain;
}

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

std::string withoutSlash(const std::string& frame) {
  const std::size_t first = frame.find_first_not_of('/');
  return first == std::string::npos ? std::string() : frame.substr(first);
}

TransformHistory::TransformHistory(tf2::BufferCore& buffer, Duration gap_max, Duration kept)
    : buffer_(buffer), gap_max_(gap_max), kept_(kept) {}

void TransformHistory::add(const tf2_msgs::TFMessage& message, bool is_static) {
  for (geometry_msgs::TransformStamped transform : message.transforms) {
    transform.header.frame_id = withoutSlash(transform.header.frame_id);
    transform.child_frame_id = withoutSlash(transform.child_frame_id);
    normalize(transform.transform.rotation);
    const Time stamp = toTime(transform.header.stamp);
    if (!is_static && jumpsBack(transform.child_frame_id, stamp)) clear();
    if (!buffer_.setTransform(transform, "tccm_monitor", is_static)) continue;
    const std::string& child = transform.child_frame_id;
    // Nothing is interpolated from one parent to another.
    if (std::exchange(parents_[child], transform.header.frame_id) != transform.header.frame_id) {
      stamps_.erase(child);
    }
    static_[child] = is_static;
    if (is_static) continue;
    std::deque<Time>& stamps = stamps_[child];
    // Usually at the end; several publishers may be out of step.
    const auto at = std::upper_bound(stamps.begin(), stamps.end(), stamp);
    if (at == stamps.begin() || *(at - 1) != stamp) stamps.insert(at, stamp);
    while (stamps.back() - stamps.front() > kept_) stamps.pop_front();
  }
}

bool TransformHistory::jumpsBack(const std::string& child, Time stamp) const {
  const auto found = stamps_.find(child);
  return found != stamps_.end() && !found->second.empty() &&
         found->second.back() - stamp > kJumpBack;
}

void TransformHistory::clear() {
  buffer_.clear();
  stamps_.clear();
}

std::vector<std::string> TransformHistory::movingFrames(const std::string& target,
                                                        const std::string& source) const {
  std::vector<std::string> from_target = chainOf(parents_, target);
  std::vector<std::string> from_source = chainOf(parents_, source);
  // What both share lies above their common ancestor and takes no part.
  while (from_target.size() > 1 && from_source.size() > 1 &&
         from_target[from_target.size() - 2] == from_source[from_source.size() - 2]) {
    from_target.pop_back();
    from_source.pop_back();
  }
  if (from_target.back() == from_source.back()) {
    from_target.pop_back();
    from_source.pop_back();
  }
  std::vector<std::string> moving;
  for (const auto& chain : {from_target, from_source}) {
    for (const std::string& frame : chain) {
      const auto found = static_.find(frame);
      if (found != static_.end() && !found->second) moving.push_back(frame);
    }
  }
  return moving;
}

Status TransformHistory::around(const std::string& child, Time stamp) const {
  const auto found = stamps_.find(child);
  if (found == stamps_.end() || found->second.empty()) return Status::kNotYet;
  const std::deque<Time>& stamps = found->second;
  const auto after = std::lower_bound(stamps.begin(), stamps.end(), stamp);
  if (after == stamps.end()) return Status::kNotYet;
  if (*after == stamp) return Status::kFound;
  if (after == stamps.begin()) return Status::kNever;
  return *after - *(after - 1) > gap_max_ ? Status::kGap : Status::kFound;
}

TransformHistory::Lookup TransformHistory::at(const std::string& target, const std::string& source,
                                              Time stamp) const {
  for (const std::string& child : movingFrames(target, source)) {
    const Status status = around(child, stamp);
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

const char* TransformHistory::name(Status status) {
  switch (status) {
    case Status::kFound:
      return "found";
    case Status::kNotYet:
    case Status::kNever:
      return "no_transform";
    case Status::kGap:
      return "transform_gap";
  }
  return "no_transform";
}

}  // namespace tccm
