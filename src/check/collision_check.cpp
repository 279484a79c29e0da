#include "check/collision_check.h"

#include <algorithm>
#include <array>
#include <limits>

#include "geometry/distance.h"
#include "geometry/overlap.h"

namespace tccm {
namespace {

constexpr std::size_t kTest = 50;  // cuboids passed by in the time of an exact test

constexpr auto kAny = [](const Cuboid&) { return true; };

bool isAmong(const std::vector<std::uint32_t>* cuboids, std::uint32_t cuboid) {
  return cuboids && std::binary_search(cuboids->begin(), cuboids->end(), cuboid);
}

bool liesIn(const UprightBox& cuboid, const Shape& region, const Pose& T_region_fixed) {
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3 p_fixed = cuboid.corner(static_cast<UprightBox::CornerType>(corner));
    if (distance(region, T_region_fixed * p_fixed) > 0.0) return false;
  }
  return true;
}

}  // namespace

/// Looks for the cuboid nearest to a placed shape, from the rows of cells in its middle outwards,
/// and ever less far as nearer ones are found.
class NearestCuboidSearch {
 public:
  NearestCuboidSearch(const CollisionCheck& check, const CuboidMap& map, const Shape& shape,
                      const Pose& T_fixed_shape, double nearer_than_m,
                      const std::vector<std::uint32_t>* but)
      : check_(check),
        map_(map),
        shape_(shape),
        T_fixed_shape_(T_fixed_shape),
        but_(but),
        around_(bounds(shape, T_fixed_shape)),
        cells_a_metre_(1.0 / map.grid.config().cell_size_m) {
    setReach(nearer_than_m);
  }

  [[nodiscard]] std::optional<NearestObstacle> find() {
    const auto rows = static_cast<int>(map_.grid.cellsY());
    searchBelow();
    int above = rowOf(around_.center().y()), below = above - 1;
    while ((above < rows || below >= 0) && reach_m_ > 0.0) {
      if (above < rows && !searchRow(above++)) above = rows;
      if (below >= 0 && !searchRow(below--)) below = -1;
    }
    return best_;
  }

 private:
  /// Across the gap between the shape and a cuboid.
  struct Plane {
    Vector3 normal = Vector3::Zero();                          ///< towards the shape
    double lowest = -std::numeric_limits<double>::infinity();  ///< of the shape along it
  };

  /// What stands below its lowest point is mostly among the nearest.
  void searchBelow() {
    const Vector3 p_fixed = furthest(shape_, T_fixed_shape_, -Vector3::UnitZ());
    const int row = rowOf(p_fixed.y());
    if (row == static_cast<int>(map_.grid.cellsY())) return;
    x_begin_ = columnOf(p_fixed.x());
    x_end_ = x_begin_ + 1;
    searchRow(row);
    setReach(reach_m_);
  }

  /// @return false where the row, and with it all beyond, is too far away.
  bool searchRow(int row) {
    const Grid::Config& grid = map_.grid.config();
    const double y = grid.origin_y_m + row * grid.cell_size_m;
    const double gap_y = gap(y, y + grid.cell_size_m, 1);
    if (gap_y >= reach_m_) return false;
    const CellIndex row_begin = static_cast<CellIndex>(row) * map_.grid.cellsX();
    const std::uint32_t* cell_begin = &map_.cell_begin[row_begin];
    const std::uint32_t count = cell_begin[x_end_] - cell_begin[x_begin_];
    check_.work_ += 1 + count;
    if (count > 0) searchCells(row_begin, y, gap_y);
    return true;
  }

  /// Apart, since most rows are empty and pass by faster without what this needs.
  void searchCells(CellIndex row_begin, double y, double gap_y) {
    const Grid::Config& grid = map_.grid.config();
    const std::uint32_t* cell_begin = &map_.cell_begin[row_begin];
    for (std::uint32_t k = cell_begin[x_begin_]; k < cell_begin[x_end_]; ++k) {
      const Cuboid& cuboid = map_.cuboids[k];
      if (cuboid.top < low_ || cuboid.bottom > high_) continue;
      const double x = grid.origin_x_m + (cuboid.cell - row_begin) * grid.cell_size_m;
      const double bottom = map_.grid.metres(cuboid.bottom);
      const double top = map_.grid.metres(cuboid.top);
      const double gap_x = gap(x, x + grid.cell_size_m, 0), gap_z = gap(bottom, top, 2);
      if (gap_x * gap_x + gap_y * gap_y + gap_z * gap_z >= reach_m_ * reach_m_) continue;
      if (isBeyondAnyPlane(x, y, bottom, top) || isAmong(but_, k)) continue;
      check_.work_ += kTest;
      const Separation apart = separation(shape_, T_fixed_shape_, map_.box(cuboid), reach_m_);
      addPlane(apart.direction);
      if (apart.distance_m >= reach_m_ || !check_.hasSupport(map_, cuboid)) continue;
      best_ = NearestObstacle{apart.distance_m, k};
      setReach(apart.distance_m);
      if (reach_m_ == 0.0) break;
    }
  }

  /// Between the shape's bounds and an interval along an axis; 0 where they overlap [m].
  [[nodiscard]] double gap(double low, double high, int axis) const {
    return std::max({0.0, low - around_.max()[axis], around_.min()[axis] - high});
  }

  /// The number of rows where y lies beyond them all.
  [[nodiscard]] int rowOf(double y) const {
    const double row = (y - map_.grid.config().origin_y_m) * cells_a_metre_;
    return row > 0.0 ? static_cast<int>(std::min(row, 1.0 * map_.grid.cellsY())) : 0;
  }

  [[nodiscard]] CellIndex columnOf(double x) const {
    const double column = (x - map_.grid.config().origin_x_m) * cells_a_metre_;
    return column > 0.0 ? static_cast<CellIndex>(std::min(column, map_.grid.cellsX() - 1.0)) : 0;
  }

  void addPlane(const Vector3& normal) {
    planes_[next_plane_] = {normal, normal.dot(furthest(shape_, T_fixed_shape_, -normal))};
    next_plane_ = (next_plane_ + 1) % planes_.size();
  }

  /// Whether the gap to one of the last shows of this one as well that it is far enough away.
  [[nodiscard]] bool isBeyondAnyPlane(double x, double y, double bottom, double top) const {
    const double cell_size = map_.grid.config().cell_size_m;
    for (const Plane& plane : planes_) {
      const double highest = std::max(plane.normal.x() * x, plane.normal.x() * (x + cell_size)) +
                             std::max(plane.normal.y() * y, plane.normal.y() * (y + cell_size)) +
                             std::max(plane.normal.z() * bottom, plane.normal.z() * top);
      if (plane.lowest - highest >= reach_m_ - kRounding) return true;
    }
    return false;
  }

  void setReach(double metres) {
    reach_m_ = metres;
    x_begin_ = columnOf(around_.min().x() - metres - kRounding);
    x_end_ = columnOf(around_.max().x() + metres + kRounding) + 1;
    low_ = map_.grid.heightFloor(around_.min().z() - metres);
    high_ = map_.grid.heightCeil(around_.max().z() + metres);
  }

  static constexpr double kRounding = 1e-9;

  const CollisionCheck& check_;
  const CuboidMap& map_;
  const Shape& shape_;
  const Pose& T_fixed_shape_;
  const std::vector<std::uint32_t>* but_;
  UprightBox around_;
  double cells_a_metre_;
  double reach_m_ = 0.0;  ///< what is not nearer need not be looked at
  CellIndex x_begin_ = 0, x_end_ = 0;
  Height low_ = 0, high_ = 0;
  std::optional<NearestObstacle> best_;
  std::array<Plane, 3> planes_;
  std::size_t next_plane_ = 0;
};

void CollisionCheck::Config::describe(ParameterTable& table) {
  table.add("support_points", &support_points, "points", {1, 20},
            "a contact counts where so many returns lie near it; 1: always", Tunable::kYes);
  table.add("support_height_m", &support_height_m, "m", {0.0, 1.0},
            "near: in the 3 x 3 cells around it, and within this height");
  table.add("contacts_max", &contacts_max, "", {1, 100000}, "contacts listed");
}

CollisionCheck::CollisionCheck(const Config& config) : config_(validated(config)) {}

bool CollisionCheck::exempts(std::size_t index) const {
  if (exempt_.of_shapes.empty()) return false;
  const std::vector<std::size_t>& regions = exempt_.of_shapes[index];
  return std::any_of(regions.begin(), regions.end(),
                     [this](std::size_t i) { return exempt_.regions[i].in_force; });
}

bool CollisionCheck::isExempt(std::uint32_t index, const UprightBox& cuboid,
                              const std::vector<Pose>* T_fixed_links) const {
  if (exempt_.of_shapes.empty()) return false;
  const std::vector<std::size_t>& regions = exempt_.of_shapes[index];
  return std::any_of(regions.begin(), regions.end(), [&](std::size_t i) {
    const ExemptRegion& region = exempt_.regions[i];
    if (!region.in_force || (region.link && !T_fixed_links)) return false;
    Pose T_fixed_region = region.placed.pose;
    if (region.link) T_fixed_region = (*T_fixed_links)[*region.link] * T_fixed_region;
    return liesIn(cuboid, region.placed.shape, T_fixed_region.inverse());
  });
}

template <typename Counts, typename Visit>
void CollisionCheck::visitContacts(const CuboidMap& map, const Shape& shape,
                                   const Pose& T_fixed_shape, std::uint32_t index,
                                   const std::vector<Pose>* T_fixed_links, Counts&& counts,
                                   Visit&& visit) const {
  const UprightBox around = bounds(shape, T_fixed_shape);
  const Grid::Footprint footprint = map.grid.footprint(around);
  const Height low = map.grid.heightFloor(around.min().z());
  const Height high = map.grid.heightCeil(around.max().z());
  for (CellIndex y = footprint.y_begin; y < footprint.y_end; ++y) {
    const std::uint32_t* cell_begin = &map.cell_begin[std::size_t{y} * map.grid.cellsX()];
    const std::uint32_t end = cell_begin[footprint.x_end];
    work_ += 1 + end - cell_begin[footprint.x_begin];
    for (std::uint32_t k = cell_begin[footprint.x_begin]; k < end; ++k) {
      const Cuboid& cuboid = map.cuboids[k];
      if (cuboid.top < low || cuboid.bottom > high || !counts(cuboid)) continue;
      const UprightBox box = map.box(cuboid);
      work_ += kTest;
      if (!overlaps(shape, T_fixed_shape, box)) continue;
      if (!hasSupport(map, cuboid) || isExempt(index, box, T_fixed_links)) continue;
      if (!visit(k)) return;
    }
  }
}

bool CollisionCheck::hasSupport(const CuboidMap& map, const Cuboid& cuboid) const {
  // Its own returns are most of the support, and mostly enough.
  const auto needed = static_cast<std::uint32_t>(config_.support_points);
  return cuboid.points >= needed || needed <= 1 ||
         supportOf(map, cuboid, config_.support_height_m) >= needed;
}

template <typename Visit>
void CollisionCheck::visitTouched(const Obstacles& obstacles, const Shape& shape,
                                  const Pose& T_fixed_shape, std::uint32_t index,
                                  const std::vector<Pose>* T_fixed_links, Visit&& visit) const {
  if (const KeepOut* keep_out = obstacles.keepOut()) {
    work_ += kTest * keep_out->size();
    keep_out->visitTouched(shape, T_fixed_shape, index, visit);
  } else {
    visitContacts(*obstacles.map(), shape, T_fixed_shape, index, T_fixed_links, kAny, visit);
  }
}

void CollisionCheck::find(const Obstacles& obstacles, const Body& body,
                          std::vector<Contact>& contacts,
                          const std::vector<Pose>* T_fixed_links) const {
  contacts.clear();
  const auto most = static_cast<std::size_t>(config_.contacts_max);
  contacts.reserve(most);
  for (std::uint32_t i = 0; i < body.shapes.size() && contacts.size() < most; ++i) {
    visitTouched(obstacles, body.shapes[i], body.poses[i], i, T_fixed_links,
                 [&](std::uint32_t obstacle) {
                   contacts.push_back({i, obstacle});
                   return contacts.size() < most;
                 });
  }
}

std::optional<std::uint32_t> CollisionCheck::first(const Obstacles& obstacles, const Shape& shape,
                                                   const Pose& T_fixed_shape, std::uint32_t index,
                                                   const std::vector<Pose>* T_fixed_links,
                                                   const std::vector<std::uint32_t>* but) const {
  std::optional<std::uint32_t> found;
  visitTouched(obstacles, shape, T_fixed_shape, index, T_fixed_links,
               [&found, but](std::uint32_t obstacle) {
                 if (isAmong(but, obstacle)) return true;
                 found = obstacle;
                 return false;
               });
  return found;
}

std::optional<std::uint32_t> CollisionCheck::firstAppeared(
    const CuboidMap& map, const Shape& shape, const Pose& T_fixed_shape, std::uint32_t index,
    const std::vector<Pose>* T_fixed_links) const {
  std::optional<std::uint32_t> found;
  const auto hasAppeared = [](const Cuboid& cuboid) { return cuboid.appeared; };
  visitContacts(map, shape, T_fixed_shape, index, T_fixed_links, hasAppeared,
                [&found](std::uint32_t cuboid) {
                  found = cuboid;
                  return false;
                });
  return found;
}

std::optional<NearestObstacle> CollisionCheck::nearest(
    const Obstacles& obstacles, const Shape& shape, const Pose& T_fixed_shape, std::uint32_t index,
    double nearer_than_m, const std::vector<std::uint32_t>* but) const {
  if (const KeepOut* keep_out = obstacles.keepOut()) {
    work_ += kTest * keep_out->size();
    const auto found = keep_out->nearest(shape, T_fixed_shape, index, nearer_than_m, but);
    if (!found) return std::nullopt;
    return NearestObstacle{found->distance_m, found->region};
  }
  return NearestCuboidSearch(*this, *obstacles.map(), shape, T_fixed_shape, nearer_than_m, but)
      .find();
}

}  // namespace tccm
