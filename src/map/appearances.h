#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "config/parameter_table.h"
#include "map/integration_map.h"
#include "tccm_monitor/cuboid_map.h"
#include "tccm_monitor/look_image.h"

namespace tccm {

/// Where something stands that was not there a moment ago. A layer of a cell is a place. A return
/// in a place that was looked through in the last tenths of a second, all around, has appeared
/// there; beside such a one it is enough that the place itself was looked through. What the robot
/// hid, or nobody looked at, has not appeared: it may have stood there all along.
///
/// Only sensors that look everywhere at once can tell, as cameras and lidars do.
class Appearances {
 public:
  struct Config {
    double lasts_s = 1.0;

    void describe(ParameterTable& table);
  };

  /// The first frame that is followed allocates all that will ever be used.
  /// @param resolution_rad of the images of looks.
  Appearances(const Config& config, const IntegrationMap& map, double resolution_rad);

  /// Follows the map's newest frame. @param looks up to the frame before.
  void follow(const IntegrationMap& map, const LookImage& looks);
  /// Sets `appeared` of the snapshot's cuboids: of those around which most of the window's returns,
  /// and eight of the newest frame's, lie in places where something appeared.
  void apply(const IntegrationMap& map, CuboidMap& snapshot) const;
  void clear();
  [[nodiscard]] std::size_t memoryBytes() const {
    return bytesOf(places_, found_) + images_[0].looks.memoryBytes() +
           images_[1].looks.memoryBytes();
  }

 private:
  /// Milliseconds since the first frame, and one.
  using Ticks = std::uint32_t;
  struct Place {
    Ticks seen = 0;             ///< when it had a return last; 0: never
    Ticks appeared = 0;         ///< when something did last; 0: never
    std::uint32_t returns = 0;  ///< in it, of the frame that it was seen in last
  };
  /// What was looked at some time ago.
  struct Image {
    std::optional<Time> stamp;  ///< of its newest frame
    LookImage looks;
  };
  struct Found {
    CellIndex cell;
    std::size_t layer;
  };
  /// Returns around a cuboid.
  struct Around {
    std::uint32_t all = 0, appeared = 0;
    std::uint32_t newest = 0;  ///< of the newest frame, in places where something appeared
  };

  [[nodiscard]] Place& at(CellIndex cell, std::size_t layer) {
    return places_[cell * layers_ + layer];
  }
  [[nodiscard]] bool isLately(const Place& place) const {
    return place.appeared != 0 && now_ - place.appeared <= lasts_;
  }
  void begin(Time now);
  void see(const Found& found);
  void keep(Time stamp, const LookImage& looks);
  [[nodiscard]] Vector3 middleOf(const Found& found) const;
  [[nodiscard]] bool isLately(const Image& image) const;
  [[nodiscard]] bool wasFreeAround(const Found& found) const;
  [[nodiscard]] bool wasFree(const Found& found) const;
  [[nodiscard]] bool isBesideAppeared(const Found& found) const;
  [[nodiscard]] bool hasAppeared(const Cuboid& cuboid, const IntegrationMap& map) const;

  Grid grid_;
  double lowest_m_;  ///< of the lowest layer
  double layer_m_;
  std::size_t layers_;
  Ticks lasts_;
  std::vector<Place> places_;    ///< by cell and layer
  std::vector<Found> found_;     ///< in the newest frame, where nothing was seen lately; reused
  std::array<Image, 2> images_;  ///< the older one first
  std::optional<Time> first_, last_;  ///< frames
  Ticks now_ = 0;
  Ticks newest_ = 0;  ///< when anything appeared last
};

}  // namespace tccm
