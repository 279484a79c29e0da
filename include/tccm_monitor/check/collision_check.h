#pragma once

#include <cstdint>
#include <vector>

#include "tccm_monitor/geometry/shape.h"
#include "tccm_monitor/map/cuboid_map.h"

namespace tccm {

/// A primitive and a cuboid that have a point in common.
struct Contact {
  std::uint32_t shape;   ///< index into the body's shapes
  std::uint32_t cuboid;  ///< index into the map's cuboids
};

/// Finds the cuboids that a robot's primitives touch (paper, section IV.A): the primitives'
/// footprints name the cells, an exact test decides. Single false points are told from obstacles by
/// support: returns of the window near a contact, in whichever scan.
class CollisionCheck {
 public:
  struct Config {
    /// A contact counts where this many returns lie in the 3 x 3 cells around it and within
    /// support_height_m of its cuboid; 1 counts every contact.
    int support_points = 3;
    double support_height_m = 0.03;
    int contacts_max = 256;  ///< no more than these are listed

    /// @throws ConfigError
    void validate() const;
  };

  /// @throws ConfigError
  explicit CollisionCheck(const Config& config);

  /// The contacts by shape, then by cell; the reference is valid until the next call.
  const std::vector<Contact>& find(const CuboidMap& map, const Body& body);

 private:
  void findOf(const CuboidMap& map, const Body& body, std::uint32_t shape);

  Config config_;
  std::vector<Contact> contacts_;
};

}  // namespace tccm
