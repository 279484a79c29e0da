#pragma once

#include <cstddef>
#include <vector>

namespace tccm {

/// A way through joint space: straight between points at rising times. Keeps its memory when it is
/// cleared.
class JointPath {
 public:
  /// @param variables how many a point has.
  explicit JointPath(std::size_t variables) : variables_(variables) {}

  void clear();
  void reserve(std::size_t points);
  /// @param time_s not before that of the point before. @param positions [rad or m]
  void add(double time_s, const std::vector<double>& positions);

  [[nodiscard]] std::size_t size() const { return times_.size(); }
  [[nodiscard]] bool empty() const { return times_.empty(); }
  [[nodiscard]] double time(std::size_t point) const { return times_[point]; }
  [[nodiscard]] double begin() const { return times_.front(); }
  [[nodiscard]] double end() const { return times_.back(); }
  [[nodiscard]] std::size_t variables() const { return variables_; }

  /// The positions at an instant; beyond the ends those of the ends. @pre not empty
  void positionsAt(double time_s, std::vector<double>& positions) const;
  /// How far each variable travels, there and back added up, from the path's begin to an instant.
  /// @pre not empty
  void travelUntil(double time_s, std::vector<double>& travel) const;

 private:
  /// The last point not after an instant, and how far it is on the way to the next.
  struct Place {
    std::size_t point;
    double share;
  };
  [[nodiscard]] Place placeOf(double time_s) const;
  void interpolate(const std::vector<double>& rows, double time_s,
                   std::vector<double>& result) const;

  std::size_t variables_;
  std::vector<double> times_;
  std::vector<double> positions_;  ///< points by variables
  std::vector<double> travel_;     ///< likewise, since the first point
};

}  // namespace tccm
