// What a configuration says of the sensors.
#include <algorithm>
#include <cmath>
#include <set>

#include "draft.h"

namespace tccm {
namespace {

constexpr double kTiltMin = 0.1;  // [rad] from which on a laser tilts
constexpr std::size_t kSensorsMax = 4;
constexpr std::size_t kCameraRows = 200;
constexpr double kLidarNoise = 0.03;  // [m]

}  // namespace

bool SetupDraft::tilts(const Survey::Sensor& sensor) const {
  const std::vector<std::string> of_base = survey_.upFrom(base_frame_);
  const std::vector<std::string> moving = survey_.movingBelow(*sensor.frames.begin(), "");
  return std::any_of(moving.begin(), moving.end(), [&](const std::string& name) {
    const bool is_of_base = std::find(of_base.begin(), of_base.end(), name) != of_base.end();
    return !is_of_base && survey_.frames.at(name).turn_rad > kTiltMin;
  });
}

void SetupDraft::chooseSensors() {
  std::set<std::string> cloud_frames;
  for (const Survey::Sensor& sensor : survey_.sensors) {
    const bool is_new = !sensor.is_cloud || cloud_frames.insert(*sensor.frames.begin()).second;
    if (!is_new || sensors_.size() == kSensorsMax) {
      text_.remark("Left out: " + sensor.topic +
                   (is_new ? ": there are others enough" : ": another topic has the same frame"));
    } else if (sensor.is_cloud || tilts(sensor)) {
      sensors_.push_back({"", &sensor});
    } else {
      text_.remark("Left out: " + sensor.topic + ": this laser does not tilt, and sees one plane");
    }
  }
  const bool is_alone = sensors_.size() == 1 && !sensors_.front().heard->is_cloud;
  std::set<std::string> names;
  std::string list;
  for (Sensor& sensor : sensors_) {
    if (!is_alone) {
      const std::vector<std::string> parts = partsOf(sensor.heard->topic);
      std::string name = sensor.heard->is_cloud ? parts.front() : parts.back();
      while (!names.insert(name).second) name += "_2";
      sensor.name = name;
      list += (list.empty() ? "{name: " : ", {name: ") + name + "}";
    }
    configure(sensor);
  }
  if (!list.empty()) {
    text_.set("collision_checker", "sensors", "[" + list + "]", "each has its part of this file");
  }
}

std::string SetupDraft::sectionOf(const Sensor& sensor, const std::string& stage) const {
  return sensor.name.empty() ? stage : sensor.name + "/" + stage;
}

std::string SetupDraft::whatOf(const Survey::Sensor& heard) {
  std::string what = formatted("%zu messages, %.3g a second, in '%s'", heard.messages, heard.rate(),
                               heard.frames.begin()->c_str());
  if (heard.furthest_m > 0.0) {
    what += formatted("; %.2f to %.1f m", heard.nearest_m, heard.furthest_m);
  }
  if (const auto noise = heard.noise()) {
    what += formatted("; noise %.1f mm at %.1f m", 1e3 * noise->deviation_m, noise->range_m);
  }
  return what;
}

void SetupDraft::setTopic(const Sensor& sensor, const std::string& why) {
  if (sensor.name.empty()) {
    text_.set("topics", "scan", sensor.heard->topic, why);
  } else {
    text_.set(sensor.name, "topic", sensor.heard->topic, why);
  }
}

void SetupDraft::configure(const Sensor& sensor) {
  const Survey::Sensor& heard = *sensor.heard;
  const std::string stage =
      heard.is_cloud ? SensorConfig::kCloudAssembler : SensorConfig::kScanAssembler;
  const std::string assembler = sectionOf(sensor, stage);
  const std::string mapper = sectionOf(sensor, SensorConfig::kMapper);
  setTopic(sensor, whatOf(heard));
  text_.set(assembler, "fixed_frame", fixed_frame_, "as in collision_checker");
  if (!model_) text_.set(assembler, "self_filter", "false", "no robot is known");
  if (heard.is_cloud) configureCloud(sensor);
  if (!heard.is_cloud && heard.points_max > 4096) {
    text_.set(assembler, "scan_beams_max", static_cast<double>(heard.points_max),
              "the largest scan");
  }
  double gap_s = 0.0;
  for (const std::string& name : survey_.movingBelow(*heard.frames.begin(), fixed_frame_)) {
    gap_s = std::max(gap_s, survey_.frames.at(name).longestGap(kGapMax));
  }
  if (kHeadroom * gap_s > 0.1) {
    text_.set(assembler, "transform_gap_max_s", roundedTo(kHeadroom * gap_s, 0.01),
              formatted("transforms were silent for up to %.0f ms", 1e3 * gap_s));
  }
  const double longest_s = heard.longestGap(kPeriodsMax / std::max(1.0, heard.rate()));
  const double scan_gap_s = kHeadroom * longest_s;
  const std::string gap_why = formatted("scans were silent for up to %.0f ms", 1e3 * longest_s);
  if (scan_gap_s > 0.25) text_.set(mapper, "scan_gap_max_s", roundedTo(scan_gap_s, 0.01), gap_why);
}

void SetupDraft::configureCloud(const Sensor& sensor) {
  const Survey::Sensor& heard = *sensor.heard;
  const std::string assembler = sectionOf(sensor, SensorConfig::kCloudAssembler);
  const std::string mapper = sectionOf(sensor, SensorConfig::kMapper);
  if (heard.points_max > 400000) {
    text_.set(assembler, "cloud_points_max", static_cast<double>(heard.points_max),
              "the largest cloud");
  }
  if (heard.rows_max >= kCameraRows) {
    text_.set(mapper, "hold_support_points", "4", "a camera's flying pixels must not gather");
  } else {
    text_.set(assembler, "range_max_m", "10.0", "taken for a lidar, as it has few rows");
    text_.set(assembler, "range_noise_m", kLidarNoise, "as lidars have it");
    text_.set(assembler, "range_noise_per_m2", "0.0", "as lidars have it: the same at all ranges");
    text_.set(assembler, "look_block_rad", "0.035", "as far apart as a lidar's rows are");
  }
  setNoise(sensor);
  const double rate = std::max(1.0, heard.rate());
  text_.set(mapper, "window_s", std::max(0.3, std::ceil(50.0 / rate) / 10.0),
            "five clouds or more");
}

void SetupDraft::setNoise(const Sensor& sensor) {
  const auto noise = sensor.heard->noise();
  if (!noise) return;
  const bool is_camera = sensor.heard->rows_max >= kCameraRows;
  const double per_m2 = is_camera ? RangeNoise().per_m2 : 0.0;
  const double expected_m =
      is_camera ? RangeNoise().at(static_cast<float>(noise->range_m)) : kLidarNoise;
  if (noise->deviation_m <= 1.5 * expected_m) return;
  text_.set(sectionOf(sensor, SensorConfig::kCloudAssembler), "range_noise_m",
            roundedTo(noise->deviation_m - per_m2 * noise->range_m * noise->range_m, 0.001),
            formatted("measured: %.1f mm at %.1f m", 1e3 * noise->deviation_m, noise->range_m));
}

}  // namespace tccm
