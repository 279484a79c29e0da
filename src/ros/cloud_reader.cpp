#include "ros/cloud_reader.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "base/line_of.h"

namespace tccm {
namespace {

using sensor_msgs::PointCloud2;
using sensor_msgs::PointField;

constexpr const char* kUnderstoodTimes =
    "understood are t and offset_time (uint32, ns), time (float32, s) and timestamp (float64, s or "
    "ns)";
/// Channels of one firing come in any order, and drivers round [s].
constexpr float kStepBack = 1e-3F;

const char* nameOfType(std::uint8_t type) {
  switch (type) {
    case PointField::INT8:
      return "int8";
    case PointField::UINT8:
      return "uint8";
    case PointField::INT16:
      return "int16";
    case PointField::UINT16:
      return "uint16";
    case PointField::INT32:
      return "int32";
    case PointField::UINT32:
      return "uint32";
    case PointField::FLOAT32:
      return "float32";
    case PointField::FLOAT64:
      return "float64";
    default:
      return "no type that there is";
  }
}

/// Of those that are read.
std::uint64_t bytesOfType(std::uint8_t type) { return type == PointField::FLOAT64 ? 8 : 4; }

/// For one line of text, whatever the name is made of.
std::string quoted(const PointField& field) {
  std::string name = "'" + field.name.substr(0, 40) + "'";
  for (char& c : name) c = c >= ' ' && c <= '~' ? c : '?';
  return name;
}

std::string described(const PointField& field) {
  return "its field " + quoted(field) + " (" + nameOfType(field.datatype) + ")";
}

bool soundsLikeTime(const std::string& name) {
  return name == "t" || name == "ts" || name == "dt" || name.find("time") != std::string::npos ||
         name.find("stamp") != std::string::npos;
}

/// @return empty, or why the field cannot be read.
std::string defectOf(const PointField& field, const PointCloud2& message) {
  if (field.count > 1) return described(field) + lineOf(" has %u values a point", field.count);
  const std::uint64_t end = field.offset + bytesOfType(field.datatype);
  if (end <= message.point_step) return {};
  return described(field) + lineOf(" ends at byte %llu of a point, point_step is %u",
                                   static_cast<unsigned long long>(end), message.point_step);
}

std::string defectOfOverlap(const PointField& a, const PointField& b) {
  const std::uint64_t a_begin = a.offset, a_end = a_begin + bytesOfType(a.datatype);
  const std::uint64_t b_begin = b.offset, b_end = b_begin + bytesOfType(b.datatype);
  if (a_end <= b_begin || b_end <= a_begin) return {};
  return "its fields " + quoted(a) + " and " + quoted(b) +
         lineOf(" overlap: offsets %u and %u", a.offset, b.offset);
}

template <typename Number>
Number numberAt(const std::uint8_t* bytes) {
  Number number;
  std::memcpy(&number, bytes, sizeof number);
  return number;
}

/// Calls visit(index, bytes) with the first byte of each point.
template <typename Visit>
void visitPoints(const PointCloud2& message, std::size_t row_step, Visit&& visit) {
  std::size_t i = 0;
  for (std::size_t row = 0; row < message.height; ++row) {
    const std::uint8_t* bytes = message.data.data() + row * row_step;
    for (std::size_t column = 0; column < message.width; ++column, bytes += message.point_step) {
      visit(i++, bytes);
    }
  }
}

/// Writes each point's time as it stands there, in seconds: what is not finite stays so.
template <typename Number>
void takeTimes(const PointCloud2& message, std::size_t row_step, std::uint32_t offset, double unit,
               double from, Cloud& cloud) {
  visitPoints(message, row_step, [&](std::size_t i, const std::uint8_t* bytes) {
    const auto value = static_cast<double>(numberAt<Number>(bytes + offset));
    cloud.offsets_s[i] = static_cast<float>(value * unit - from);
  });
}

/// How often times may begin anew in a cloud that is not organised: twice for each of a lidar's
/// channels, unless it has few points for each. What is no time falls at every other point.
int fallsMost(std::size_t points) {
  constexpr std::size_t kChannelsMost = 128, kPointsLeast = 64;
  return static_cast<int>(2 * std::min(kChannelsMost, points / kPointsLeast));
}

struct Extent {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -std::numeric_limits<double>::infinity();
  void add(double value) {
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
};

/// A unit of `timestamp`, and what it counts from.
struct Unit {
  double seconds;
  double from_s;
};

/// Hesai and RoboSense give seconds since the epoch, Livox nanoseconds. @return nothing where no
/// unit brings all values near the stamp.
std::optional<Unit> unitOf(const Extent& values, double stamp_s, double near_s) {
  for (const Unit& unit : {Unit{1.0, stamp_s}, Unit{1e-9, stamp_s}, Unit{1.0, 0.0}}) {
    if (std::abs(values.lowest * unit.seconds - unit.from_s) <= near_s &&
        std::abs(values.highest * unit.seconds - unit.from_s) <= near_s) {
      return unit;
    }
  }
  return std::nullopt;
}

}  // namespace

std::string CloudReader::read(const PointCloud2& message, Cloud& cloud) const {
  if (message.is_bigendian) return "its numbers are big-endian: little-endian ones are understood";
  Layout layout;
  std::string defect = defectOfSizes(message, layout);
  if (defect.empty()) defect = findFields(message, layout);
  if (!defect.empty()) return defect;
  cloud.stamp = Time(Duration(static_cast<Duration::rep>(message.header.stamp.toNSec())));
  cloud.width = message.width;
  cloud.height = message.height;
  cloud.points.resize(cloud.width * cloud.height);
  const auto take = [&](auto number) {
    using Number = decltype(number);
    const std::uint32_t x = layout.xyz[0]->offset, y = layout.xyz[1]->offset,
                        z = layout.xyz[2]->offset;
    visitPoints(message, layout.row_step, [&](std::size_t i, const std::uint8_t* bytes) {
      cloud.points[i] = {static_cast<float>(numberAt<Number>(bytes + x)),
                         static_cast<float>(numberAt<Number>(bytes + y)),
                         static_cast<float>(numberAt<Number>(bytes + z))};
    });
  };
  if (layout.xyz[0]->datatype == PointField::FLOAT64) {
    take(double());
  } else {
    take(float());
  }
  return readTimes(message, layout, cloud);
}

std::string CloudReader::defectOfSizes(const PointCloud2& message, Layout& layout) const {
  const std::uint64_t width = message.width, height = message.height, step = message.point_step;
  if (width == 0 || height == 0) return "it has no points";
  if (width > limits_.points_max || height > limits_.points_max ||
      width * height > limits_.points_max) {
    return lineOf("it has %u x %u points, cloud_points_max is %zu", message.width, message.height,
                  limits_.points_max);
  }
  // A single row's length is often not written: velodyne_pointcloud leaves it 0.
  const bool unsaid = height == 1 && message.row_step == 0;
  const std::uint64_t row_step = unsaid ? width * step : message.row_step;
  if (row_step < width * step) {
    return lineOf("row_step %u is less than %u points of point_step %u bytes", message.row_step,
                  message.width, message.point_step);
  }
  const std::uint64_t least = row_step * (height - 1) + width * step, most = row_step * height;
  if (message.data.size() < least || message.data.size() > most) {
    return lineOf("it has %zu bytes, but %u x %u points of point_step %u in rows of row_step %u",
                  message.data.size(), message.width, message.height, message.point_step,
                  message.row_step);
  }
  layout.row_step = row_step;
  return {};
}

std::optional<CloudReader::Clock> CloudReader::clockOf(const PointField& field) {
  const auto is = [&field](const char* name, std::uint8_t type) {
    return field.name == name && field.datatype == type;
  };
  if (is("t", PointField::UINT32) || is("offset_time", PointField::UINT32)) {
    return Clock::kNanosecondsFromStamp;
  }
  if (is("time", PointField::FLOAT32)) return Clock::kSecondsFromStamp;
  if (is("timestamp", PointField::FLOAT64)) return Clock::kAbsolute;
  return std::nullopt;
}

std::string CloudReader::findFields(const PointCloud2& message, Layout& layout) const {
  constexpr const char* kNames[3] = {"x", "y", "z"};
  for (const PointField& field : message.fields) {
    for (int i = 0; i < 3; ++i) {
      if (field.name != kNames[i]) continue;
      if (layout.xyz[i]) return lineOf("it has two fields '%s'", kNames[i]);
      layout.xyz[i] = &field;
    }
    if (!soundsLikeTime(field.name)) continue;
    if (layout.time) {
      return "it has two fields of time, " + quoted(*layout.time->field) + " and " + quoted(field) +
             ": which one counts is not known";
    }
    const auto clock = clockOf(field);
    if (!clock) return described(field) + " is no time that is understood: " + kUnderstoodTimes;
    layout.time = TimeField{&field, *clock};
  }
  const PointField* needed[4] = {layout.xyz[0], layout.xyz[1], layout.xyz[2],
                                 layout.time ? layout.time->field : nullptr};
  for (int i = 0; i < 4; ++i) {
    if (!needed[i] && i < 3) return lineOf("it has no field '%s'", kNames[i]);
    if (!needed[i]) continue;
    const bool is_float =
        needed[i]->datatype == PointField::FLOAT32 || needed[i]->datatype == PointField::FLOAT64;
    if (i < 3 && (!is_float || needed[i]->datatype != needed[0]->datatype)) {
      return described(*needed[i]) + ": x, y and z have to be float32, or all float64";
    }
    std::string defect = defectOf(*needed[i], message);
    for (int k = 0; k < i && defect.empty(); ++k) defect = defectOfOverlap(*needed[k], *needed[i]);
    if (!defect.empty()) return defect;
  }
  return {};
}

std::string CloudReader::readTimes(const PointCloud2& message, const Layout& layout,
                                   Cloud& cloud) const {
  cloud.first_offset_s = cloud.last_offset_s = 0.0;
  cloud.offsets_s.clear();
  if (!layout.time) return {};
  const PointField& field = *layout.time->field;
  cloud.offsets_s.resize(cloud.points.size());
  switch (layout.time->clock) {
    case Clock::kNanosecondsFromStamp:
      takeTimes<std::uint32_t>(message, layout.row_step, field.offset, 1e-9, 0.0, cloud);
      break;
    case Clock::kSecondsFromStamp:
      takeTimes<float>(message, layout.row_step, field.offset, 1.0, 0.0, cloud);
      break;
    case Clock::kAbsolute: {
      Extent values;
      visitPoints(message, layout.row_step, [&](std::size_t i, const std::uint8_t* bytes) {
        const auto value = numberAt<double>(bytes + field.offset);
        if (isMeasured(cloud.points[i]) && std::isfinite(value)) values.add(value);
      });
      if (values.lowest > values.highest) values.lowest = values.highest = 0.0;
      const double stamp_s = message.header.stamp.toSec();
      const auto unit = unitOf(values, stamp_s, limits_.duration_max_s);
      if (!unit) {
        return described(field) +
               lineOf(
                   " goes from %.17g to %.17g: as seconds or nanoseconds, since the epoch or the "
                   "stamp (%.3f s), that is more than cloud_duration_max_s, %.3g s, from the "
                   "stamp",
                   values.lowest, values.highest, stamp_s, limits_.duration_max_s);
      }
      takeTimes<double>(message, layout.row_step, field.offset, unit->seconds, unit->from_s, cloud);
      break;
    }
  }
  return defectOfTimes(field, cloud);
}

/// Times rise along each row of the memory: a lidar that publishes a row for each channel begins
/// anew with each, one that straightens its rows (Ouster) once more within each. Where it publishes
/// them one after another as one, so many times.
std::string CloudReader::defectOfTimes(const PointField& field, Cloud& cloud) const {
  Extent offsets;
  for (std::size_t row = 0; row < cloud.height; ++row) {
    float highest = -std::numeric_limits<float>::infinity();
    int falls = 0;
    for (std::size_t i = row * cloud.width; i < (row + 1) * cloud.width; ++i) {
      if (!isMeasured(cloud.points[i])) continue;
      const float offset = cloud.offsets_s[i];
      if (!std::isfinite(offset)) return described(field) + " is not finite at a point";
      offsets.add(static_cast<double>(offset));
      if (offset < highest - kStepBack) {
        ++falls;
        highest = offset;
      }
      highest = std::max(highest, offset);
    }
    if (falls > (cloud.organised() ? 1 : fallsMost(cloud.width))) {
      return described(field) +
             lineOf(" falls by more than %.0f ms from point to point: times have to rise",
                    1e3 * static_cast<double>(kStepBack));
    }
  }
  if (offsets.lowest > offsets.highest) return {};
  cloud.first_offset_s = offsets.lowest;
  cloud.last_offset_s = offsets.highest;
  const double most = std::max(
      {offsets.highest - offsets.lowest, std::abs(offsets.lowest), std::abs(offsets.highest)});
  if (most <= limits_.duration_max_s + 1e-6) return {};
  return described(field) +
         lineOf(" goes from %.3f to %.3f s after the stamp, cloud_duration_max_s is %.3g",
                offsets.lowest, offsets.highest, limits_.duration_max_s);
}

}  // namespace tccm
