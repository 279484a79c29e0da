#pragma once

#include "fuzz/byte_reader.h"
#include "map/mapper.h"
#include "support/small_map.h"

namespace tccm::test {

/// A map of 6 x 5 cells of 50 mm about the origin, 0.6 m high, with some window and some bounds.
inline Mapper::Config fuzzedMapper(ByteReader& bytes) {
  Mapper::Config config;
  config.map.grid = smallGrid(0.3, 0.25, 0.6, -0.1);
  config.map.grid.cell_size_m = 0.05;
  config.map.grid.height_min_m = bytes.oneOf({0.0, 0.0105, -0.05});
  config.map.thickness_m = bytes.oneOf({0.02, 0.001, 0.05});
  config.map.returns_max = bytes.oneOf<std::size_t>({2000, 40});
  config.map.intervals_max = bytes.oneOf<std::size_t>({500, 12, 2});
  config.map.scans_max = bytes.oneOf<std::size_t>({16, 3});
  config.looks.resolution_rad = 0.15;
  config.window_scans = bytes.oneOf({3, 1, 0});
  if (config.window_scans == 0) config.window_s = bytes.oneOf({0.1, 0.03, 0.0});
  config.hold.longest_s = bytes.oneOf({0.0, 1.0, 0.1});
  config.hold.intervals_max = bytes.oneOf<std::size_t>({200, 1});
  return config;
}

/// Two poses around a time, or not around it.
inline PosePath fuzzedPath(ByteReader& bytes, Time first, Time last, const Pose& about,
                           double reach) {
  const bool is_late = bytes.seldom(), is_short = bytes.seldom();
  const Pose from = about * bytes.pose(reach);
  const Pose to = bytes.flag() ? about * bytes.pose(reach) : from;
  PosePath path;
  path.add(first + std::chrono::milliseconds(is_late ? 1 : -2), from);
  path.add(last + std::chrono::milliseconds(is_short ? -1 : 2), to);
  return path;
}

}  // namespace tccm::test
