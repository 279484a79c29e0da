#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <cstddef>
#include <optional>
#include <string>

#include "scan/cloud.h"

namespace tccm {

/// Reads any layout of a PointCloud2 that has x, y and z, as float32 or float64. Of each point's
/// time those fields are understood that drivers use, docs/sensors.md has the list; without one all
/// points are at the stamp. Whatever contradicts itself is refused, nothing is guessed.
class CloudReader {
 public:
  explicit CloudReader(const CloudLimits& limits) : limits_(limits) {}

  /// Allocates nothing where a cloud is no larger than one before.
  /// @param cloud reused; not to be used where the message is refused.
  /// @return empty, or why the message is refused: one line for people.
  [[nodiscard]] std::string read(const sensor_msgs::PointCloud2& message, Cloud& cloud) const;

 private:
  /// How the time of a point is written.
  enum class Clock {
    kNanosecondsFromStamp,  ///< `t`, `offset_time`: uint32
    kSecondsFromStamp,      ///< `time`: float32
    kAbsolute,              ///< `timestamp`: float64, its unit is told from the stamp
  };
  struct TimeField {
    const sensor_msgs::PointField* field;
    Clock clock;
  };
  /// Where a message has what is needed of it.
  struct Layout {
    const sensor_msgs::PointField* xyz[3] = {};
    std::optional<TimeField> time;
    std::size_t row_step = 0;
  };
  /// @return nothing where no such time is understood.
  [[nodiscard]] static std::optional<Clock> clockOf(const sensor_msgs::PointField& field);
  [[nodiscard]] std::string findFields(const sensor_msgs::PointCloud2& message,
                                       Layout& layout) const;
  [[nodiscard]] std::string defectOfSizes(const sensor_msgs::PointCloud2& message,
                                          Layout& layout) const;
  [[nodiscard]] std::string readTimes(const sensor_msgs::PointCloud2& message, const Layout& layout,
                                      Cloud& cloud) const;
  [[nodiscard]] std::string defectOfTimes(const sensor_msgs::PointField& field, Cloud& cloud) const;

  CloudLimits limits_;
};

}  // namespace tccm
