#include "tccm_monitor/ros/conversions.h"

#include <sensor_msgs/point_cloud2_iterator.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using sensor_msgs::PointField;

/// One point of scan_cloud, as its fields are laid out.
struct CloudPoint {
  float x, y, z;
  float vp_x, vp_y, vp_z;
  float tilt;
  std::uint8_t kind;
  std::uint8_t padding[3];
};
static_assert(sizeof(CloudPoint) == 32, "the fields below name these offsets");

PointField field(const char* name, std::uint32_t offset, std::uint8_t type) {
  PointField f;
  f.name = name;
  f.offset = offset;
  f.datatype = type;
  f.count = 1;
  return f;
}

void layOut(sensor_msgs::PointCloud2& message) {
  if (message.fields.size() == 8 && message.point_step == sizeof(CloudPoint)) return;
  message.fields = {field("x", 0, PointField::FLOAT32),     field("y", 4, PointField::FLOAT32),
                    field("z", 8, PointField::FLOAT32),     field("vp_x", 12, PointField::FLOAT32),
                    field("vp_y", 16, PointField::FLOAT32), field("vp_z", 20, PointField::FLOAT32),
                    field("tilt", 24, PointField::FLOAT32), field("kind", 28, PointField::UINT8)};
  message.point_step = sizeof(CloudPoint);
  message.height = 1;
  message.is_bigendian = false;
  message.is_dense = false;
}

std::string missingField(const sensor_msgs::PointCloud2& message) {
  for (const char* name : {"x", "y", "z", "vp_x", "vp_y", "vp_z", "tilt"}) {
    const auto found = std::find_if(message.fields.begin(), message.fields.end(),
                                    [name](const PointField& f) { return f.name == name; });
    if (found == message.fields.end() || found->datatype != PointField::FLOAT32) {
      return std::string("it has no float field '") + name + "'";
    }
    if (std::uint64_t{found->offset} + sizeof(float) > message.point_step) {
      return std::string("its field '") + name + "' reaches beyond a point";
    }
  }
  return {};
}

geometry_msgs::Point toPoint(const Vector3& p) {
  geometry_msgs::Point point;
  point.x = p.x();
  point.y = p.y();
  point.z = p.z();
  return point;
}

Grid::Config gridOf(const tccm_monitor::CuboidMap& message) {
  Grid::Config grid;
  grid.origin_x_m = message.origin_x;
  grid.origin_y_m = message.origin_y;
  grid.cell_size_m = message.cell_size;
  grid.size_x_m = message.cells_x * message.cell_size;
  grid.size_y_m = message.cells_y * message.cell_size;
  grid.height_min_m = message.height_min;
  grid.height_max_m = message.height_max;
  grid.height_quantum_m = message.height_quantum;
  return grid;
}

std::string fromMessages(const std::vector<tccm_monitor::Cuboid>& messages, CuboidMap& map) {
  const double quantum = map.grid.config().height_quantum_m;
  map.cuboids.clear();
  for (const tccm_monitor::Cuboid& message : messages) {
    const double top = std::nearbyint(message.top / quantum);
    const double bottom = std::nearbyint((message.top - message.depth) / quantum);
    constexpr double kHighest = std::numeric_limits<Height>::max();
    if (message.cell >= map.grid.cells() || !(std::abs(top) <= kHighest) ||
        !(std::abs(bottom) <= kHighest) || !(bottom < top)) {
      return "a cuboid lies outside the grid, or is empty";
    }
    if (!map.cuboids.empty() &&
        (message.cell < map.cuboids.back().cell ||
         (message.cell == map.cuboids.back().cell && bottom < map.cuboids.back().top))) {
      return "its cuboids are not ordered by cell and height, or overlap";
    }
    map.cuboids.push_back({message.cell, static_cast<Height>(bottom), static_cast<Height>(top),
                           message.points, message.age_scans, message.dyn});
  }
  return {};
}

}  // namespace

ros::Time toRos(Time time) {
  constexpr Duration kLast = std::chrono::seconds(std::numeric_limits<std::uint32_t>::max());
  ros::Time result;
  result.fromNSec(static_cast<std::uint64_t>(
      std::clamp(time.time_since_epoch(), Duration::zero(), kLast).count()));
  return result;
}

ros::Duration toRos(Duration duration) {
  constexpr Duration kLongest = std::chrono::seconds(std::numeric_limits<std::int32_t>::max());
  ros::Duration result;
  result.fromNSec(std::clamp(duration, -kLongest, kLongest).count());
  return result;
}

LaserScan fromMessage(const sensor_msgs::LaserScan& message) {
  LaserScan scan;
  scan.stamp = toTime(message.header.stamp);
  scan.angle_min = message.angle_min;
  scan.angle_increment = message.angle_increment;
  // Not finite or absurd: negative, which defectOf() refuses.
  scan.time_increment =
      std::abs(message.time_increment) <= 1.0F ? fromSeconds(message.time_increment) : Duration(-1);
  scan.range_min = message.range_min;
  scan.range_max = message.range_max;
  scan.ranges = message.ranges;
  return scan;
}

JointTrajectory fromMessage(const trajectory_msgs::JointTrajectory& message) {
  JointTrajectory trajectory{message.joint_names, {}};
  for (const auto& point : message.points) {
    trajectory.points.push_back(
        {point.time_from_start.toSec(), point.positions, point.velocities, point.accelerations});
  }
  return trajectory;
}

void toMessage(const AssembledScan& scan, const std::string& frame,
               sensor_msgs::PointCloud2& message) {
  layOut(message);
  message.header.frame_id = frame;
  message.header.stamp = toRos(scan.stamp);
  message.width = static_cast<std::uint32_t>(scan.beams.size());
  message.row_step = message.width * message.point_step;
  message.data.resize(message.row_step);
  auto* point = reinterpret_cast<CloudPoint*>(message.data.data());
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  for (const Beam& beam : scan.beams) {
    const Eigen::Vector3f p = beam.p_fixed.cast<float>();
    const Eigen::Vector3f viewpoint = beam.viewpoint.cast<float>();
    const bool kept = beam.kind == BeamKind::kReturn;
    *point++ = {kept ? p.x() : kNaN,
                kept ? p.y() : kNaN,
                kept ? p.z() : kNaN,
                viewpoint.x(),
                viewpoint.y(),
                viewpoint.z(),
                static_cast<float>(beam.tilt),
                static_cast<std::uint8_t>(beam.kind),
                {0, 0, 0}};
  }
}

std::string fromMessage(const sensor_msgs::PointCloud2& message, ScanReturns& returns) {
  std::string missing = missingField(message);
  if (!missing.empty()) return missing;
  const std::size_t count = static_cast<std::size_t>(message.width) * message.height;
  if (count == 0 || message.point_step == 0 || count > message.data.size() / message.point_step ||
      message.is_bigendian) {
    return "it has no points, fewer bytes than it says, or big-endian numbers";
  }
  returns.stamp = toTime(message.header.stamp);
  returns.points.clear();
  sensor_msgs::PointCloud2ConstIterator<float> x(message, "x"), y(message, "y"), z(message, "z");
  sensor_msgs::PointCloud2ConstIterator<float> viewpoint(message, "vp_x"), vp_y(message, "vp_y"),
      vp_z(message, "vp_z"), tilt(message, "tilt");
  returns.tilt = *tilt;
  for (std::size_t i = 0; i < count; ++i, ++x, ++y, ++z) {
    if (std::isfinite(*x) && std::isfinite(*y) && std::isfinite(*z)) {
      returns.points.emplace_back(*x, *y, *z);
    }
  }
  const int last = static_cast<int>(count - 1);
  returns.viewpoint = Vector3(*(viewpoint + last), *(vp_y + last), *(vp_z + last));
  return {};
}

void toMessage(const CuboidMap& map, const std::string& frame, tccm_monitor::CuboidMap& message) {
  const Grid::Config& grid = map.grid.config();
  message.header.frame_id = frame;
  message.header.stamp = toRos(map.stamp);
  message.serial = map.serial;
  message.origin_x = grid.origin_x_m;
  message.origin_y = grid.origin_y_m;
  message.cell_size = grid.cell_size_m;
  message.cells_x = map.grid.cellsX();
  message.cells_y = map.grid.cellsY();
  message.height_min = grid.height_min_m;
  message.height_max = grid.height_max_m;
  message.height_quantum = grid.height_quantum_m;
  message.thickness = map.grid.metres(map.thickness);
  message.window_scans = map.window_scans;
  message.window = toRos(map.window);
  message.complete = map.complete;
  message.overflowed = map.overflowed;
  message.viewpoint = toPoint(map.viewpoint);
  message.cuboids.resize(map.cuboids.size());
  for (std::size_t i = 0; i < map.cuboids.size(); ++i) {
    const Cuboid& cuboid = map.cuboids[i];
    tccm_monitor::Cuboid& out = message.cuboids[i];
    out.cell = cuboid.cell;
    out.top = static_cast<float>(map.grid.metres(cuboid.top));
    out.depth = static_cast<float>(map.grid.metres(cuboid.top - cuboid.bottom));
    out.points = cuboid.points;
    out.age_scans = cuboid.age_scans;
    out.dyn = cuboid.dyn;
    out.col = tccm_monitor::Cuboid::CLEAR;
  }
}

std::string fromMessage(const tccm_monitor::CuboidMap& message, CuboidMap& map) {
  try {
    const Grid grid(gridOf(message));
    if (!(grid == map.grid)) map.grid = grid;
  } catch (const ConfigError& error) {
    return error.what();
  }
  if (map.grid.cellsX() != message.cells_x || map.grid.cellsY() != message.cells_y) {
    return "its cells do not fit its area";
  }
  if (!(message.thickness > 0.0) ||
      !(message.thickness / message.height_quantum <= std::numeric_limits<Height>::max())) {
    return "its thickness is none";
  }
  map.stamp = toTime(message.header.stamp);
  map.serial = message.serial;
  map.window_scans = message.window_scans;
  map.window = Duration(message.window.toNSec());
  map.complete = message.complete;
  map.overflowed = message.overflowed;
  map.thickness = map.grid.heightOf(message.thickness);
  map.viewpoint = {message.viewpoint.x, message.viewpoint.y, message.viewpoint.z};
  if (!map.viewpoint.allFinite()) return "its viewpoint is not finite";
  std::string defect = fromMessages(message.cuboids, map);
  if (defect.empty()) indexCells(map);
  return defect;
}

}  // namespace tccm
