#include "rviz/cuboid_geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace tccm {
namespace {

// As the markers have them, see docs/interfaces.md.
constexpr Rgba kStatic{64, 191, 77, 255}, kDynamic{230, 64, 38, 255}, kHeld{153, 128, 191, 140};
constexpr Rgba kTouched{255, 0, 204, 255}, kHides{51, 102, 255, 255};
constexpr Rgba kLive{190, 190, 200, 255}, kHeldAlone{170, 90, 255, 255};

/// How bright each side is, in 256ths, so that shapes show without lights.
constexpr std::array<unsigned, kSides> kBrightness{256, 102, 218, 166, 192, 192};

std::uint8_t toByte(double value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
}

Rgba shaded(const Rgba& color, Side side) {
  const unsigned bright = kBrightness[static_cast<std::size_t>(side)];
  const auto shade = [bright](unsigned channel) {
    return static_cast<std::uint8_t>(channel * bright / 256);
  };
  return {shade(color.red), shade(color.green), shade(color.blue), color.opacity};
}

/// From blue at 0 over green to red at 1.
Rgba rainbow(double share) {
  const double hue = 4.0 * (1.0 - std::clamp(share, 0.0, 1.0));  // sixths of the circle
  const auto channel = [hue](double middle) {
    const double apart = std::abs(hue - middle);
    return toByte(255.0 * std::clamp(2.0 - std::min(apart, 6.0 - apart), 0.0, 1.0));
  };
  return {channel(0.0), channel(2.0), channel(4.0), 255};
}

Rgba liveOrDynamic(const Cuboid& cuboid, const CuboidLook& look) {
  if (cuboid.held) return kHeld;
  return cuboid.dyn >= look.static_windows ? kStatic : kDynamic;
}

double ageShare(const CuboidMap& map, const Cuboid& cuboid, const CuboidLook& look) {
  const double windows = std::max(1U, map.window_scans);
  return cuboid.age_scans / windows / std::max(1U, look.static_windows);
}

double heightShare(const Grid& grid, const Cuboid& cuboid) {
  const Grid::Config& area = grid.config();
  return (grid.metres(cuboid.top) - area.height_min_m) / (area.height_max_m - area.height_min_m);
}

Rgba plainColor(const CuboidMap& map, const Cuboid& cuboid, const CuboidLook& look) {
  switch (look.coloring) {
    case CuboidColoring::kAge:
      return rainbow(ageShare(map, cuboid, look));
    case CuboidColoring::kHeight:
      return rainbow(heightShare(map.grid, cuboid));
    case CuboidColoring::kSensor:
      return look.sensor;
    case CuboidColoring::kHeld:
      return cuboid.held ? kHeldAlone : kLive;
    case CuboidColoring::kVerdict:
    case CuboidColoring::kDynamic:
      break;
  }
  return liveOrDynamic(cuboid, look);
}

/// Hands each part of a cuboid's heights that no cuboid of a neighbouring cell stands against to
/// visit(bottom, top). Held ones may be seen through: they hide held ones alone.
template <typename Visit>
void visitBare(const CuboidMap& map, std::optional<CellIndex> neighbour, const Cuboid& cuboid,
               Visit&& visit) {
  Height from = cuboid.bottom;
  const std::uint32_t begin = neighbour ? map.cell_begin[*neighbour] : 0;
  const std::uint32_t end = neighbour ? map.cell_begin[*neighbour + 1] : 0;
  for (std::uint32_t i = begin; i < end && map.cuboids[i].bottom < cuboid.top; ++i) {
    const Cuboid& other = map.cuboids[i];
    if (other.top <= from || (other.held && !cuboid.held)) continue;
    if (other.bottom > from) visit(from, other.bottom);
    from = other.top;
  }
  if (from < cuboid.top) visit(from, cuboid.top);
}

using Corner = std::array<float, 3>;

void addFace(Side side, const Rgba& color, const std::array<Corner, CuboidFaces::kCorners>& corners,
             CuboidFaces& faces) {
  const Rgba shade = shaded(color, side);
  std::array<CuboidVertex, CuboidFaces::kCorners> face{};
  for (std::size_t i = 0; i < face.size(); ++i) {
    face[i] = {corners[i][0], corners[i][1], corners[i][2], shade};
  }
  std::vector<CuboidVertex>& vertices = faces.sides[static_cast<std::size_t>(side)];
  vertices.insert(vertices.end(), face.begin(), face.end());
}

/// The edges of a cuboid in the map's frame.
struct Edges {
  Edges(const CuboidMap& map, const Cuboid& cuboid) {
    const UprightBox box = map.box(cuboid);
    low = box.min().cast<float>();
    high = box.max().cast<float>();
  }
  Eigen::Vector3f low, high;
};

void addEnds(const CuboidMap& map, const Cuboid& cuboid, const Rgba& color, CuboidFaces& faces) {
  const Edges box(map, cuboid);
  const float x0 = box.low.x(), y0 = box.low.y(), z0 = box.low.z();
  const float x1 = box.high.x(), y1 = box.high.y(), z1 = box.high.z();
  addFace(Side::kTop, color, {{{x0, y0, z1}, {x1, y0, z1}, {x1, y1, z1}, {x0, y1, z1}}}, faces);
  addFace(Side::kBottom, color, {{{x0, y0, z0}, {x0, y1, z0}, {x1, y1, z0}, {x1, y0, z0}}}, faces);
}

/// The bare parts of the two sides along one axis.
void addSides(const CuboidMap& map, const Cuboid& cuboid, bool along_x, const Rgba& color,
              CuboidFaces& faces) {
  const Edges box(map, cuboid);
  const float x0 = box.low.x(), y0 = box.low.y(), x1 = box.high.x(), y1 = box.high.y();
  const CellIndex cells_x = std::max(1U, map.grid.cellsX());
  const CellIndex at = along_x ? cuboid.cell % cells_x : cuboid.cell / cells_x;
  const CellIndex end = along_x ? cells_x : map.grid.cellsY();
  const CellIndex step = along_x ? 1 : cells_x;
  using Foot = std::array<float, 2>;
  /// From the corner a to the corner b, counterclockwise seen from above.
  const auto addSide = [&](Side side, std::optional<CellIndex> neighbour, Foot a, Foot b) {
    visitBare(map, neighbour, cuboid, [&](Height bottom, Height top) {
      const auto z0 = static_cast<float>(map.grid.metres(bottom));
      const auto z1 = static_cast<float>(map.grid.metres(top));
      addFace(side, color,
              {{{a[0], a[1], z0}, {b[0], b[1], z0}, {b[0], b[1], z1}, {a[0], a[1], z1}}}, faces);
    });
  };
  const auto after = at + 1 < end ? std::optional(cuboid.cell + step) : std::nullopt;
  const auto before = at > 0 ? std::optional(cuboid.cell - step) : std::nullopt;
  if (along_x) {
    addSide(Side::kEast, after, {x1, y0}, {x1, y1});
    addSide(Side::kWest, before, {x0, y1}, {x0, y0});
  } else {
    addSide(Side::kNorth, after, {x1, y1}, {x0, y1});
    addSide(Side::kSouth, before, {x0, y0}, {x1, y0});
  }
}

}  // namespace

void CuboidFaces::clear() {
  for (std::vector<CuboidVertex>& side : sides) side.clear();
  bounds.setEmpty();
  translucent = false;
}

std::size_t CuboidFaces::count() const {
  std::size_t corners = 0;
  for (const std::vector<CuboidVertex>& side : sides) corners += side.size();
  return corners / kCorners;
}

CuboidFaces::Range CuboidFaces::facing(Side side, const Eigen::Vector3f& eye) const {
  const std::size_t end = count(side);
  const std::vector<CuboidVertex>& corners = sides[static_cast<std::size_t>(side)];
  /// How many lie before the eye, of faces that are ordered along the axis.
  const auto before = [&](float CuboidVertex::*axis, float at) {
    std::size_t low = 0, high = end;
    while (low < high) {
      const std::size_t middle = (low + high) / 2;
      const bool is_before = corners[middle * kCorners].*axis < at;
      (is_before ? low : high) = is_before ? middle + 1 : middle;
    }
    return low;
  };
  switch (side) {
    case Side::kTop:
      return {0, static_cast<double>(eye.z()) > bounds.min().z() ? end : 0};
    case Side::kBottom:
      return {0, static_cast<double>(eye.z()) < bounds.max().z() ? end : 0};
    case Side::kEast:
      return {0, before(&CuboidVertex::x, eye.x())};
    case Side::kWest:
      return {before(&CuboidVertex::x, eye.x()), end};
    case Side::kNorth:
      return {0, before(&CuboidVertex::y, eye.y())};
    case Side::kSouth:
      return {before(&CuboidVertex::y, eye.y()), end};
  }
  return {0, end};
}

void CuboidGeometry::build(const CuboidMap& map, const CuboidLook& look,
                           const std::vector<FlaggedPlace>& flagged) {
  live_.clear();
  held_.clear();
  marks_.assign(map.cuboids.size(), Mark::kNone);
  if (look.coloring == CuboidColoring::kVerdict) markFlagged(map, flagged);
  colors_.resize(map.cuboids.size());
  for (std::size_t i = 0; i < map.cuboids.size(); ++i) {
    const Cuboid& cuboid = map.cuboids[i];
    CuboidFaces& faces = layerOf(cuboid);
    colors_[i] = colorOf(map, i, look);
    faces.translucent = faces.translucent || colors_[i].opacity < 255;
    faces.bounds.extend(map.box(cuboid));
    addEnds(map, cuboid, colors_[i], faces);
    addSides(map, cuboid, false, colors_[i], faces);
  }
  orderByColumn(map);
  for (const std::uint32_t i : by_x_) {
    addSides(map, map.cuboids[i], true, colors_[i], layerOf(map.cuboids[i]));
  }
}

Rgba CuboidGeometry::colorOf(const CuboidMap& map, std::size_t cuboid,
                             const CuboidLook& look) const {
  Rgba color = plainColor(map, map.cuboids[cuboid], look);
  if (marks_[cuboid] == Mark::kTouched) color = kTouched;
  if (marks_[cuboid] == Mark::kHides) color = kHides;
  color.opacity = toByte(color.opacity * look.opacity);
  return color;
}

void CuboidGeometry::markFlagged(const CuboidMap& map, const std::vector<FlaggedPlace>& flagged) {
  for (const FlaggedPlace& place : flagged) {
    if (place.cell >= map.grid.cells()) continue;
    for (std::uint32_t i = map.cell_begin[place.cell]; i < map.cell_begin[place.cell + 1]; ++i) {
      const bool meets = map.grid.metres(map.cuboids[i].bottom) < place.top_m &&
                         map.grid.metres(map.cuboids[i].top) > place.bottom_m;
      if (meets) marks_[i] = std::max(marks_[i], place.touched ? Mark::kTouched : Mark::kHides);
    }
  }
}

void CuboidGeometry::orderByColumn(const CuboidMap& map) {
  const CellIndex cells_x = std::max(1U, map.grid.cellsX());
  columns_.assign(cells_x + 1, 0);
  for (const Cuboid& cuboid : map.cuboids) ++columns_[cuboid.cell % cells_x + 1];
  for (CellIndex x = 0; x < cells_x; ++x) columns_[x + 1] += columns_[x];
  by_x_.resize(map.cuboids.size());
  for (std::uint32_t i = 0; i < map.cuboids.size(); ++i) {
    by_x_[columns_[map.cuboids[i].cell % cells_x]++] = i;
  }
}

}  // namespace tccm
