#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "check/halting.h"
#include "check/pose_check.h"

namespace tccm {

/// How fast each primitive moves at most along a way. Looked at are its begin, every further fifth
/// of a radian or metre of the joint that goes furthest, and wherever the joints become faster:
/// places of the way, not instants. So who goes the same way faster is found to be faster, and by
/// as much at least.
class WaySpeeds {
 public:
  explicit WaySpeeds(const std::shared_ptr<const CheckedRobot>& robot);

  /// What a primitive does after the time for which it has to be looked along does not count.
  void find(const Way& way, const Halting& halting);

  /// The most that a point of the primitive moves at [m/s]. @param shape of the collision body.
  [[nodiscard]] double of(std::size_t shape) const { return speeds_mps_[shape]; }
  [[nodiscard]] double fastest() const { return fastest_mps_; }
  /// Whether the last find() would have had to look at more places than it may: then something may
  /// be faster than it found.
  [[nodiscard]] bool exhausted() const { return exhausted_; }
  /// At how many places the last find() looked.
  [[nodiscard]] std::size_t places() const { return places_; }

 private:
  /// A straight piece of the way.
  struct Piece {
    double begin_s;
    const double* from;
    const double* to;
    double length;  ///< of the joint that goes furthest [rad or m]
    double rate;    ///< of it [1/s]
  };
  [[nodiscard]] Piece pieceAfter(const JointPath& path, std::size_t point) const;
  /// Looks at parts of a piece, from one look to the next.
  void follow(const Way& way, const Piece& piece, const Halting& halting);
  /// Finds how far each primitive moves for each unit of the piece's length.
  void look(const Way& way, const Piece& piece, double length);
  void place(const Piece& piece, double length);
  void raise(double time_s, double rate, const Halting& halting);

  UsedBody body_;
  std::vector<double> gears_;  ///< by variable: what turns or slides furthest for each unit of it
  Kinematics kinematics_;
  std::vector<double> radii_m_;
  std::vector<double> speeds_mps_;
  double fastest_mps_ = 0.0;
  std::vector<double> per_length_;  ///< as the last look() found it
  double length_ = 0.0;             ///< of the way so far
  double next_look_ = 0.0;          ///< length at which it is looked again at the latest
  double looked_rate_ = 0.0, most_rate_ = 0.0;  ///< since then
  std::size_t places_ = 0;
  bool exhausted_ = false;
  std::vector<double> positions_;  ///< reused
};

}  // namespace tccm
