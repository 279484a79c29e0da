#pragma once

#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "ros/stops/record_ring.h"
#include "ros/stops/stop_topics.h"

namespace tccm {

/// Writes stops as bags, in a thread of its own: at most so many, the oldest is deleted. A bag is
/// made in memory and copied to the disk: rosbag's ends the process, from its destructor, where the
/// disk is full.
class StopWriter {
 public:
  /// What every bag begins with.
  struct Preamble {
    std::string configuration, robot_description, primitives;
  };
  /// What became of it.
  struct Report {
    std::size_t written = 0;
    std::string last;    ///< path; empty before the first
    std::string defect;  ///< why the last could not be written, for people; empty where it was
  };

  /// @param folder made where it is not there. @throws ConfigError where it cannot be.
  StopWriter(std::string folder, std::size_t stops_max, Preamble preamble,
             std::vector<StopTopic> topics);
  StopWriter(const StopWriter&) = delete;
  StopWriter& operator=(const StopWriter&) = delete;
  /// Ends what is being written first.
  ~StopWriter();

  /// Whether a stop can be taken: not while another one is written.
  [[nodiscard]] bool isIdle();
  /// Takes the chunks and leaves others' memory in their place. @param name of the file, without
  /// ending. @pre isIdle()
  void write(std::string& name, std::vector<RecordRing::Chunk*>& chunks);
  [[nodiscard]] Report report();

 private:
  void run();
  /// @param path of a file in memory. @throws std::exception
  void writeBag(const std::string& path, const std::vector<RecordRing::Chunk*>& chunks) const;
  void deleteOldest() const;

  const std::string folder_;
  const std::size_t stops_max_;
  const Preamble preamble_;
  const std::vector<StopTopic> topics_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool ends_ = false;
  bool is_busy_ = false;
  std::string name_;
  std::vector<RecordRing::Chunk*> chunks_;
  Report report_;
  std::thread thread_;
};

}  // namespace tccm
