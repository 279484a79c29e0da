#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace tccm::test {

/// The rows of a CSV file below its header, cell by cell.
inline std::vector<std::vector<std::string>> readRows(const std::string& path) {
  std::ifstream file(path);
  std::string line, cell;
  if (!std::getline(file, line)) throw std::runtime_error("cannot read " + path);
  std::vector<std::vector<std::string>> rows;
  while (std::getline(file, line)) {
    std::stringstream cells(line + ',');  // else an empty last cell would be lost
    rows.emplace_back();
    while (std::getline(cells, cell, ',')) rows.back().push_back(cell);
  }
  return rows;
}

/// The map as anyone can recompute it from the points that reached it: a point at height z covers z
/// - thickness to z of its cell above the least height of the area, and the map is the union over
/// the scans of a window.
class DumpedMap {
 public:
  /// @param points rows of scan, x, y, z. @param map the summary's words on the map.
  DumpedMap(const std::vector<std::vector<std::string>>& points, const nlohmann::json& map)
      : origin_x_(map.at("origin_m")[0]),
        origin_y_(map.at("origin_m")[1]),
        cell_size_(map.at("cell_size_m")),
        quantum_(map.at("height_quantum_m")),
        thickness_(static_cast<int>(std::lround(map.at("thickness_m").get<double>() / quantum_))),
        lowest_(static_cast<int>(
            std::ceil(map.at("height_limits_m")[0].get<double>() / quantum_ - 1e-6))),
        cells_x_(map.at("cells")[0]),
        cells_y_(map.at("cells")[1]),
        columns_(static_cast<std::size_t>(cells_x_ * cells_y_)) {
    for (const auto& row : points) {
      const std::size_t scan = std::stoul(row[0]);
      if (scan >= scans_.size()) scans_.resize(scan + 1);
      const int x = cell(std::stod(row[1]) - origin_x_), y = cell(std::stod(row[2]) - origin_y_);
      const int height = static_cast<int>(std::nearbyint(std::stod(row[3]) / quantum_));
      scans_[scan].push_back({static_cast<std::size_t>(y * cells_x_ + x), height});
    }
  }

  /// Moves the window on to the scans from `oldest` to `newest`, by their serials.
  void moveTo(std::size_t oldest, std::size_t newest) {
    for (; end_ <= newest; ++end_) change(end_, 1);
    for (; begin_ < oldest; ++begin_) change(begin_, -1);
  }

  /// The cuboids in the cells that a box touches, each a run of touching heights. Stops where
  /// `found` returns true. @return whether it did.
  template <typename Found>
  bool anyNear(const Eigen::AlignedBox3d& around, Found&& found) const {
    const int x_end = std::min(cell(around.max().x() + kMargin - origin_x_) + 1, cells_x_);
    const int y_end = std::min(cell(around.max().y() + kMargin - origin_y_) + 1, cells_y_);
    for (int y = std::max(cell(around.min().y() - kMargin - origin_y_), 0); y < y_end; ++y) {
      for (int x = std::max(cell(around.min().x() - kMargin - origin_x_), 0); x < x_end; ++x) {
        if (anyInCell(x, y, around, found)) return true;
      }
    }
    return false;
  }

 private:
  static constexpr double kMargin = 1e-4;  // [m]; what only nearly touches is shown as well
  struct Point {
    std::size_t cell;
    int height;
  };

  [[nodiscard]] int cell(double from_origin) const {
    return static_cast<int>(std::floor(from_origin / cell_size_));
  }

  void change(std::size_t scan, int by) {
    if (scan >= scans_.size()) return;
    for (const Point& point : scans_[scan]) {
      auto& column = columns_[point.cell];
      if ((column[point.height] += by) == 0) column.erase(point.height);
    }
  }

  template <typename Found>
  bool anyInCell(int x, int y, const Eigen::AlignedBox3d& around, Found& found) const {
    const auto& column = columns_[static_cast<std::size_t>(y * cells_x_ + x)];
    const Eigen::Vector2d corner(origin_x_ + x * cell_size_, origin_y_ + y * cell_size_);
    for (auto run = column.begin(); run != column.end();) {
      const int bottom = std::max(run->first - thickness_, lowest_);
      int top = std::max(run->first, lowest_ + 1);
      for (; run != column.end() && run->first - thickness_ <= top; ++run) {
        top = std::max(run->first, lowest_ + 1);
      }
      const Eigen::AlignedBox3d cuboid(
          Eigen::Vector3d(corner.x(), corner.y(), bottom * quantum_),
          Eigen::Vector3d(corner.x() + cell_size_, corner.y() + cell_size_, top * quantum_));
      if (cuboid.max().z() + kMargin < around.min().z()) continue;
      if (cuboid.min().z() - kMargin > around.max().z()) break;
      if (found(cuboid)) return true;
    }
    return false;
  }

  double origin_x_, origin_y_, cell_size_, quantum_;
  int thickness_;  ///< in quanta
  int lowest_;     ///< in quanta
  int cells_x_, cells_y_;
  std::vector<std::vector<Point>> scans_;    ///< by serial
  std::vector<std::map<int, int>> columns_;  ///< by cell: how many points are at each height
  std::size_t begin_ = 0, end_ = 0;          ///< serials in the window
};

}  // namespace tccm::test
