#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "check/obstacles.h"
#include "config/parameter_table.h"
#include "tccm_monitor/cuboid_map.h"
#include "tccm_monitor/shape.h"
#include "tccm_monitor/verdict.h"

namespace tccm {

/// A region that shapes may touch things in.
struct ExemptRegion {
  PlacedShape placed;               ///< in the fixed frame, or in that of the link
  std::optional<std::size_t> link;  ///< that it moves with, index into the model's links
  bool in_force = true;
};

/// Regions, and for each shape of a body the indices of those that are for it; no shapes: none at
/// all.
struct ExemptRegions {
  std::vector<ExemptRegion> regions;
  std::vector<std::vector<std::size_t>> of_shapes;
};

struct NearestObstacle {
  double distance_m;
  std::uint32_t obstacle;  ///< index into the map's cuboids, or into the regions
};

class NearestCuboidSearch;

/// Finds the cuboids that a robot's primitives touch (paper, section IV.A): the primitives'
/// footprints name the cells, an exact test decides. Single false points are told from obstacles by
/// support: returns of the window near a contact, in whichever scan.
///
/// Asked about regions to keep out of it answers likewise; every region counts, and nothing is
/// exempt.
class CollisionCheck {
 public:
  struct Config {
    int support_points = 3;
    double support_height_m = 0.03;
    int contacts_max = 256;

    void describe(ParameterTable& table);
  };

  /// @throws ConfigError
  explicit CollisionCheck(const Config& config);

  /// Contacts with cuboids that lie altogether in a region count for nothing from now on.
  void exempt(ExemptRegions regions) { exempt_ = std::move(regions); }
  /// The same regions, as they are now.
  void updateRegions(const std::vector<ExemptRegion>& regions) { exempt_.regions = regions; }
  [[nodiscard]] const ExemptRegions& exempted() const { return exempt_; }
  /// Whether any region is in force for a shape of the body.
  [[nodiscard]] bool exempts(std::size_t index) const;
  [[nodiscard]] const Config& config() const { return config_; }

  // T_fixed_links: where the links are that regions of exemptions move with, by the model's links;
  // without it such regions count for nothing.

  /// The contacts by shape, then by cell or region. @param contacts reused.
  void find(const Obstacles& obstacles, const Body& body, std::vector<Contact>& contacts,
            const std::vector<Pose>* T_fixed_links = nullptr) const;
  /// The first by cell or region that a shape touches.
  /// @param index of the shape in the body. @param but these, in rising order.
  [[nodiscard]] std::optional<std::uint32_t> first(
      const Obstacles& obstacles, const Shape& shape, const Pose& T_fixed_shape,
      std::uint32_t index, const std::vector<Pose>* T_fixed_links = nullptr,
      const std::vector<std::uint32_t>* but = nullptr) const;
  /// The same, of cuboids that have appeared.
  [[nodiscard]] std::optional<std::uint32_t> firstAppeared(
      const CuboidMap& map, const Shape& shape, const Pose& T_fixed_shape, std::uint32_t index,
      const std::vector<Pose>* T_fixed_links = nullptr) const;
  /// The nearest that would count as a contact, were nothing exempt, and is nearer than that; at
  /// distance 0 the first that was found to touch.
  [[nodiscard]] std::optional<NearestObstacle> nearest(
      const Obstacles& obstacles, const Shape& shape, const Pose& T_fixed_shape,
      std::uint32_t index, double nearer_than_m,
      const std::vector<std::uint32_t>* but = nullptr) const;
  /// What was done so far for the questions asked, in cuboids passed by; an exact test counts as 50
  /// of them. A measure of time that is the same in each replay.
  [[nodiscard]] std::size_t work() const { return work_; }
  /// Whether enough returns lie near a cuboid for it to count.
  [[nodiscard]] bool hasSupport(const CuboidMap& map, const Cuboid& cuboid) const;

 private:
  /// Calls visit(index) for each obstacle that the shape touches, until it returns false.
  template <typename Visit>
  void visitTouched(const Obstacles& obstacles, const Shape& shape, const Pose& T_fixed_shape,
                    std::uint32_t index, const std::vector<Pose>* T_fixed_links,
                    Visit&& visit) const;
  /// Calls visit(cuboid index) for each contact with a cuboid that counts(cuboid), until it returns
  /// false.
  template <typename Counts, typename Visit>
  void visitContacts(const CuboidMap& map, const Shape& shape, const Pose& T_fixed_shape,
                     std::uint32_t index, const std::vector<Pose>* T_fixed_links, Counts&& counts,
                     Visit&& visit) const;
  [[nodiscard]] bool isExempt(std::uint32_t index, const UprightBox& cuboid,
                              const std::vector<Pose>* T_fixed_links) const;

  friend class NearestCuboidSearch;

  Config config_;
  ExemptRegions exempt_;
  mutable std::size_t work_ = 0;  ///< of one thread's checks
};

}  // namespace tccm
