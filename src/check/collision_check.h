#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "config/parameter_table.h"
#include "tccm_monitor/cuboid_map.h"
#include "tccm_monitor/shape.h"
#include "tccm_monitor/verdict.h"

namespace tccm {

/// For each shape of a body the regions in the fixed frame that it may touch things in; empty: none
/// at all.
using ExemptRegions = std::vector<std::vector<PlacedShape>>;

struct NearestCuboid {
  double distance_m;
  std::uint32_t cuboid;  ///< index into the map's cuboids
};

class NearestCuboidSearch;

/// Finds the cuboids that a robot's primitives touch (paper, section IV.A): the primitives'
/// footprints name the cells, an exact test decides. Single false points are told from obstacles by
/// support: returns of the window near a contact, in whichever scan.
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
  [[nodiscard]] bool exemptsAny() const { return !exempt_.empty(); }
  [[nodiscard]] const Config& config() const { return config_; }

  /// The contacts by shape, then by cell. @param contacts reused.
  void find(const CuboidMap& map, const Body& body, std::vector<Contact>& contacts) const;
  /// The first cuboid by cell that a shape touches.
  /// @param index of the shape in the body, for exempt(). @param but these, in rising order.
  [[nodiscard]] std::optional<std::uint32_t> first(
      const CuboidMap& map, const Shape& shape, const Pose& T_fixed_shape, std::uint32_t index,
      const std::vector<std::uint32_t>* but = nullptr) const;
  /// The nearest cuboid that would count as a contact, regions apart, and is nearer than that; at
  /// distance 0 the first that was found to touch.
  [[nodiscard]] std::optional<NearestCuboid> nearest(
      const CuboidMap& map, const Shape& shape, const Pose& T_fixed_shape, double nearer_than_m,
      const std::vector<std::uint32_t>* but = nullptr) const;
  /// What was done so far for the questions asked, in cuboids passed by; an exact test counts as 50
  /// of them. A measure of time that is the same in each replay.
  [[nodiscard]] std::size_t work() const { return work_; }
  /// Whether enough returns lie near a cuboid for it to count.
  [[nodiscard]] bool hasSupport(const CuboidMap& map, const Cuboid& cuboid) const;

 private:
  /// Calls visit(cuboid index) for each contact, until it returns false.
  template <typename Visit>
  void visitContacts(const CuboidMap& map, const Shape& shape, const Pose& T_fixed_shape,
                     std::uint32_t index, Visit&& visit) const;
  [[nodiscard]] bool isExempt(std::uint32_t index, const UprightBox& cuboid) const;

  friend class NearestCuboidSearch;

  Config config_;
  ExemptRegions exempt_;
  mutable std::size_t work_ = 0;  ///< of one thread's checks
};

}  // namespace tccm
