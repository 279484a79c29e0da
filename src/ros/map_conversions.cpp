// Cuboid maps to messages and back.
#include <sensor_msgs/point_cloud2_iterator.h>
#include <tf2_eigen/tf2_eigen.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ros/conversions.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

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

void toMessage(const LookImage& looks, tccm_monitor::Looks& message) {
  const int columns = looks.grid().columns();
  const int rows = std::max(0, looks.rowEnd() - looks.rowBegin());
  message.resolution = looks.grid().resolution();
  message.viewpoint = tf2::toMsg(looks.viewpoint());
  message.epoch = toRos(looks.epoch());
  message.row_begin = static_cast<std::uint32_t>(rows > 0 ? looks.rowBegin() : 0);
  const std::size_t passes = static_cast<std::size_t>(rows * columns) * LookImage::kPasses;
  message.first_ms.resize(passes);
  message.last_ms.resize(passes);
  message.range_mm.resize(passes);
  message.end.resize(passes);
  message.moved.resize(passes);
  const std::size_t first = rows > 0 ? looks.grid().index(looks.rowBegin(), 0) : 0;
  for (std::size_t i = 0; i < passes; ++i) {
    const LookImage::Pass& pass =
        looks.passes(first + i / LookImage::kPasses)[i % LookImage::kPasses];
    message.first_ms[i] = pass.first;
    message.last_ms[i] = pass.last;
    message.range_mm[i] = pass.range_mm;
    message.end[i] = static_cast<std::uint8_t>(pass.end);
    message.moved[i] = static_cast<std::uint8_t>(pass.moved);
  }
}

/// @throws ConfigError where the resolution is not allowed.
std::string fromMessage(const tccm_monitor::Looks& message, LookImage& looks) {
  if (!(std::abs(message.resolution - looks.grid().resolution()) < 1e-9)) {
    looks = LookImage(message.resolution);
  }
  const Vector3 viewpoint(message.viewpoint.x, message.viewpoint.y, message.viewpoint.z);
  if (!viewpoint.allFinite()) return "the viewpoint of its looks is not finite";
  const auto columns = static_cast<std::size_t>(looks.grid().columns());
  const std::size_t passes = message.end.size(), passes_in_row = columns * LookImage::kPasses;
  if (passes % passes_in_row != 0 ||
      message.row_begin + passes / passes_in_row > static_cast<std::size_t>(looks.grid().rows())) {
    return "its looks fill no whole rows";
  }
  for (const std::size_t size : {message.first_ms.size(), message.last_ms.size(),
                                 message.range_mm.size(), message.moved.size()}) {
    if (size != passes) return "the lists of its looks are not of one length";
  }
  looks.begin(toTime(message.epoch), viewpoint);
  for (std::size_t i = 0; i < passes; ++i) {
    if (message.end[i] > tccm_monitor::Looks::UNCLEAR)
      return "a look ends on nothing that is known";
    const std::size_t pixel = i / LookImage::kPasses;
    const auto row = static_cast<int>(message.row_begin + pixel / columns);
    looks.edit(row, static_cast<int>(pixel % columns))[i % LookImage::kPasses] = {
        message.first_ms[i], message.last_ms[i], message.range_mm[i],
        static_cast<Seen>(message.end[i]), message.moved[i] != 0};
  }
  return {};
}

std::string fromMessages(const std::vector<tccm_monitor::Cuboid>& messages, CuboidMap& map) {
  const double quantum = map.grid.config().height_quantum_m;
  map.cuboids.clear();
  map.appeared = 0;
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
                           message.points, message.age_scans, message.dyn, message.held != 0,
                           message.appeared != 0 && message.held == 0, message.unseen_ms});
    map.appeared += map.cuboids.back().appeared ? 1 : 0;
  }
  return {};
}

}  // namespace

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
  message.tilt_stopped = map.tilt_stopped;
  message.look_period = toRos(map.look_period);
  message.hold = toRos(map.hold);
  message.self_share = static_cast<float>(map.self_share.value_or(NAN));
  message.viewpoint = tf2::toMsg(map.viewpoint);
  toMessage(map.looks, message.looks);
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
    out.held = static_cast<std::uint8_t>(cuboid.held);
    out.unseen_ms = cuboid.unseen_ms;
    out.appeared = static_cast<std::uint8_t>(cuboid.appeared);
  }
}

void toPoints(const CuboidMap& map, const std::string& frame, sensor_msgs::PointCloud2& message) {
  const double cell_size = map.grid.config().cell_size_m;
  const auto stepsOf = [&](const UprightBox& box) {
    return static_cast<std::size_t>(std::ceil(box.sizes().z() / cell_size - 1e-9));
  };
  std::size_t points = 0;
  for (const Cuboid& cuboid : map.cuboids) points += stepsOf(map.box(cuboid)) + 1;
  message.header.frame_id = frame;
  message.header.stamp = toRos(map.stamp);
  sensor_msgs::PointCloud2Modifier layout(message);
  layout.setPointCloud2FieldsByString(1, "xyz");
  layout.resize(points);
  message.is_dense = true;
  sensor_msgs::PointCloud2Iterator<float> x(message, "x"), y(message, "y"), z(message, "z");
  for (const Cuboid& cuboid : map.cuboids) {
    const UprightBox box = map.box(cuboid);
    const std::size_t steps = stepsOf(box);
    for (std::size_t i = 0; i <= steps; ++i, ++x, ++y, ++z) {
      const double share = static_cast<double>(i) / static_cast<double>(steps);
      *x = static_cast<float>(box.center().x());
      *y = static_cast<float>(box.center().y());
      *z = static_cast<float>(box.min().z() + share * box.sizes().z());
    }
  }
}

std::string fromMessage(const tccm_monitor::CuboidMap& message, CuboidMap& map) {
  try {
    const Grid grid(gridOf(message));
    if (!(grid == map.grid)) map.grid = grid;
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
    map.tilt_stopped = message.tilt_stopped;
    map.look_period = Duration(message.look_period.toNSec());
    if (map.look_period < Duration::zero()) return "its look_period is negative";
    map.hold = Duration(message.hold.toNSec());
    if (map.hold < Duration::zero()) return "its hold is negative";
    map.self_share.reset();
    if (!std::isnan(message.self_share)) map.self_share = static_cast<double>(message.self_share);
    if (map.self_share && !(*map.self_share >= 0.0 && *map.self_share <= 1.0)) {
      return "its self_share is not within 0 and 1";
    }
    map.thickness = map.grid.heightOf(message.thickness);
    map.viewpoint = {message.viewpoint.x, message.viewpoint.y, message.viewpoint.z};
    if (!map.viewpoint.allFinite()) return "its viewpoint is not finite";
    std::string defect = fromMessage(message.looks, map.looks);
    if (!defect.empty()) return defect;
    defect = fromMessages(message.cuboids, map);
    if (defect.empty()) indexCells(map);
    return defect;
  } catch (const ConfigError& error) {
    return error.what();
  }
}

}  // namespace tccm
