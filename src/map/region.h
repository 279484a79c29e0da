#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "base/bytes_of.h"
#include "tccm_monitor/config_error.h"
#include "tccm_monitor/shape.h"
#include "tccm_monitor/time.h"

namespace tccm {

/// All points within padding_m of a primitive, its border included.
struct PaddedShape {
  PlacedShape placed;      ///< its pose is T_fixed_shape
  double padding_m = 0.0;  ///< 0 to 1
};

/// The union of its shapes, in the fixed frame; empty where there are none.
using Region = std::vector<PaddedShape>;

/// The most shapes a region may have.
constexpr std::size_t kRegionShapesMax = 256;

/// @throws ConfigError naming the shape whose size, pose or padding is no good, or that there are
/// too many.
inline void validate(const Region& region) {
  requireInRange("shapes of the region", static_cast<double>(region.size()), 0.0,
                 static_cast<double>(kRegionShapesMax));
  for (std::size_t i = 0; i < region.size(); ++i) {
    const std::string owner = "shape " + std::to_string(i) + " of the region";
    validate(region[i].placed.shape, owner);
    if (!isRigid(region[i].placed.pose)) throw ConfigError(owner + ": its pose is not rigid");
    requireInRange(owner + ": padding_m", region[i].padding_m, 0.0, 1.0);
  }
}

/// A shape of a region, ready to be asked about many points.
class RegionPart {
 public:
  /// @param shape valid. @param growth_m comes on top of its padding.
  explicit RegionPart(const PaddedShape& shape, double growth_m = 0.0)
      : shape_(shape.placed.shape),
        T_shape_fixed_(shape.placed.pose.inverse()),
        reach_m_(shape.padding_m + growth_m),
        bounds_(tccm::bounds(shape.placed.shape, shape.placed.pose)) {
    constexpr double kRounding = 1e-6;  // [m]
    const Vector3 reach = Vector3::Constant(reach_m_ + kRounding);
    bounds_ = {bounds_.min() - reach, bounds_.max() + reach};
  }

  /// How far a point lies outside, 0 and less inside [m].
  [[nodiscard]] double beyond(const Vector3& p_fixed) const {
    return distance(shape_, T_shape_fixed_ * p_fixed) - reach_m_;
  }
  /// False for what is not finite.
  [[nodiscard]] bool contains(const Vector3& p_fixed) const {
    return bounds_.contains(p_fixed) && beyond(p_fixed) <= 0.0;
  }
  /// Holds the whole part; a little larger than need be.
  [[nodiscard]] const UprightBox& bounds() const { return bounds_; }

 private:
  Shape shape_;
  Pose T_shape_fixed_;
  double reach_m_;
  UprightBox bounds_;
};

/// The regions whose returns are left out of scans that were under way when the map was told to
/// forget them. In doubt a return is mapped: at worst it stops the robot until it leaves the
/// window, and no region stays blind.
class ForgottenRegions {
 public:
  /// A scan stamped longer than this before a region's `until` is not held against the region: then
  /// the two are of different clocks, which must not make a part of the map blind for ever.
  static constexpr Duration kUnderWayMax = std::chrono::seconds(10);
  /// Of all regions together; the shapes that were added first make room.
  static constexpr std::size_t kShapesMax = kRegionShapesMax;

  ForgottenRegions() { entries_.reserve(kShapesMax); }

  /// @param region valid. @param until stamp of the last scan that may still show it.
  void add(const Region& region, Time until);
  /// Chooses the regions for a scan, and drops those that are over. @pre stamps do not fall.
  /// @return whether there are any.
  bool begin(Time stamp);
  /// Whether one of the chosen regions has the point.
  [[nodiscard]] bool contains(const Vector3& p_fixed) const {
    return std::any_of(entries_.begin(), entries_.end(), [&p_fixed](const Entry& entry) {
      return entry.chosen && entry.part.contains(p_fixed);
    });
  }
  void clear() { entries_.clear(); }
  /// Shapes that are remembered.
  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  [[nodiscard]] std::size_t memoryBytes() const { return bytesOf(entries_); }

 private:
  struct Entry {
    RegionPart part;
    Time until;
    bool chosen;
  };
  std::vector<Entry> entries_;
};

inline void ForgottenRegions::add(const Region& region, Time until) {
  const std::size_t room = kShapesMax - entries_.size();
  if (region.size() > room) {
    entries_.erase(entries_.begin(),
                   entries_.begin() + static_cast<std::ptrdiff_t>(region.size() - room));
  }
  for (const PaddedShape& shape : region) entries_.push_back({RegionPart(shape), until, false});
}

inline bool ForgottenRegions::begin(Time stamp) {
  const auto over = [stamp](const Entry& entry) { return entry.until < stamp; };
  entries_.erase(std::remove_if(entries_.begin(), entries_.end(), over), entries_.end());
  for (Entry& entry : entries_) entry.chosen = entry.until <= stamp + kUnderWayMax;
  return std::any_of(entries_.begin(), entries_.end(), [](const Entry& e) { return e.chosen; });
}

}  // namespace tccm
