#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "fuzz/byte_reader.h"
#include "fuzz/promises.h"
#include "ros/conversions.h"
#include "ros/transform_history.h"

/// What the fuzz target of transforms and the test of its corpus do with an input: messages of
/// transforms between a few frames, late, wrong or in circles, and lookups in between.
namespace tccm::test {

inline std::string fuzzedFrame(ByteReader& bytes) {
  return bytes.oneOf<const char*>({"map", "base", "head", "laser", "/base", "//map", "", "/"});
}

inline geometry_msgs::TransformStamped fuzzedTransform(ByteReader& bytes, Time stamp) {
  geometry_msgs::TransformStamped message;
  const std::uint8_t kind = bytes.byte();
  static const std::array<std::pair<const char*, const char*>, 3> kEdges{
      {{"map", "base"}, {"base", "head"}, {"head", "laser"}}};
  const auto& [parent, child] = kEdges.at(kind % kEdges.size());
  message.header.frame_id = parent;
  message.child_frame_id = child;
  if (kind >= 0xf0U) {
    message.header.frame_id = fuzzedFrame(bytes);
    message.child_frame_id = fuzzedFrame(bytes);
  }
  message.header.stamp = toRos(kind >= 0xc0U ? stamp + bytes.step(-60, 60) : stamp);
  auto& [translation, rotation] = message.transform;
  translation.x = bytes.number(-1.0, 1.0);
  translation.y = bytes.number(-1.0, 1.0);
  const double angle = bytes.number(-3.0, 3.0);
  rotation.z = std::sin(0.5 * angle);
  rotation.w = std::cos(0.5 * angle);
  if (bytes.seldom()) rotation.w = bytes.number(-1.0, 1.0);
  if (bytes.seldom()) rotation.x = bytes.number(-0.1, 0.1);
  return message;
}

/// All that was heard, to be searched through.
class HeardTransforms {
 public:
  void hear(const geometry_msgs::TransformStamped& message, bool is_static) {
    const std::string child = withoutSlash(message.child_frame_id);
    const std::string parent = withoutSlash(message.header.frame_id);
    const auto& t = message.transform.translation;
    heard_[child].push_back(
        {parent, is_static, toTime(message.header.stamp), Vector3(t.x, t.y, t.z)});
  }
  /// Whether something said of the frame lies around the instant, no further apart than that.
  [[nodiscard]] bool isAround(const std::string& child, Time stamp, Duration gap_max) const {
    const auto found = heard_.find(child);
    if (found == heard_.end()) return false;
    Time before = Time::min(), after = Time::max();
    for (const Heard& heard : found->second) {
      if (heard.is_static) return true;
      if (heard.stamp <= stamp) before = std::max(before, heard.stamp);
      if (heard.stamp >= stamp) after = std::min(after, heard.stamp);
    }
    return before > Time::min() && after < Time::max() && after - before <= gap_max;
  }
  /// The box around all places that the frame was said to be at in that of its parent.
  [[nodiscard]] UprightBox placesOf(const std::string& child, const std::string& parent) const {
    UprightBox box;
    const auto found = heard_.find(child);
    if (found == heard_.end()) return box;
    for (const Heard& heard : found->second) {
      if (heard.parent == parent && heard.place.allFinite()) box.extend(heard.place);
    }
    return box;
  }
  /// Whether the frame has had no other parent.
  [[nodiscard]] bool isChildOf(const std::string& child, const std::string& parent) const {
    const auto found = heard_.find(child);
    return found != heard_.end() &&
           std::all_of(found->second.begin(), found->second.end(),
                       [&](const Heard& heard) { return heard.parent == parent; });
  }
  /// Whether it was ever said, over however many frames, to hang below the other: then the way from
  /// one to the other may be another.
  [[nodiscard]] bool wasBelow(const std::string& frame, const std::string& other) const {
    std::vector<std::string> found{frame};
    for (std::size_t i = 0; i < found.size(); ++i) {
      const auto parents = heard_.find(found[i]);
      if (parents == heard_.end()) continue;
      for (const Heard& heard : parents->second) {
        if (heard.parent == other) return true;
        if (std::count(found.begin(), found.end(), heard.parent) == 0) {
          found.push_back(heard.parent);
        }
      }
    }
    return false;
  }

 private:
  struct Heard {
    std::string parent;
    bool is_static;
    Time stamp;
    Vector3 place;
  };
  std::map<std::string, std::vector<Heard>> heard_;
};

/// What is found was heard, on both sides of the instant.
inline void requireLookup(const TransformHistory& history, const HeardTransforms& heard,
                          const std::string& target, const std::string& source, Time stamp,
                          Duration gap_max) {
  using Status = TransformHistory::Status;
  const auto found = history.at(target, source, stamp);
  if (found.status != Status::kFound) return;
  promise(found.pose.matrix().allFinite(), "a pose is not finite");
  if (target == source || !heard.isChildOf(source, target)) return;
  if (heard.wasBelow(target, source)) return;
  promise(heard.isAround(source, stamp, gap_max), "a pose is found where nothing was heard");
  const UprightBox places = heard.placesOf(source, target);
  const Vector3 place = found.pose.translation();
  const double rounding = 1e-9 * (1.0 + place.cwiseAbs().maxCoeff());
  promise(!places.isEmpty() && places.exteriorDistance(place) <= rounding,
          "a frame is found where it never was");
}

inline void requirePath(const TransformHistory& history, const std::string& target,
                        const std::string& source, Time stamp) {
  const Time last = stamp + std::chrono::milliseconds(20);
  PosePath path;
  const auto status = history.path(target, source, stamp, last, std::chrono::milliseconds(4), path);
  promise((status == TransformHistory::Status::kFound) == path.covers(stamp, last),
          "a path does not reach from first to last");
  const auto newest = history.newest(target, source);
  if (newest) promise(newest->pose.matrix().allFinite(), "the newest pose is not finite");
}

inline void runTransforms(const std::string& input) {
  ByteReader bytes(input);
  const Duration gap_max = std::chrono::milliseconds(100);
  TransformHistory history(gap_max);
  HeardTransforms heard;
  Time stamp{std::chrono::seconds(100)};
  for (int i = 0; i < 60 && !bytes.isEmpty(); ++i) {
    const std::uint8_t kind = bytes.byte();
    stamp = std::max(Time(), stamp + bytes.step(1, 40));
    tf2_msgs::TFMessage message;
    const bool is_static = (kind & 0xf0U) == 0xf0U;
    for (unsigned k = kind & 3U; k > 0; --k) {
      message.transforms.push_back(fuzzedTransform(bytes, stamp));
      heard.hear(message.transforms.back(), is_static);
    }
    history.add(message, is_static);
    if ((kind & 0xfU) == 0xfU) history.clear();
    const std::string target = bytes.oneOf<const char*>({"map", "base", "head", "laser", "none"});
    const std::string source = bytes.oneOf<const char*>({"laser", "head", "base", "map", ""});
    const Time asked = std::max(Time(), stamp + bytes.step(-150, 10));
    requireLookup(history, heard, target, source, asked, gap_max);
    requirePath(history, target, source, asked);
  }
}

/// What a history of transforms broke of its promises, or nothing.
inline std::string transformsDefect(const std::string& input) {
  return brokenPromise([&] { runTransforms(input); });
}

}  // namespace tccm::test
