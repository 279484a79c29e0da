#pragma once

#include <octomap/OcTree.h>

#include <cstdint>
#include <deque>
#include <unordered_map>
#include <vector>

#include "support/literal_map.h"
#include "support/part_union.h"
#include "tccm_monitor/cuboid_map.h"

namespace tccm::peers {

using Points = std::vector<Vector3>;

/// Below this nothing can be: each return is taken to the fixed frame, and its cell and height are
/// found. Nothing is kept.
class CellsAlone {
 public:
  explicit CellsAlone(const Grid& grid) : grid_(grid) {}

  void add(const Points& points) {
    for (const Vector3& p : points) {
      const auto place = grid_.place(T_fixed_sensor_ * p);
      if (place) sum_ += place->cell + static_cast<std::uint64_t>(place->height);
    }
  }
  void expireOldest() {}
  [[nodiscard]] static std::size_t scans() { return 0; }
  [[nodiscard]] std::uint64_t sum() const { return sum_; }

 private:
  Grid grid_;
  Pose T_fixed_sensor_ = Pose::Identity();
  std::uint64_t sum_ = 0;
};

/// What a map of the same window could be at least: a counter for each voxel of the area, one up
/// for each return that comes and one down for each that leaves. No cuboids, no ages.
class FlatCounters {
 public:
  FlatCounters(const Grid& grid, double voxel_m)
      : grid_(grid),
        quanta_(grid.heightOf(voxel_m)),
        lowest_(grid.heightFloor(grid.config().height_min_m)),
        layers_(static_cast<std::size_t>(
            (grid.heightCeil(grid.config().height_max_m) - lowest_) / quanta_ + 1)),
        counts_(grid.cells() * layers_) {}

  void add(const Points& points) {
    std::vector<std::uint32_t> scan = take();
    for (const Vector3& p : points) {
      const auto place = grid_.place(p);
      if (!place) continue;
      const auto layer = static_cast<std::size_t>((place->height - lowest_) / quanta_);
      const auto voxel = static_cast<std::uint32_t>(place->cell * layers_ + layer);
      ++counts_[voxel];
      scan.push_back(voxel);
    }
    scans_.push_back(std::move(scan));
  }
  void expireOldest() {
    for (const std::uint32_t voxel : scans_.front()) --counts_[voxel];
    spare_ = std::move(scans_.front());
    scans_.pop_front();
  }
  [[nodiscard]] std::size_t scans() const { return scans_.size(); }

 private:
  std::vector<std::uint32_t> take() {
    spare_.clear();
    return std::move(spare_);
  }

  Grid grid_;
  int quanta_;
  int lowest_;
  std::size_t layers_;
  std::vector<std::uint16_t> counts_;
  std::deque<std::vector<std::uint32_t>> scans_;
  std::vector<std::uint32_t> spare_;
};

/// The same in a hash table, as voxel grids of unbounded areas are kept.
class VoxelTable {
 public:
  VoxelTable(const Grid& grid, double voxel_m) : grid_(grid), quanta_(grid.heightOf(voxel_m)) {}

  void add(const Points& points) {
    std::vector<std::uint64_t> scan;
    for (const Vector3& p : points) {
      const auto place = grid_.place(p);
      if (!place) continue;
      const auto layer = static_cast<std::uint64_t>(place->height / quanta_ + 32768);
      const std::uint64_t voxel = std::uint64_t{place->cell} << 16U | layer;
      ++counts_[voxel];
      scan.push_back(voxel);
    }
    scans_.push_back(std::move(scan));
  }
  void expireOldest() {
    for (const std::uint64_t voxel : scans_.front()) {
      const auto found = counts_.find(voxel);
      if (--found->second == 0) counts_.erase(found);
    }
    scans_.pop_front();
  }
  [[nodiscard]] std::size_t scans() const { return scans_.size(); }

 private:
  Grid grid_;
  int quanta_;
  std::unordered_map<std::uint64_t, std::uint32_t> counts_;
  std::deque<std::vector<std::uint64_t>> scans_;
};

/// OctoMap has no window: what is seen no more stays until rays pass through it.
class OctoMap {
 public:
  /// @param with_rays as insertPointCloud does by default; else hits alone.
  OctoMap(const Grid& grid, double voxel_m, bool with_rays, const Vector3& viewpoint)
      : grid_(grid), with_rays_(with_rays), origin_(toPoint(viewpoint)), tree_(voxel_m) {}

  void add(const Points& points) {
    cloud_.clear();
    for (const Vector3& p : points) {
      if (grid_.place(p)) cloud_.push_back(toPoint(p));
    }
    if (with_rays_) return tree_.insertPointCloud(cloud_, origin_);
    for (const octomap::point3d& p : cloud_) tree_.updateNode(p, true, true);
    tree_.updateInnerOccupancy();
  }
  void expireOldest() {}
  [[nodiscard]] static std::size_t scans() { return 0; }

 private:
  static octomap::point3d toPoint(const Vector3& p) {
    const Eigen::Vector3f f = p.cast<float>();
    return {f.x(), f.y(), f.z()};
  }

  Grid grid_;
  bool with_rays_;
  octomap::point3d origin_;
  octomap::OcTree tree_;
  octomap::Pointcloud cloud_;
};

/// The paper's lists (section III.C.2). Finding cells and heights counts here, as elsewhere.
class PaperLists {
 public:
  explicit PaperLists(const Grid& grid) : grid_(grid), map_(grid.cells(), 20) {}

  void add(const Points& points) {
    map_.add(test::mappedReturns(grid_, points));
    ++scans_;
  }
  void expireOldest() {
    map_.expireOldest();
    --scans_;
  }
  [[nodiscard]] std::size_t scans() const { return scans_; }

 private:
  Grid grid_;
  test::LiteralMap map_;
  std::size_t scans_ = 0;
};

}  // namespace tccm::peers
