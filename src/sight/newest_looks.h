#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "base/bytes_of.h"
#include "sight/look.h"
#include "tccm_monitor/direction_grid.h"

namespace tccm {

/// The newest look in each direction that did not end on the robot, each with its own viewpoint, to
/// tell whether a place was looked at since a scan. Scan lines lie apart: a look that passes beside
/// the robot's outline, as the sensor sees it, does not tell what the robot hides there.
class NewestLooks {
 public:
  /// @param angle_rad a look within it of a place looks at the place, 0.005 to 0.2.
  /// @param outline_rad what lies within it of a look that ended on the robot is beside its
  /// outline.
  NewestLooks(double angle_rad, double outline_rad);

  /// @param serial of the scan; rises from call to call.
  /// @param outline_scans for so many scans an outline stands, where none looked at the robot
  /// again.
  void add(std::uint32_t serial, const std::vector<Look>& looks, std::uint32_t outline_scans);
  /// Whether one of the looks after that scan passed within the angle of the place, and reached it
  /// or ended no more than short_m before it, and the robot's outline beside that look, if any, was
  /// behind the place. Where several looks fell into one direction only the newest is known: the
  /// answer may be no although another look saw the place.
  /// @param viewpoint from which the place is seen; directions are looked up from there.
  [[nodiscard]] bool sawSince(std::uint32_t serial, const Vector3& p_fixed,
                              const Vector3& viewpoint, double short_m) const;
  /// The same of the last scan alone. Places that are beside all of its looks are told at once.
  /// @param viewpoint of that scan.
  [[nodiscard]] bool sawLast(const Vector3& p_fixed, const Vector3& viewpoint,
                             double short_m) const;
  void clear();
  [[nodiscard]] std::size_t memoryBytes() const { return bytesOf(lines_, outlines_); }

 private:
  static constexpr float kNone = std::numeric_limits<float>::max();
  struct Line {
    Eigen::Vector3f viewpoint = Eigen::Vector3f::Zero();
    Eigen::Vector3f direction = Eigen::Vector3f::Zero();
    float range = -1.0F;  ///< below 0: nobody looked there
    std::uint32_t serial = 0;
    float outline = kNone;  ///< distance of the robot beside it
  };
  /// The robot within the outline's angle of a direction.
  struct Outline {
    float distance = kNone;
    std::uint32_t serial = 0;
  };
  void addOutlines(std::uint32_t serial, const std::vector<Look>& looks);
  void addOutline(std::size_t pixel, float distance, std::uint32_t serial);
  void addLines(std::uint32_t serial, const std::vector<Look>& looks, std::uint32_t outline_scans);
  void enclose(const std::vector<Look>& looks);

  DirectionGrid grid_;
  double angle_;
  double cosine_;
  std::uint32_t serial_ = 0;  ///< of the last scan
  // The last scan's directions lie near a plane: those along normal_ are at most this long.
  Vector3 normal_ = Vector3::Zero();
  double band_ = 1.0;
  DirectionGrid::Around looking_;  ///< at a place: a pixel is as large as the angle
  DirectionGrid::Around beside_;   ///< the robot
  std::vector<Line> lines_;
  std::vector<Outline> outlines_;
};

}  // namespace tccm
