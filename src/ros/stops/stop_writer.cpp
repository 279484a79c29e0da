#include "ros/stops/stop_writer.h"

#include <fcntl.h>
#include <ros/serialization.h>
#include <rosbag/bag.h>
#include <std_msgs/String.h>
#include <sys/mman.h>
#include <sys/sendfile.h>
#include <sys/stat.h>
#include <topic_tools/shape_shifter.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>

#include "ros/conversions.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBegin = "stop_";

std::system_error lastError() { return {errno, std::generic_category()}; }

/// An open file, closed at its end.
class OpenFile {
 public:
  /// @throws std::system_error where it could not be opened
  explicit OpenFile(int descriptor) : descriptor_(descriptor) {
    if (descriptor < 0) throw lastError();
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }

  [[nodiscard]] int descriptor() const { return descriptor_; }
  /// @throws std::system_error where what was written is not there
  void close() {
    if (::close(std::exchange(descriptor_, -1)) != 0) throw lastError();
  }

 private:
  int descriptor_;
};

/// @throws std::system_error
void copy(const OpenFile& from, const std::string& path) {
  struct stat status = {};
  if (::fstat(from.descriptor(), &status) != 0) throw lastError();
  OpenFile to(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  for (off_t at = 0; at < status.st_size;) {
    const auto left = static_cast<std::size_t>(status.st_size - at);
    if (::sendfile(to.descriptor(), from.descriptor(), &at, left) <= 0) throw lastError();
  }
  to.close();
}

void writeText(rosbag::Bag& bag, const StopTopic& topic, const ros::Time& stamp,
               const std::string& text) {
  std_msgs::String message;
  message.data = text;
  bag.write(topic.name, stamp, message);
}

/// What a folder has of an ending: of stops, the oldest first.
std::vector<fs::path> stopsIn(const std::string& folder, const std::string& ending) {
  std::vector<fs::path> stops;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind(kBegin, 0) == 0 && entry.path().extension() == ending) {
      stops.push_back(entry.path());
    }
  }
  std::sort(stops.begin(), stops.end(), [](const fs::path& a, const fs::path& b) {
    const auto written_a = fs::last_write_time(a), written_b = fs::last_write_time(b);
    return written_a != written_b ? written_a < written_b : a < b;
  });
  return stops;
}

}  // namespace

StopWriter::StopWriter(std::string folder, std::size_t stops_max, Preamble preamble,
                       std::vector<StopTopic> topics)
    : folder_(std::move(folder)),
      stops_max_(stops_max),
      preamble_(std::move(preamble)),
      topics_(std::move(topics)) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) throw ConfigError("stops_folder: " + folder_ + ": " + error.message());
  chunks_.reserve(RecordRing::kHistory);
  thread_ = std::thread([this] { run(); });
}

StopWriter::~StopWriter() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ends_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

bool StopWriter::isIdle() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return !is_busy_;
}

void StopWriter::write(std::string& name, std::vector<RecordRing::Chunk*>& chunks) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::swap(name_, name);
    std::swap(chunks_, chunks);
    is_busy_ = true;
  }
  changed_.notify_one();
}

StopWriter::Report StopWriter::report() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return report_;
}

void StopWriter::run() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ends_ || is_busy_; });
    if (!is_busy_) return;
    lock.unlock();
    const std::string path = (fs::path(folder_) / (kBegin + name_ + ".bag")).string();
    const std::string active = path + ".active";
    std::string defect;
    std::error_code ignored;
    try {
      deleteOldest();
      const OpenFile memory(::memfd_create("stop", MFD_CLOEXEC));
      writeBag("/proc/self/fd/" + std::to_string(memory.descriptor()), chunks_);
      copy(memory, active);
      fs::rename(active, path);
    } catch (const std::exception& error) {  // a full disk, as a rule
      defect = path + ": " + error.what();
      fs::remove(active, ignored);
    }
    for (RecordRing::Chunk* chunk : chunks_) chunk->unpin();
    lock.lock();
    report_.defect = defect;
    if (defect.empty()) {
      ++report_.written;
      report_.last = path;
    }
    is_busy_ = false;
  }
}

void StopWriter::writeBag(const std::string& path,
                          const std::vector<RecordRing::Chunk*>& chunks) const {
  // One that cannot be closed, for want of memory, throws from its destructor and ends the process:
  // such a one is left where it is.
  auto owned = std::make_unique<rosbag::Bag>(path, rosbag::bagmode::Write);
  rosbag::Bag& bag = *owned.release();
  bag.setCompression(rosbag::compression::LZ4);
  bool is_first = true;
  topic_tools::ShapeShifter shape;
  for (const RecordRing::Chunk* chunk : chunks) {
    chunk->visit([&](const RecordRing::Chunk::Record& record) {
      const ros::Time stamp = toRos(record.stamp);
      if (std::exchange(is_first, false)) {
        const auto at = [this](StopTopicId id) { return topics_[topicIndex(id)]; };
        writeText(bag, at(StopTopicId::kConfiguration), stamp, preamble_.configuration);
        writeText(bag, at(StopTopicId::kRobotDescription), stamp, preamble_.robot_description);
        writeText(bag, at(StopTopicId::kPrimitives), stamp, preamble_.primitives);
      }
      const StopTopic& topic = topics_[record.topic];
      shape.morph(topic.md5, topic.type, topic.definition, "0");
      // ShapeShifter reads from memory that it does not change.
      ros::serialization::IStream stream(const_cast<std::uint8_t*>(record.bytes), record.size);
      shape.read(stream);
      bag.write(topic.name, stamp, shape);
    });
  }
  bag.close();
  owned.reset(&bag);
}

void StopWriter::deleteOldest() const {
  std::vector<fs::path> stops = stopsIn(folder_, ".bag");
  for (const fs::path& left : stopsIn(folder_, ".active")) fs::remove(left);  // of a run that ended
  if (stops.size() < stops_max_) return;
  stops.resize(stops.size() - stops_max_ + 1);
  for (const fs::path& stop : stops) fs::remove(stop);
}

}  // namespace tccm
