#include "cloud_folder.h"

#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>
#include <pcl_conversions/pcl_conversions.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "program.h"
#include "ros/conversions.h"

namespace tccm {
namespace {

constexpr const char* kSensorFrame = "cloud";
constexpr const char* kPublisher = "clouds";

/// PCL's reader crashes on lines of the header that it does not know, and on sizes that are none.
/// @throws InputError where the file does not begin as a PCD file does.
void requireHeader(const std::string& path) {
  constexpr std::size_t kPointsMax = 10'000'000;
  std::ifstream file(path);
  std::map<std::string, std::string> entries;
  std::string line;
  while (entries.count("DATA") == 0 && std::getline(file, line)) {
    std::istringstream words(line);
    std::string key;
    words >> key;
    if (key.empty() || key.front() == '#') continue;
    const std::string known = " VERSION FIELDS SIZE TYPE COUNT WIDTH HEIGHT VIEWPOINT POINTS DATA ";
    if (known.find(" " + key + " ") == std::string::npos) {
      throw InputError(path + " is no PCD file: its header has a line that no PCD file has");
    }
    std::getline(words >> std::ws, entries[key]);
  }
  for (const char* key : {"FIELDS", "SIZE", "TYPE", "COUNT", "WIDTH", "HEIGHT", "POINTS", "DATA"}) {
    if (entries[key].empty()) throw InputError(path + " is no PCD file: its header has no " + key);
  }
  const auto number = [&](const char* key) {
    return std::strtoull(entries[key].c_str(), nullptr, 10);
  };
  const std::size_t points = number("POINTS");
  if (points == 0 || points > kPointsMax || number("WIDTH") > kPointsMax ||
      number("HEIGHT") > kPointsMax || number("WIDTH") * number("HEIGHT") != points) {
    throw InputError(path +
                     formatted(": its header has %zu points in %llu x %llu; there have to be "
                               "as many as that makes, 1 to %zu",
                               points, number("WIDTH"), number("HEIGHT"), kPointsMax));
  }
  std::istringstream viewpoint(entries["VIEWPOINT"].empty() ? "0 0 0 1 0 0 0"
                                                            : entries["VIEWPOINT"]);
  for (int i = 0; i < 7; ++i) {
    double number = NAN;
    if (!(viewpoint >> number) || !std::isfinite(number)) {
      throw InputError(path + ": its VIEWPOINT is no seven numbers");
    }
  }
  std::size_t lines = 0;
  while (entries["DATA"] == "ascii" && lines < points && std::getline(file, line)) ++lines;
  if (entries["DATA"] == "ascii" && lines < points) {
    throw InputError(path + formatted(": it ends after %zu of %zu points", lines, points));
  }
}

tf2_msgs::TFMessage transformTo(const std::string& fixed_frame, const Pose& T_fixed_sensor,
                                const ros::Time& stamp) {
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = stamp;
  transform.header.frame_id = fixed_frame;
  transform.child_frame_id = kSensorFrame;
  const Vector3 p = T_fixed_sensor.translation();
  const Eigen::Quaterniond q(T_fixed_sensor.linear());
  transform.transform.translation.x = p.x();
  transform.transform.translation.y = p.y();
  transform.transform.translation.z = p.z();
  transform.transform.rotation.x = q.x();
  transform.transform.rotation.y = q.y();
  transform.transform.rotation.z = q.z();
  transform.transform.rotation.w = q.w();
  tf2_msgs::TFMessage message;
  message.transforms.push_back(transform);
  return message;
}

}  // namespace

PcdCloud readPcd(const std::string& path) {
  requireHeader(path);
  PcdCloud cloud;
  pcl::PCLPointCloud2 points;
  Eigen::Vector4f origin;
  Eigen::Quaternionf orientation;
  int version = 0;
  try {
    if (pcl::PCDReader().read(path, points, origin, orientation, version) < 0) {
      throw InputError(path + " is no readable PCD file");
    }
  } catch (const pcl::PCLException& error) {
    throw InputError(path + " is no readable PCD file: " + error.what());
  }
  pcl_conversions::moveFromPCL(points, cloud.message);
  cloud.T_fixed_sensor.translation() = origin.head<3>().cast<double>();
  cloud.T_fixed_sensor.linear() = orientation.normalized().cast<double>().toRotationMatrix();
  if (!cloud.T_fixed_sensor.matrix().allFinite()) {
    throw InputError(path + ": its VIEWPOINT is no pose");
  }
  return cloud;
}

CloudFolder::CloudFolder(const Config& config) : config_(config) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(config_.folder, ignored)) {
    throw InputError("no such folder: " + config_.folder);
  }
  for (const auto& entry : std::filesystem::directory_iterator(config_.folder)) {
    if (entry.path().extension() == ".pcd") files_.push_back(entry.path().string());
  }
  std::sort(files_.begin(), files_.end());
  if (files_.empty()) throw InputError(config_.folder + " has no PCD file (*.pcd)");
  pcl::console::setVerbosityLevel(
      pcl::console::L_ALWAYS);  // what is wrong is told by what is thrown
}

void CloudFolder::play(const Sink& sink) const {
  for (std::size_t i = 0; i < files_.size(); ++i) {
    const auto done = static_cast<double>(i);
    if (sink.progress) sink.progress(done / static_cast<double>(files_.size()));
    PcdCloud cloud = readPcd(files_[i]);
    cloud.message.header.frame_id = kSensorFrame;
    cloud.message.header.stamp = ros::Time(1.0 + done / config_.rate_hz);
    sink.transforms(
        transformTo(config_.fixed_frame, config_.T_fixed_sensor.value_or(cloud.T_fixed_sensor),
                    cloud.message.header.stamp),
        false);
    sink.cloud(cloud.message, 0, kPublisher);
  }
  if (sink.progress) sink.progress(1.0);
}

}  // namespace tccm
