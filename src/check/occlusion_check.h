#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "check/z_buffer.h"
#include "config/parameter_table.h"
#include "tccm_monitor/cuboid_map.h"
#include "tccm_monitor/shape.h"
#include "tccm_monitor/verdict.h"

namespace tccm {

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

    void describe(ParameterTable& table);
  };

  struct Result {
    std::vector<LinkVisibility> links;   ///< in the order of the links handed over
    std::vector<std::uint32_t> cuboids;  ///< those that a part of any link is hidden behind
    [[nodiscard]] const LinkVisibility* worst() const;
  };

  /// @param link_of_shape for each of the body's shapes the link it belongs to.
  /// @param old_periods looks that are older than so many tilt periods say nothing.
  /// @throws ConfigError
  OcclusionCheck(const Config& config, std::vector<std::uint32_t> link_of_shape,
                 double old_periods = 1.5);

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
  double old_periods_;
  std::vector<std::uint32_t> slot_of_shape_;  ///< index into result_.links
  ZBuffer buffer_;
  Result result_;
  std::vector<std::pair<double, std::uint32_t>> order_;  ///< distance of each shape, reused
  std::vector<PixelSight> sights_;  ///< what the looks say of each pixel that is drawn, reused
};

}  // namespace tccm
