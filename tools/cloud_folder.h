#pragma once

#include <optional>
#include <string>
#include <vector>

#include "recording.h"
#include "tccm_monitor/pose.h"

namespace tccm {

struct PcdCloud {
  sensor_msgs::PointCloud2 message;
  Pose T_fixed_sensor = Pose::Identity();  ///< its VIEWPOINT
};

/// @throws InputError where there is no such file, or it is no whole PCD file.
[[nodiscard]] PcdCloud readPcd(const std::string& path);

/// The clouds of one sensor that stood still, a PCD file each, in the order of their names. They
/// are stamped at equal steps, from 1 s on.
class CloudFolder : public Recording {
 public:
  struct Config {
    std::string folder;
    double rate_hz = 30.0;
    std::string fixed_frame;
    std::optional<Pose> T_fixed_sensor;  ///< nothing: what each file's VIEWPOINT says
  };

  /// @throws InputError where there is no such folder, or no PCD file in it.
  explicit CloudFolder(const Config& config);

  void play(const Sink& sink) const override;

 private:
  Config config_;
  std::vector<std::string> files_;  ///< by name
};

}  // namespace tccm
