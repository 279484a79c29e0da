#pragma once

#include <ros/node_handle.h>
#include <tf2/buffer_core.h>
#include <tf2_msgs/TFMessage.h>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/frame_name.h"
#include "ros/conversions.h"
#include "tccm_monitor/pose.h"

namespace tccm {

/// A tf2 buffer that also knows when each transform was measured, so that nothing is interpolated
/// across a gap in which a transform was not heard of: tf2 alone would do that silently.
class TransformHistory {
 public:
  static constexpr std::size_t kNamesMax = 2000;  ///< of frames; tf2 never forgets one

  /// @param gap_max nothing is interpolated across a longer gap.
  /// @param kept transforms that are older than the newest by more are forgotten.
  explicit TransformHistory(Duration gap_max, Duration kept = std::chrono::seconds(10))
      : gap_max_(gap_max), kept_(kept), buffer_(std::make_unique<tf2::BufferCore>(toRos(kept))) {}

  /// Where stamps jump back by more than a second, all but static transforms are forgotten.
  /// Frames may start with a slash. What is no transform (NaN, a quaternion of another length than
  /// 1, no child) is refused and counted; of several of one frame and stamp the first holds, as in
  /// tf2.
  /// A frame that comes on /tf_static and was not static, or the other way about, is so from then
  /// on, and all that moves is forgotten.
  void add(const tf2_msgs::TFMessage& message, bool is_static);
  /// All but static transforms is forgotten.
  void clear();
  /// What time it is by the clock. Where that steps back by more than 0.1 s, all but static
  /// transforms is forgotten: what was said of times to come is not of these.
  void setNow(Time now);
  /// Whether any transform, to it or from it, was heard of.
  [[nodiscard]] bool hasFrame(const std::string& frame) const { return frames_.count(frame) > 0; }
  /// Why transforms were passed over or refused, for people: of frames' names only so many are
  /// known, as tf2 never forgets one. Empty where none was.
  [[nodiscard]] std::string defect() const;

  /// How a lookup ended.
  enum class Status {
    kFound,
    kNotYet,  ///< a transform after the instant is missing: it may still come
    kNever,   ///< the instant lies before what is known, or the frames are not connected
    kGap,     ///< the transforms around the instant are too far apart
  };
  struct Lookup {
    Status status = Status::kNotYet;
    Pose pose = Pose::Identity();  ///< T_target_source; meaningless unless kFound
  };
  [[nodiscard]] Lookup at(const std::string& target, const std::string& source, Time stamp) const {
    return at(target, source, stamp, gap_max_);
  }
  /// @param gap_max in place of the history's own.
  [[nodiscard]] Lookup at(const std::string& target, const std::string& source, Time stamp,
                          Duration gap_max) const;

  /// Writes the poses from first to last, both included, at most `step` apart.
  /// @return kFound, or why path is left empty.
  [[nodiscard]] Status path(const std::string& target, const std::string& source, Time first,
                            Time last, Duration step, PosePath& path) const;

  /// The newest instant at which source is known in target.
  struct Newest {
    Time stamp;
    Pose pose;
    bool is_static;  ///< the same frame, or static transforms alone
  };
  [[nodiscard]] std::optional<Newest> newest(const std::string& target,
                                             const std::string& source) const;

  /// Why a scan is dropped that was not placed, for people and reports.
  [[nodiscard]] static const char* name(Status status) {
    return status == Status::kGap ? "transform_gap" : "no_transform";
  }

 private:
  struct Frame {
    const Frame* parent = nullptr;  ///< none: the last one above
    bool is_static = false;
    std::vector<Time> stamps;                    ///< ascending; none where it is static
    geometry_msgs::TransformStamped fixed = {};  ///< where it is static
  };
  /// @param turned the frame that is static now, or is not any more.
  void makeAnew(const Frame& turned);
  /// @return nothing where no more frames may be known.
  [[nodiscard]] Frame* frameOf(const std::string& name);
  /// How many frames lie above.
  [[nodiscard]] static std::size_t depthOf(const Frame* frame);
  /// Hands the frames that move on the way from target to source to visit(frame), the target's
  /// first, until one says that it has seen enough. @return whether it did.
  template <typename Visit>
  bool visitMoving(const std::string& target, const std::string& source, Visit&& visit) const;
  [[nodiscard]] static Status around(const std::vector<Time>& stamps, Time stamp, Duration gap_max);

  Duration gap_max_, kept_;
  std::unique_ptr<tf2::BufferCore> buffer_;
  Time now_;
  std::map<std::string, Frame> frames_;        ///< never taken out, as in tf2
  geometry_msgs::TransformStamped transform_;  ///< as handed to tf2, reused
  std::size_t passed_over_ = 0;
  std::size_t refused_ = 0;
  const char* why_refused_ = "";  ///< the last one
  std::string refused_frame_;
  std::size_t turned_ = 0;
  std::string turned_frame_;
};

/// Feeds a history from /tf and /tf_static, in the callback queue of the node it is given: no
/// thread of its own, so that what it feeds needs no lock. @param heard called after each message.
[[nodiscard]] std::vector<ros::Subscriber> hearTransforms(
    ros::NodeHandle node, TransformHistory& history,
    const std::function<void(const tf2_msgs::TFMessage& message, bool is_static)>& heard);

}  // namespace tccm
