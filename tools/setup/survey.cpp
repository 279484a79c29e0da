#include "survey.h"

#include <rosbag/view.h>
#include <tf2_eigen/tf2_eigen.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/frame_name.h"
#include "ros/cloud_reader.h"
#include "ros/conversions.h"
#include "tools/bag_stream.h"

namespace tccm {
namespace {

constexpr std::size_t kDepthMax = 1000;  // transforms may go round in a circle

Survey::Sensor& sensorOf(Survey& survey, const std::string& topic, bool is_cloud) {
  for (Survey::Sensor& sensor : survey.sensors) {
    if (sensor.topic == topic) return sensor;
  }
  Survey::Sensor& sensor = survey.sensors.emplace_back();
  sensor.topic = topic;
  sensor.is_cloud = is_cloud;
  return sensor;
}

void noteRange(double range_m, Survey::Sensor& sensor) {
  sensor.nearest_m = std::min(sensor.nearest_m, range_m);
  sensor.furthest_m = std::max(sensor.furthest_m, range_m);
}

void add(const sensor_msgs::LaserScan& scan, const std::string& topic, const std::string& publisher,
         Survey& survey) {
  Survey::Sensor& sensor = sensorOf(survey, topic, false);
  sensor.add(toTime(scan.header.stamp), publisher);
  sensor.frames.insert(withoutSlash(scan.header.frame_id));
  sensor.points_max = std::max(sensor.points_max, scan.ranges.size());
  sensor.range_max_m = std::max(sensor.range_max_m, static_cast<double>(scan.range_max));
  for (const float range : scan.ranges) {
    if (range >= scan.range_min && range < scan.range_max) noteRange(range, sensor);
  }
}

/// Ranges of some pixels of the first clouds, and how they change.
void noteRanges(const sensor_msgs::PointCloud2& message, Survey::Sensor& sensor) {
  constexpr std::size_t kClouds = 60, kPixels = 1000;
  Cloud cloud;
  if (sensor.messages > kClouds || !CloudReader({10000000, 1.0}).read(message, cloud).empty())
    return;
  std::vector<float> ranges;
  for (std::size_t i = 0; i < cloud.points.size(); i += cloud.points.size() / kPixels + 1) {
    const bool is_measured = isMeasured(cloud.points[i]);
    ranges.push_back(is_measured ? cloud.points[i].norm() : NAN);
    if (is_measured) noteRange(ranges.back(), sensor);
  }
  const std::vector<float>& last = sensor.last_ranges_m;
  for (std::size_t i = 0; cloud.organised() && i < std::min(ranges.size(), last.size()); ++i) {
    const float change = ranges[i] - last[i];
    if (std::isfinite(change)) sensor.changes.push_back({ranges[i], std::abs(change)});
  }
  sensor.last_ranges_m = std::move(ranges);
}

void add(const sensor_msgs::PointCloud2& cloud, const std::string& topic,
         const std::string& publisher, Survey& survey) {
  Survey::Sensor& sensor = sensorOf(survey, topic, true);
  sensor.add(toTime(cloud.header.stamp), publisher);
  sensor.frames.insert(withoutSlash(cloud.header.frame_id));
  sensor.rows_max = std::max<std::size_t>(sensor.rows_max, cloud.height);
  const std::size_t points = static_cast<std::size_t>(cloud.width) * cloud.height;
  sensor.points_max = std::max(sensor.points_max, points);
  noteRanges(cloud, sensor);
}

void add(const sensor_msgs::JointState& states, const std::string& topic,
         const std::string& publisher, Survey& survey) {
  for (std::size_t i = 0; i < std::min(states.name.size(), states.position.size()); ++i) {
    Survey::Joint& joint = survey.joints[topic][states.name[i]];
    joint.add(toTime(states.header.stamp), publisher);
    if (!std::isfinite(states.position[i])) continue;
    joint.lowest = std::min(joint.lowest, states.position[i]);
    joint.highest = std::max(joint.highest, states.position[i]);
  }
}

void add(const tf2_msgs::TFMessage& message, bool is_static, const std::string& publisher,
         Survey& survey) {
  for (const auto& transform : message.transforms) {
    const Pose pose(tf2::transformToEigen(transform));
    const std::string name = withoutSlash(transform.child_frame_id);
    if (name.empty() || !isRigid(pose)) continue;
    Survey::Frame& frame = survey.frames[name];
    if (frame.messages == 0) frame.begin = pose;
    frame.parent = withoutSlash(transform.header.frame_id);
    frame.is_static = frame.is_static && is_static;
    frame.add(toTime(transform.header.stamp), publisher);
    const Pose moved = frame.begin.inverse() * pose;
    frame.travel_m = std::max(frame.travel_m, moved.translation().norm());
    frame.turn_rad = std::max(frame.turn_rad, Eigen::AngleAxisd(moved.linear()).angle());
  }
}

}  // namespace

void Survey::Stream::add(Time stamp, const std::string& publisher) {
  if (messages == 0) first = last = stamp;
  if (stamp > last) gaps_s.push_back(toSeconds(stamp - last));
  last = std::max(last, stamp);
  publishers.insert(publisher);
  ++messages;
}

double Survey::Stream::longestGap(double at_most_s) const {
  double longest = 0.0;
  for (const double gap : gaps_s) {
    if (gap <= at_most_s) longest = std::max(longest, gap);
  }
  return longest;
}

double Survey::Stream::rate() const {
  const double seconds = toSeconds(last - first);
  return seconds > 0.0 ? static_cast<double>(messages - 1) / seconds : 0.0;
}

std::optional<Survey::Sensor::Noise> Survey::Sensor::noise() const {
  constexpr std::size_t kChangesMin = 1000;
  constexpr double kMedianToDeviation = 1.4826;  // of a normal distribution
  if (changes.size() < kChangesMin) return std::nullopt;
  const auto medianOf = [this](float Change::*member) {
    std::vector<float> values;
    for (const Change& change : changes) values.push_back(change.*member);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return static_cast<double>(*middle);
  };
  // Of the difference of two ranges.
  const double deviation_m = medianOf(&Change::by_m) * kMedianToDeviation / std::sqrt(2.0);
  return Noise{deviation_m, medianOf(&Change::range_m)};
}

std::vector<std::string> Survey::upFrom(const std::string& frame) const {
  std::vector<std::string> names{frame};
  while (names.size() < kDepthMax) {
    const auto found = frames.find(names.back());
    if (found == frames.end()) break;
    names.push_back(found->second.parent);
  }
  return names;
}

std::vector<std::string> Survey::movingBelow(const std::string& frame,
                                             const std::string& top) const {
  std::vector<std::string> moving;
  for (const std::string& name : upFrom(frame)) {
    if (name == top) break;
    const auto found = frames.find(name);
    if (found != frames.end() && found->second.moves()) moving.push_back(name);
  }
  return moving;
}

std::string Survey::topicOfJoints(const std::set<std::string>& wanted) const {
  std::string best;
  std::size_t most = 0;
  for (const auto& [topic, named] : joints) {
    const auto is_wanted = [&](const auto& entry) { return wanted.count(entry.first) > 0; };
    const auto count =
        static_cast<std::size_t>(std::count_if(named.begin(), named.end(), is_wanted));
    if (count > most) {
      most = count;
      best = topic;
    }
  }
  return best;
}

Survey surveyOf(const std::string& path, const Progress& progress) {
  rosbag::Bag bag;
  openBag(path, bag);
  Survey survey;
  try {
    rosbag::View view(bag);
    const double all = view.size();
    std::size_t done = 0;
    for (const rosbag::MessageInstance& message : view) {
      if (progress) progress(static_cast<double>(done++) / all);
      const std::string& topic = message.getTopic();
      const std::string publisher = message.getCallerId();
      if (const auto scan = message.instantiate<sensor_msgs::LaserScan>()) {
        add(*scan, topic, publisher, survey);
      } else if (const auto cloud = message.instantiate<sensor_msgs::PointCloud2>()) {
        add(*cloud, topic, publisher, survey);
      } else if (const auto joints = message.instantiate<sensor_msgs::JointState>()) {
        add(*joints, topic, publisher, survey);
      } else if (const auto transforms = message.instantiate<tf2_msgs::TFMessage>()) {
        add(*transforms, isStaticTransforms(topic), publisher, survey);
      }
    }
    if (progress) progress(1.0);
  } catch (const ros::Exception& error) {
    throw InputError(path + " is damaged: " + error.what());
  }
  std::sort(survey.sensors.begin(), survey.sensors.end(),
            [](const auto& a, const auto& b) { return a.topic < b.topic; });
  return survey;
}

}  // namespace tccm
