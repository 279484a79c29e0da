#include "ros/stops/stop_replay.h"

#include <ros/serialization.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/String.h>
#include <tccm_monitor/CheckerCall.h>
#include <tccm_monitor/CheckerState.h>
#include <tccm_monitor/CuboidMap.h>
#include <tccm_monitor/CuboidMapChange.h>
#include <tccm_monitor/ScanReport.h>
#include <tf2_msgs/TFMessage.h>
#include <trajectory_msgs/JointTrajectory.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "base/frame_name.h"
#include "check/model_agreement.h"
#include "monitor_config.h"
#include "ros/agreement_transforms.h"
#include "ros/checker_frames.h"
#include "ros/conversions.h"
#include "ros/stops/message_delta.h"
#include "ros/stops/recorded_robot.h"
#include "ros/transform_history.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using Call = tccm_monitor::CheckerCall;

Reason reasonOf(const std::string& text) {
  for (int i = 0; i <= static_cast<int>(Reason::kBadQuestion); ++i) {
    if (name(static_cast<Reason>(i)) == text) return static_cast<Reason>(i);
  }
  throw std::runtime_error("'" + text + "' is no reason that this version knows");
}

/// A message that has to be of a type.
template <typename Message>
boost::shared_ptr<Message> as(const rosbag::MessageInstance& message) {
  auto of_type = message.instantiate<Message>();
  if (of_type) return of_type;
  throw std::runtime_error(message.getTopic() + " has a " + message.getDataType() +
                           " where a call brings another message");
}

class Replay {
 public:
  explicit Replay(const RecordedRobot& robot)
      : config_(robot.checker),
        checker_(robot.model, config_.checker),
        transforms_(fromSeconds(config_.checker.inputs.transform_timeout_s)) {}

  void take(const rosbag::MessageInstance& message) {
    if (!awaits_) {
      call_ = as<Call>(message);
      awaits_ = bringsMessage(call_->call);
      if (!awaits_) play();
      return;
    }
    awaits_ = false;
    play(message);
  }

  [[nodiscard]] StopReplay result() const {
    if (result_.checks == 0) throw std::runtime_error("it has no check");
    if (awaits_ || !result_.recorded.stop) {
      throw std::runtime_error("it does not end with a stop: it may have been cut");
    }
    return result_;
  }

 private:
  [[nodiscard]] static bool bringsMessage(std::uint8_t call) { return call <= Call::TRAJECTORY; }

  void play() {
    const Time now = toTime(call_->now);
    const Cause cause(
        reasonOf(call_->outside_reason.empty() ? name(Reason::kClear) : call_->outside_reason),
        call_->outside_detail);
    switch (call_->call) {
      case Call::COMPARE:
        checker_.agreement().compare(now, transformsOf(transforms_));
        return;
      case Call::RESET:
        static_cast<void>(checker_.reset());
        return;
      case Call::START_ANEW:
        checker_.startAnew();
        return;
      case Call::CHECK:
        placeRootsInFixedFrame(config_.fixed_frame, checker_);
        checker_.inputs().setClockStalls(call_->clock_stalls != 0);
        checker_.setLatency(call_->latency_s);
        checker_.setOutsideCause(cause);
        return compare(checker_.check(now));
      case Call::FAIL:
        return compare(checker_.fail(now, cause));
      default:
        throw std::runtime_error("it has a call that this version does not know");
    }
  }

  void play(const rosbag::MessageInstance& message) {
    const Time now = toTime(call_->now);
    switch (call_->call) {
      case Call::STATE:
        return takeState(*as<tccm_monitor::CheckerState>(message));
      case Call::JOINTS: {
        const auto joints = as<sensor_msgs::JointState>(message);
        checker_.addJoints(now, toTime(joints->header.stamp), joints->name, joints->position,
                           joints->velocity, call_->publisher);
        return;
      }
      case Call::TRANSFORMS:
      case Call::STATIC_TRANSFORMS:
        transforms_.add(*as<tf2_msgs::TFMessage>(message), call_->call == Call::STATIC_TRANSFORMS);
        return placeFrames(transforms_, config_.fixed_frame, checker_);
      case Call::REPORT:
        return takeReport(now, *as<tccm_monitor::ScanReport>(message));
      case Call::MAP:
        return takeMap(now, message);
      case Call::TRAJECTORY:
        static_cast<void>(
            checker_.command(now, fromMessage(*as<trajectory_msgs::JointTrajectory>(message))));
        return;
      default:  // POINTS: for people
        return;
    }
  }

  void takeReport(Time now, const tccm_monitor::ScanReport& message) {
    ScanReport report;
    fromMessage(message, report);
    if (report.outcome == ScanReport::Outcome::kWaiting) {
      checker_.agreement().watchSensor(withoutSlash(message.header.frame_id));
    }
    checker_.addScanReport(now, report, call_->sensor);
  }

  void takeMap(Time now, const rosbag::MessageInstance& message) {
    std::vector<std::uint8_t>& bytes = maps_[call_->sensor];
    if (message.getDataType() == ros::message_traits::DataType<tccm_monitor::CuboidMap>::value()) {
      bytes.resize(message.size());
      ros::serialization::OStream stream(bytes.data(), message.size());
      message.write(stream);
    } else {
      const std::string defect = applyChange(*as<tccm_monitor::CuboidMapChange>(message), bytes);
      if (!defect.empty()) throw std::runtime_error("a map's change is damaged: " + defect);
    }
    tccm_monitor::CuboidMap map_message;
    ros::serialization::IStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
    ros::serialization::deserialize(stream, map_message);
    auto map = std::make_shared<CuboidMap>();
    const std::string defect = fromMessage(map_message, *map);
    if (!defect.empty()) throw std::runtime_error("a map is damaged: " + defect);
    checker_.setMap(now, std::move(map), call_->sensor);
  }

  void takeState(const tccm_monitor::CheckerState& state) {
    if (state_ && *state_ == state) return;  // as it stands at the beginning of each chunk
    const bool is_first = !state_;
    state_ = state;
    static_cast<void>(tableOf(config_).load(YAML::Load(state.parameters), "state"));
    checker_.reconfigure(config_.checker);
    const auto held = checker_.attached();
    for (const AttachedObject& object : held) static_cast<void>(checker_.detach(object.name));
    for (const auto& object : state.attached_objects) checker_.attach(fromMessage(object));
    takeRegions(state);
    if (!is_first) return;  // what follows comes by itself as well
    tf2_msgs::TFMessage transforms;
    transforms.transforms = state.static_transforms;
    transforms_.add(transforms, true);
    placeFrames(transforms_, config_.fixed_frame, checker_);
    for (std::size_t i = 0; i < state.trajectories.size() && i < state.commanded.size(); ++i) {
      static_cast<void>(
          checker_.command(toTime(state.commanded[i]), fromMessage(state.trajectories[i])));
    }
  }

  void takeRegions(const tccm_monitor::CheckerState& state) {
    const Time now = toTime(call_->now);
    const auto exempt = checker_.exemptions();
    for (const Exemption& exemption : exempt) {
      static_cast<void>(checker_.liftExemptions(exemption.owner, exemption.link));
    }
    for (const auto& message : state.exemptions) {
      Exemption exemption{message.owner, message.link, fromMessage(message.region, "region"), {}};
      exemption.frame = message.frame;
      exemption.with_goal = message.with_goal != 0;
      checker_.addExemption(now, exemption, toSeconds(toTime(message.until) - now));
    }
    for (const auto& message : state.keep_out) {
      const Vector3 size(message.size.x, message.size.y, message.size.z);
      setRegion([&] {
        checker_.setKeepOut(
            {message.name, message.frame, Box{0.5 * size}, fromMessage(message.pose, "pose")});
      });
    }
    const auto regions = checker_.keepOut();
    for (const KeepOutRegion& region : regions) {
      const auto stays = [&region](const auto& message) { return message.name == region.name; };
      if (std::any_of(state.keep_out.begin(), state.keep_out.end(), stays)) continue;
      setRegion([&] { checker_.removeKeepOut(region.name); });
    }
  }

  /// Those of the configuration are there, and stay.
  template <typename Set>
  static void setRegion(Set&& set) {
    try {
      set();
    } catch (const ConfigError&) {
    }
  }

  void compare(const Verdict& verdict) {
    result_.recorded = {toTime(call_->now), static_cast<Level>(call_->level),
                        call_->reason,      call_->link,
                        call_->detail,      call_->stop != 0};
    result_.replayed = {toTime(call_->now), verdict.level,  name(verdict.reason),
                        verdict.link,       verdict.detail, verdict.stop};
    ++result_.checks;
    if (result_.recorded == result_.replayed) ++result_.same;
    if (!first_) first_ = toTime(call_->now);
    result_.seconds = toSeconds(toTime(call_->now) - *first_);
  }

  CheckerConfig config_;
  Checker checker_;
  TransformHistory transforms_;
  boost::shared_ptr<Call> call_;                           ///< the last
  bool awaits_ = false;                                    ///< its message
  std::map<std::size_t, std::vector<std::uint8_t>> maps_;  ///< serialized, by sensor: the last
  std::optional<tccm_monitor::CheckerState> state_;
  std::optional<Time> first_;  ///< check
  StopReplay result_;
};

}  // namespace

StopReplay replayStop(const std::string& path) {
  rosbag::Bag bag(path, rosbag::bagmode::Read);
  Replay replay(RecordedRobot::from(bag));
  rosbag::View view(bag);
  for (const rosbag::MessageInstance& message : view) {
    if (!RecordedRobot::isOf(message.getTopic())) replay.take(message);
  }
  return replay.result();
}

}  // namespace tccm
