#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tccm_monitor/cuboid_map.h"

namespace tccm {

/// A colour as a vertex buffer has it.
struct Rgba {
  std::uint8_t red = 0, green = 0, blue = 0, opacity = 255;

  [[nodiscard]] bool operator==(const Rgba& other) const {
    return red == other.red && green == other.green && blue == other.blue &&
           opacity == other.opacity;
  }
};

/// What the colour of a cuboid tells.
enum class CuboidColoring {
  kVerdict,  ///< as kDynamic, and what the last check flagged
  kDynamic,  ///< static, dynamic or held
  kAge,      ///< for how many windows something has been there
  kHeight,   ///< of its top, within the map's area
  kSensor,   ///< one colour for all
  kHeld,     ///< held or live
};

/// How cuboids are drawn.
struct CuboidLook {
  CuboidColoring coloring = CuboidColoring::kVerdict;
  std::uint32_t static_windows = 3;  ///< dyn from which on one is static
  Rgba sensor{64, 191, 77, 255};     ///< of kSensor
  double opacity = 1.0;              ///< 0 to 1
};

/// A part of a column that a check flagged. Of which map it was does not matter: it is named by its
/// place.
struct FlaggedPlace {
  CellIndex cell = 0;
  double bottom_m = 0.0, top_m = 0.0;
  bool touched = false;  ///< false: it hides a link

  [[nodiscard]] bool operator==(const FlaggedPlace& other) const {
    return cell == other.cell && bottom_m == other.bottom_m && top_m == other.top_m &&
           touched == other.touched;
  }
};

/// The side of a cuboid that a face is on. East is where x grows, north where y does.
enum class Side : std::uint8_t { kTop, kBottom, kEast, kWest, kNorth, kSouth };
constexpr std::size_t kSides = 6;

/// A corner of a face, as a vertex buffer has it.
struct CuboidVertex {
  float x, y, z;  ///< in the map's frame [m]
  Rgba color;
};

/// Faces of cuboids, with the shading in their colours: what they show needs no lights.
struct CuboidFaces {
  static constexpr std::size_t kCorners = 4;  ///< of a face, counterclockwise seen from outside

  /// By side; those to the east and west ordered by x, those to the north and south by y.
  std::array<std::vector<CuboidVertex>, kSides> sides;
  UprightBox bounds;         ///< of all cuboids; empty where there are none
  bool translucent = false;  ///< whether any may be seen through

  void clear();
  [[nodiscard]] std::size_t count() const;
  [[nodiscard]] std::size_t count(Side side) const {
    return sides[static_cast<std::size_t>(side)].size() / kCorners;
  }
  struct Range {
    std::size_t begin, end;
  };
  /// The faces of a side that may be seen from a point: all others show it their backs.
  [[nodiscard]] Range facing(Side side, const Eigen::Vector3f& eye) const;
};

/// The faces of a map's cuboids. What cuboids of neighbouring cells hide of each other is left out.
/// Knows no rviz.
class CuboidGeometry {
 public:
  /// Reuses its memory. @pre the map is one that fromMessage() found no defect in.
  void build(const CuboidMap& map, const CuboidLook& look,
             const std::vector<FlaggedPlace>& flagged);

  [[nodiscard]] const CuboidFaces& live() const { return live_; }
  /// They may be seen through, also where live ones may not.
  [[nodiscard]] const CuboidFaces& held() const { return held_; }
  [[nodiscard]] std::size_t faces() const { return live_.count() + held_.count(); }

 private:
  enum class Mark : std::uint8_t { kNone, kHides, kTouched };

  void markFlagged(const CuboidMap& map, const std::vector<FlaggedPlace>& flagged);
  void orderByColumn(const CuboidMap& map);
  [[nodiscard]] Rgba colorOf(const CuboidMap& map, std::size_t cuboid,
                             const CuboidLook& look) const;
  [[nodiscard]] CuboidFaces& layerOf(const Cuboid& cuboid) { return cuboid.held ? held_ : live_; }

  CuboidFaces live_, held_;
  std::vector<Mark> marks_;             ///< of each cuboid
  std::vector<Rgba> colors_;            ///< of each cuboid
  std::vector<std::uint32_t> by_x_;     ///< the cuboids, ordered by their cells along x
  std::vector<std::uint32_t> columns_;  ///< where those of each begin
};

}  // namespace tccm
