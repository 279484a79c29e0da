#pragma once

#include <cstdint>
#include <vector>

#include "tccm_monitor/geometry/direction_grid.h"
#include "tccm_monitor/map/look.h"

namespace tccm {

/// The newest look in each direction that did not end on the robot, each with its own viewpoint, to
/// tell whether a place was looked at since a scan.
class NewestLooks {
 public:
  /// @param angle_rad a look within it of a place looks at the place, 0.005 to 0.2.
  explicit NewestLooks(double angle_rad);

  /// @param serial of the scan; rises from call to call.
  void add(std::uint32_t serial, const std::vector<Look>& looks);
  /// Whether one of the looks after that scan passed within the angle of the place, and reached it
  /// or ended no more than short_m before it. Where several looks fell into one direction only the
  /// newest is known: the answer may be no although another look saw the place.
  /// @param viewpoint from which the place is seen; directions are looked up from there.
  [[nodiscard]] bool sawSince(std::uint32_t serial, const Vector3& p_fixed,
                              const Vector3& viewpoint, double short_m) const;
  /// The same of the last scan alone. Places that are beside all of its looks are told at once.
  /// @param viewpoint of that scan.
  [[nodiscard]] bool sawLast(const Vector3& p_fixed, const Vector3& viewpoint,
                             double short_m) const;
  void clear();
  [[nodiscard]] std::size_t memoryBytes() const { return lines_.capacity() * sizeof(Line); }

 private:
  struct Line {
    Eigen::Vector3f viewpoint = Eigen::Vector3f::Zero();
    Eigen::Vector3f direction = Eigen::Vector3f::Zero();
    float range = -1.0F;  ///< below 0: nobody looked there
    std::uint32_t serial = 0;
  };
  void enclose(const std::vector<Look>& looks);

  DirectionGrid grid_;
  double angle_;
  double cosine_;
  std::uint32_t serial_ = 0;  ///< of the last scan
  // The last scan's directions lie near a plane: those along normal_ are at most this long.
  Vector3 normal_ = Vector3::Zero();
  double band_ = 1.0;
  std::vector<int> columns_within_;  ///< by row
  std::vector<Line> lines_;
};

}  // namespace tccm
