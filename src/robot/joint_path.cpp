#include "robot/joint_path.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace tccm {

void JointPath::clear() {
  times_.clear();
  positions_.clear();
  travel_.clear();
}

void JointPath::reserve(std::size_t points) {
  times_.reserve(points);
  positions_.reserve(points * variables_);
  travel_.reserve(points * variables_);
}

void JointPath::add(double time_s, const std::vector<double>& positions) {
  assert(positions.size() == variables_);
  assert(times_.empty() || time_s >= times_.back());
  const std::size_t last = positions_.size() - (times_.empty() ? 0 : variables_);
  for (std::size_t v = 0; v < variables_; ++v) {
    travel_.push_back(
        times_.empty() ? 0.0 : travel_[last + v] + std::abs(positions[v] - positions_[last + v]));
  }
  positions_.insert(positions_.end(), positions.begin(), positions.end());
  times_.push_back(time_s);
}

JointPath::Place JointPath::placeOf(double time_s) const {
  const auto after = std::upper_bound(times_.begin(), times_.end(), time_s);
  if (after == times_.begin()) return {0, 0.0};
  const auto point = static_cast<std::size_t>(after - times_.begin()) - 1;
  if (after == times_.end()) return {point, 0.0};
  return {point, (time_s - times_[point]) / (times_[point + 1] - times_[point])};
}

void JointPath::interpolate(const std::vector<double>& rows, double time_s,
                            std::vector<double>& result) const {
  const Place place = placeOf(time_s);
  result.resize(variables_);
  const double* row = rows.data() + place.point * variables_;
  if (place.share == 0.0) {
    std::copy_n(row, variables_, result.begin());
    return;
  }
  const double* next = row + variables_;
  for (std::size_t v = 0; v < variables_; ++v)
    result[v] = row[v] + place.share * (next[v] - row[v]);
}

void JointPath::positionsAt(double time_s, std::vector<double>& positions) const {
  interpolate(positions_, time_s, positions);
}

void JointPath::travelUntil(double time_s, std::vector<double>& travel) const {
  interpolate(travel_, time_s, travel);
}

}  // namespace tccm
