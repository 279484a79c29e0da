#include "fit/directions.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <set>

namespace tccm {

std::vector<Vector3> hemisphereDirections(int count) {
  const double golden_angle = M_PI * (3.0 - std::sqrt(5.0));
  std::vector<Vector3> directions;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (i + 0.5) / count;
    const double across = std::sqrt(1.0 - z * z);
    directions.emplace_back(across * std::cos(i * golden_angle),
                            across * std::sin(i * golden_angle), z);
  }
  return directions;
}

Eigen::Matrix3d principalAxes(const std::vector<Vector3>& points) {
  Vector3 mean = Vector3::Zero();
  for (const Vector3& p : points) mean += p / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vector3& p : points) spread += (p - mean) * (p - mean).transpose();
  const double scale = spread.trace();
  if (!(scale > 0.0)) return Eigen::Matrix3d::Identity();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread / scale);
  Eigen::Matrix3d axes = solver.eigenvectors().rowwise().reverse();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

Eigen::Matrix3d axesAbout(const Vector3& z) {
  int across = 0;
  z.cwiseAbs().minCoeff(&across);
  Eigen::Matrix3d axes;
  axes.col(2) = z;
  axes.col(0) = Vector3::Unit(across).cross(z).normalized();
  axes.col(1) = z.cross(axes.col(0));
  return axes;
}

void addIfDifferent(std::vector<Vector3>& directions, const Vector3& direction,
                    double least_angle) {
  const double cosine = std::cos(least_angle);
  const auto same = [&](const Vector3& d) { return std::abs(d.dot(direction)) > cosine; };
  if (std::none_of(directions.begin(), directions.end(), same)) directions.push_back(direction);
}

ExtremePoints::ExtremePoints(int directions) : directions_(directions, 3) {
  Eigen::Index row = 0;
  for (const Vector3& direction : hemisphereDirections(directions)) {
    directions_.row(row++) = direction.transpose();
  }
}

std::vector<Vector3> ExtremePoints::of(const std::vector<Vector3>& points) const {
  if (static_cast<Eigen::Index>(points.size()) <= 2 * directions_.rows()) return points;
  const Eigen::Map<const Matrix3X> all(points.front().data(), 3,
                                       static_cast<Eigen::Index>(points.size()));
  std::set<Eigen::Index> chosen;
  Eigen::RowVectorXd heights(all.cols());
  for (Eigen::Index i = 0; i < directions_.rows(); ++i) {
    heights.noalias() = directions_.row(i) * all;
    Eigen::Index lowest = 0;
    Eigen::Index highest = 0;
    heights.minCoeff(&lowest);
    heights.maxCoeff(&highest);
    chosen.insert({lowest, highest});
  }
  std::vector<Vector3> extreme;
  for (const Eigen::Index i : chosen) extreme.push_back(points[static_cast<std::size_t>(i)]);
  return extreme;
}

}  // namespace tccm
