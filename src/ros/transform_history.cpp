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

constexpr std::size_t kLongestChain = 1000;                     // of frames; more is a loop
constexpr Duration kJumpBack = std::chrono::seconds(1);         // more is time beginning anew
constexpr Duration kStepBack = std::chrono::milliseconds(100);  // the same, of the clock
constexpr const char* kAuthority = "tccm_monitor";

/// Quaternions are often written with three digits. What is further off is no rotation.
/// @return whether it is one.
bool normalize(geometry_msgs::Quaternion& q) {
  const double length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  if (!(std::abs(length - 1.0) < 5e-3)) return false;
  q.x /= length;
  q.y /= length;
  q.z /= length;
  q.w /= length;
  return true;
}

/// Normalizes the rotation. @return why it is no transform, or nothing. tf2 refuses most of it too,
/// but prints lines for each: thousands a second where a publisher goes wrong.
const char* whyRefused(geometry_msgs::TransformStamped& transform) {
  const std::string& parent = transform.header.frame_id;
  const geometry_msgs::Vector3& shift = transform.transform.translation;
  if (parent.empty() || transform.child_frame_id.empty()) return "it names no frame";
  if (parent == transform.child_frame_id) return "its frame is its own parent";
  if (!std::isfinite(shift.x) || !std::isfinite(shift.y) || !std::isfinite(shift.z)) {
    return "its translation is not finite";
  }
  return normalize(transform.transform.rotation) ? nullptr : "its quaternion is not of length 1";
}

}  // namespace

void TransformHistory::add(const tf2_msgs::TFMessage& message, bool is_static) {
  for (const geometry_msgs::TransformStamped& heard : message.transforms) {
    transform_.header.stamp = heard.header.stamp;
    transform_.header.frame_id = bareName(heard.header.frame_id);
    transform_.child_frame_id = bareName(heard.child_frame_id);
    transform_.transform = heard.transform;
    const Frame* parent = frameOf(transform_.header.frame_id);
    Frame* frame = frameOf(transform_.child_frame_id);
    if (!parent || !frame) {
      ++passed_over_;
      continue;
    }
    if (const char* const why = whyRefused(transform_)) {
      ++refused_;
      why_refused_ = why;
      refused_frame_ = transform_.child_frame_id;
      continue;
    }
    const Time stamp = toTime(transform_.header.stamp);
    std::vector<Time>& stamps = frame->stamps;
    if (frame->parent && frame->is_static != is_static) {
      ++turned_;
      turned_frame_ = transform_.child_frame_id;
      makeAnew(*frame);
    }
    if (!is_static && !stamps.empty() && stamps.back() - stamp > kJumpBack) clear();
    // Of those of one stamp tf2 keeps the first, and prints lines for each of the others.
    if (!is_static && std::binary_search(stamps.begin(), stamps.end(), stamp)) continue;
    if (!buffer_->setTransform(transform_, kAuthority, is_static)) continue;
    // Nothing is interpolated from one parent to another.
    if (frame->parent != parent || is_static) stamps.clear();
    frame->parent = parent;
    frame->is_static = is_static;
    if (is_static) {
      frame->fixed = transform_;
      continue;
    }
    // Usually at the end; several publishers may be out of step.
    const auto at = std::upper_bound(stamps.begin(), stamps.end(), stamp);
    if (at == stamps.begin() || *(at - 1) != stamp) stamps.insert(at, stamp);
    if (stamps.back() - stamps.front() > kept_ * 5 / 4) {
      stamps.erase(stamps.begin(),
                   std::lower_bound(stamps.begin(), stamps.end(), stamps.back() - kept_));
    }
  }
}

/// tf2 has a frame static, or not, as it was heard first, and never changes that.
void TransformHistory::makeAnew(const Frame& turned) {
  buffer_ = std::make_unique<tf2::BufferCore>(toRos(kept_));
  for (auto& [name, frame] : frames_) {
    frame.stamps.clear();
    if (&frame == &turned || !frame.parent || !frame.is_static) continue;
    buffer_->setTransform(frame.fixed, kAuthority, true);
  }
}

void TransformHistory::setNow(Time now) {
  if (now + kStepBack < now_) clear();
  now_ = now;
}

TransformHistory::Frame* TransformHistory::frameOf(const std::string& name) {
  const auto known = frames_.find(name);
  if (known != frames_.end()) return &known->second;
  return frames_.size() == kNamesMax ? nullptr : &frames_[name];
}

std::string TransformHistory::defect() const {
  if (passed_over_ > 0) {
    return lineOf(
        "%zu transforms were passed over: there are more than %zu frame names; see who "
        "publishes ever new ones on /tf",
        passed_over_, kNamesMax);
  }
  if (turned_ > 0) {
    return lineOf(
        "%.100s was heard of both on /tf and on /tf_static, %zu times in turn: each time all that "
        "moves is forgotten; see who publishes it",
        turned_frame_.c_str(), turned_);
  }
  if (refused_ == 0) return "";
  return lineOf("%zu transforms were refused, at last that of %.100s: %s; see who publishes it",
                refused_, refused_frame_.c_str(), why_refused_);
}

void TransformHistory::clear() {
  buffer_->clear();
  for (auto& entry : frames_) entry.second.stamps.clear();
}

std::size_t TransformHistory::depthOf(const Frame* frame) {
  std::size_t depth = 0;
  for (; frame && depth < kLongestChain; ++depth) frame = frame->parent;
  return depth;
}

template <typename Visit>
bool TransformHistory::visitMoving(const std::string& target, const std::string& source,
                                   Visit&& visit) const {
  const auto find = [this](const std::string& name) {
    const auto known = frames_.find(name);
    return known == frames_.end() ? nullptr : &known->second;
  };
  const Frame* const from_target = find(target);
  const Frame* const from_source = find(source);
  // What both share lies above their common ancestor and takes no part.
  const Frame *a = from_target, *b = from_source;
  std::size_t above_a = depthOf(a), above_b = depthOf(b);
  for (; above_a > above_b; --above_a) a = a->parent;
  for (; above_b > above_a; --above_b) b = b->parent;
  for (; a != b && above_a > 0; --above_a) {
    a = a->parent;
    b = b->parent;
  }
  const auto visitUpTo = [&visit](const Frame* frame, const Frame* end) {
    for (std::size_t i = 0; frame && frame != end && i < kLongestChain;
         ++i, frame = frame->parent) {
      if (frame->parent && !frame->is_static && visit(*frame)) return true;
    }
    return false;
  };
  return visitUpTo(from_target, a) || visitUpTo(from_source, b);
}

Status TransformHistory::around(const std::vector<Time>& stamps, Time stamp, Duration gap_max) {
  const auto after = std::lower_bound(stamps.begin(), stamps.end(), stamp);
  if (after == stamps.end()) return Status::kNotYet;
  if (*after == stamp) return Status::kFound;
  if (after == stamps.begin()) return Status::kNever;
  return *after - *(after - 1) > gap_max ? Status::kGap : Status::kFound;
}

TransformHistory::Lookup TransformHistory::at(const std::string& target, const std::string& source,
                                              Time stamp, Duration gap_max) const {
  Status status = Status::kFound;
  const bool is_missing = visitMoving(target, source, [&](const Frame& frame) {
    status = around(frame.stamps, stamp, gap_max);
    return status != Status::kFound;
  });
  if (is_missing) return {status, Pose::Identity()};
  try {
    const Pose pose(tf2::transformToEigen(buffer_->lookupTransform(target, source, toRos(stamp))));
    // Of huge numbers tf2 makes infinite ones.
    return {pose.matrix().allFinite() ? Status::kFound : Status::kNever, pose};
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
    const auto transform = buffer_->lookupTransform(target, source, ros::Time(0));
    const bool is_moving = visitMoving(target, source, [](const Frame&) { return true; });
    const Pose pose(tf2::transformToEigen(transform));
    if (!pose.matrix().allFinite()) return std::nullopt;
    return Newest{toTime(transform.header.stamp), pose, !is_moving};
  } catch (const tf2::TransformException&) {
    return std::nullopt;
  }
}

std::vector<ros::Subscriber> hearTransforms(
    ros::NodeHandle node, TransformHistory& history,
    const std::function<void(const tf2_msgs::TFMessage& message, bool is_static)>& heard) {
  const auto hear = [&](const std::string& topic, std::uint32_t queue, bool is_static) {
    return required(node.subscribe<tf2_msgs::TFMessage>(
                        topic, queue,
                        [&history, heard, is_static](const tf2_msgs::TFMessage::ConstPtr& message) {
                          history.add(*message, is_static);
                          heard(*message, is_static);
                        },
                        ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay()),
                    node, topic);
  };
  return {hear("/tf", 1000, false), hear("/tf_static", 100, true)};
}

}  // namespace tccm
