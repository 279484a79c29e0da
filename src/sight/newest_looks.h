#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "base/bytes_of.h"
#include "base/index_set.h"
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
  /// False where sawLast() is sure to say no; in a few steps, to be asked of many.
  [[nodiscard]] bool maySeeLast(const Eigen::Vector3f& p_fixed) const {
    return last_.mayHave(p_fixed.x(), p_fixed.y(), p_fixed.z());
  }
  /// The same of places whose coordinates lie in three rows. @param may 0 or 1 for each; 1 for NaN.
  void maySeeLast(const float* x, const float* y, const float* z, std::size_t count,
                  std::uint32_t* may) const;
  void clear();
  [[nodiscard]] std::size_t memoryBytes() const {
    return bytesOf(lines_, outlines_) + bytesOf(serials_) + looked_.memoryBytes();
  }

 private:
  static constexpr float kNone = std::numeric_limits<float>::max();
  struct Line {
    Eigen::Vector3f viewpoint = Eigen::Vector3f::Zero();
    Eigen::Vector3f direction = Eigen::Vector3f::Zero();
    float range = -1.0F;    ///< below 0: nobody looked there
    float outline = kNone;  ///< distance of the robot beside it
  };
  /// The robot within the outline's angle of a direction.
  struct Outline {
    float distance = kNone;
    std::uint32_t serial = 0;
  };
  void addOutlines(std::uint32_t serial, const std::vector<Look>& looks);
  /// A pixel that looks ended on the robot in, one after another: the nearest.
  struct RobotPixel {
    int row = 0, column = 0;
    float distance = std::numeric_limits<float>::max();
  };
  /// @param before and after it: what is beside them, too, is left to the nearer one.
  void addOutline(const RobotPixel& before, const RobotPixel& at, const RobotPixel& after,
                  std::uint32_t serial);
  void addOutline(std::size_t beside, float distance, std::uint32_t serial);
  void addLines(std::uint32_t serial, const std::vector<Look>& looks, std::uint32_t outline_scans);
  void beginBand(const std::vector<Look>& looks);
  void widenBand(const Vector3& viewpoint, const Vector3& direction);
  void finishBand();
  [[nodiscard]] bool sees(const Line& line, const Vector3& p_fixed, double short_m) const;

  DirectionGrid grid_;
  double angle_;
  double cosine_;
  // The last scan's directions lie near a plane: those along normal_ are at most this long.
  Vector3 normal_ = Vector3::Zero();
  double band_ = 1.0;
  bool has_band_ = false;
  Vector3 viewpoint_ = Vector3::Zero();  ///< of one of its looks
  double swing_ = 0.0;                   ///< of the others about it, squared [m2]
  /// The same, with room for roundings: what is seen from the viewpoint lies within the swing [m]
  /// of directions that are at most so far from the plane.
  struct Last {
    /// Without a branch, so that several are compared at once. True for NaN.
    [[nodiscard]] bool mayHave(float x, float y, float z) const {
      const float dx = x - viewpoint.x(), dy = y - viewpoint.y(), dz = z - viewpoint.z();
      const float beyond = std::abs(dx * normal.x() + dy * normal.y() + dz * normal.z()) - swing;
      const bool is_beyond = beyond * beyond > sine * sine * (dx * dx + dy * dy + dz * dz);
      return !(is_beyond & (beyond > 0.0F));
    }
    Eigen::Vector3f viewpoint = Eigen::Vector3f::Zero();
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    float swing = 0.0F;
    float sine = 1.0F;
  };
  Last last_;
  IndexSet looked_;                ///< the directions that the last scan has lines in
  DirectionGrid::Around looking_;  ///< at a place: a pixel is as large as the angle
  DirectionGrid::Around beside_;   ///< the robot
  std::vector<Line> lines_;
  std::vector<std::uint32_t> serials_;  ///< of the lines' scans, apart: most lines are too old
  std::vector<Outline> outlines_;
};

}  // namespace tccm
