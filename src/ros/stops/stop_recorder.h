#pragma once

#include <ros/serialization.h>
#include <sensor_msgs/JointState.h>
#include <sensor_msgs/PointCloud2.h>
#include <tccm_monitor/CheckerCall.h>
#include <tccm_monitor/CheckerState.h>
#include <tccm_monitor/CloudScan.h>
#include <tccm_monitor/CuboidMapChange.h>
#include <tccm_monitor/ScanReport.h>
#include <tf2_msgs/TFMessage.h>
#include <trajectory_msgs/JointTrajectory.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "monitor_config.h"
#include "ros/published_map.h"
#include "ros/stops/record_ring.h"
#include "ros/stops/stop_topics.h"
#include "ros/stops/stop_writer.h"
#include "tccm_monitor/checker.h"

namespace tccm {

/// Keeps the last seconds of what a checker was told, in bounded memory, and has them written where
/// it stops a robot that was permitted to move. A checker that is told the same finds the same
/// (StopReplay). Allocates nothing after a while, but where what the checker goes by changes.
///
/// A map takes long to note. It is noted where nobody waits for the permission any more: what
/// comes after mapComes() waits for commit().
class StopRecorder {
 public:
  using Call = tccm_monitor::CheckerCall;

  /// @param sensors names; empty: the only one. @throws ConfigError
  StopRecorder(const StopsConfig& config, StopWriter::Preamble preamble,
               const std::vector<std::string>& sensors);

  void joints(Time now, const sensor_msgs::JointState& message, const std::string& publisher);
  void transforms(Time now, const tf2_msgs::TFMessage& message, bool is_static);
  void report(Time now, const tccm_monitor::ScanReport& message, std::size_t sensor);
  /// Of a laser.
  void points(Time now, const sensor_msgs::PointCloud2& message, std::size_t sensor);
  /// Of a camera or lidar: some of them, as they are large.
  void points(Time now, const tccm_monitor::CloudScan& message, std::size_t sensor);
  void trajectory(Time now, const trajectory_msgs::JointTrajectory& message);
  void compared(Time now) { note(begin(Call::COMPARE, now)); }
  void reset(Time now) { note(begin(Call::RESET, now)); }
  void startAnew(Time now);
  void mapComes(Time now, const PublishedMap::ConstPtr& published, std::size_t sensor);
  void commit();
  /// @param outside what the checker was told of itself. @param config as tuned; not changed.
  void check(Time now, const Cause& outside, const Verdict& verdict, const Checker& checker,
             CheckerConfig& config);
  void fail(Time now, const Cause& cause, const Verdict& verdict);

  /// What has become of the stops, for people.
  struct Report {
    StopWriter::Report writer;
    std::size_t missed = 0;  ///< as another one was being written
    std::size_t lost = 0;    ///< records that were too large
    std::size_t bytes = 0;   ///< kept now
  };
  [[nodiscard]] Report report();

 private:
  static constexpr std::size_t kTrajectories = 8;

  Call& begin(std::uint8_t call, Time now, std::size_t sensor = 0);
  /// At once, or after the map that comes.
  void note(const Call& call);
  void noteVerdict(Call& call, const Verdict& verdict);
  void append(const Call& call);
  /// With the message that belongs to it, in one chunk: both, or neither.
  template <typename Message>
  void append(const Call& call, std::uint8_t topic, const Message& message);
  /// @return whether the call and a message of that size fit into the newest chunk.
  [[nodiscard]] bool makeRoomFor(const Call& call, std::size_t size);
  template <typename Message>
  void place(std::uint8_t topic, const Message& message);
  /// Where a record of so many bytes begins a chunk: what it needs of what came before goes first.
  void startChunkFor(std::size_t size);
  [[nodiscard]] std::uint8_t* placeFor(std::uint8_t topic, std::size_t size);
  void appendState();
  void appendMap();
  /// Whether what the checker goes by has changed, and how.
  void followState(Time now, const Checker& checker, CheckerConfig& config);
  void forgetEnded(Time now);
  void writeStop();

  std::vector<StopTopic> topics_;
  RecordRing ring_;
  StopWriter writer_;
  Time now_;    ///< of the last call
  Time stamp_;  ///< of the last record
  Call call_;   ///< reused
  tccm_monitor::CheckerState state_;
  std::optional<std::size_t> revision_;          ///< of the checker, that the state is of
  bool state_changed_ = false;                   ///< and is not in the ring yet
  std::vector<std::uint8_t> message_;            ///< a map, serialized
  std::vector<std::vector<std::uint8_t>> maps_;  ///< likewise, by sensor: the last in the chunk
  tccm_monitor::CuboidMapChange change_;
  PublishedMap::ConstPtr coming_;  ///< a map that is noted later
  Call coming_call_;
  std::vector<Call> waiting_;  ///< calls that follow it; the memory of others too
  std::size_t waits_ = 0;
  std::vector<std::optional<Time>> clouds_;  ///< by sensor: the last that was kept
  bool misunderstands_ = false;              ///< the checker does, what was commanded
  bool was_permitted_ = false;
  bool stops_ = false;  ///< a stop is to be written
  std::string name_;
  std::vector<RecordRing::Chunk*> chunks_;
  std::size_t missed_ = 0, lost_ = 0;
};

}  // namespace tccm
