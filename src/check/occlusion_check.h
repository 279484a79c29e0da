#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "check/z_buffer.h"
#include "geometry/shape.h"
#include "map/cuboid_map.h"

namespace tccm {

/// How much of one link the sensor can see. The fractions are of its silhouette and add up to 1.
struct LinkVisibility {
  std::uint32_t link = 0;          ///< as the caller numbers links
  double silhouette = 0.0;         ///< its share of the picture, in pixels at the horizon
  double visible_fraction = 1.0;   ///< seen as far as to the link; 1 where it does not show at all
  double occluded_fraction = 0.0;  ///< surroundings stand before it
  double unseen_fraction = 0.0;    ///< nobody looked there, or the robot itself stood before it
};

/// Says which links are hidden from the sensor (paper, section IV.B): there the robot would move
/// blindly. Three answers for each direction: the newest look in it tells whether the sensor saw as
/// far as to the link, or something stood before; where the robot itself stood before, cuboids do,
/// held ones too; where there are none, or all looks are old, it is not known. Cuboids alone would
/// hide too much: they are as thick as a cell, and every pixel that they reach into counts.
class OcclusionCheck {
 public:
  struct Config {
    double resolution_rad = 0.035;  ///< edge of a pixel; finer than the scans are is of no use
    double margin_m = 0.05;         ///< a cuboid hides only what lies behind it by more
    /// A link is occluded where at least this share of its silhouette is.
    double hidden_fraction = 0.15;
    /// Less than this many pixels of silhouette are too few to judge by.
    double silhouette_min_pixels = 2.0;
    /// Looks that are older than so many tilt periods say nothing.
    double old_periods = 1.5;

    /// @throws ConfigError
    void validate() const;
  };

  struct Result {
    std::vector<LinkVisibility> links;   ///< in the order of the links handed over
    std::vector<std::uint32_t> cuboids;  ///< those that a part of any link is hidden behind
    [[nodiscard]] const LinkVisibility* worst() const;
  };

  /// @param link_of_shape for each of the body's shapes the link it belongs to.
  /// @throws ConfigError
  OcclusionCheck(const Config& config, std::vector<std::uint32_t> link_of_shape);

  /// The reference is valid until the next call.
  const Result& find(const CuboidMap& map, const Body& body);

  [[nodiscard]] bool isOccluded(const LinkVisibility& link) const;
  /// The picture of the last find().
  [[nodiscard]] const ZBuffer& picture() const { return buffer_; }

 private:
  void drawFromNearToFar(const Vector3& viewpoint, const Body& body);
  enum class PixelSight : std::uint8_t { kVisible, kOccluded, kUnseen };
  void askLooks(const CuboidMap& map);
  void countPixels();
  /// Unseen: cuboids must tell.
  [[nodiscard]] PixelSight sightOf(const LookImage::Passes& passes, const ZBuffer::Pixel& drawn,
                                   LookImage::Ticks oldest) const;

  Config config_;
  std::vector<std::uint32_t> slot_of_shape_;  ///< index into result_.links
  ZBuffer buffer_;
  Result result_;
  std::vector<std::pair<double, std::uint32_t>> order_;  ///< distance of each shape, reused
  std::vector<PixelSight> sights_;  ///< what the looks say of each pixel that is drawn, reused
};

}  // namespace tccm
