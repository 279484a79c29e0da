#include "floor.h"

#include <pcl/ModelCoefficients.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/segmentation/sac_segmentation.h>

#include <algorithm>
#include <cmath>

namespace tccm {
namespace {

constexpr double kBelow = 0.25;  // [m] from the robot's bottom: wheels, and what is not modelled
constexpr double kAbove = 0.15;  // [m]: it sinks in, or leans
constexpr double kThickness = 0.03;  // [m] of what belongs to the plane
constexpr float kWidthMin = 0.6F;    // [m] both ways
constexpr float kAround = 0.1F;      // [m] above and below it
constexpr double kTilt = 0.1;        // [rad] that the fixed frame may lean
constexpr std::size_t kPointsMin = 200;

}  // namespace

std::optional<Floor> findFloor(const std::vector<Vector3>& points, double robot_bottom_m) {
  const auto near = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  for (const Vector3& p : points) {
    if (p.z() < robot_bottom_m - kBelow || p.z() > robot_bottom_m + kAbove) continue;
    const Eigen::Vector3f single = p.cast<float>();
    near->push_back({single.x(), single.y(), single.z()});
  }
  if (near->size() < kPointsMin) return std::nullopt;
  pcl::SACSegmentation<pcl::PointXYZ> segmentation(false);  // the same for the same points
  segmentation.setModelType(pcl::SACMODEL_PERPENDICULAR_PLANE);
  segmentation.setAxis(Eigen::Vector3f::UnitZ());
  segmentation.setEpsAngle(kTilt);
  segmentation.setMethodType(pcl::SAC_RANSAC);
  segmentation.setDistanceThreshold(kThickness);
  segmentation.setInputCloud(near);
  pcl::PointIndices inliers;
  pcl::ModelCoefficients plane;
  segmentation.segment(inliers, plane);
  if (inliers.indices.size() < kPointsMin) return std::nullopt;
  Eigen::AlignedBox2f wide;
  for (const int index : inliers.indices) {
    wide.extend((*near)[static_cast<std::size_t>(index)].getVector3fMap().head<2>());
  }
  if (wide.sizes().minCoeff() < kWidthMin) return std::nullopt;  // the top of something
  const auto heightAt = [&plane](const pcl::PointXYZ& p) {
    return -(plane.values[0] * p.x + plane.values[1] * p.y + plane.values[3]) / plane.values[2];
  };
  const auto isAround = [&](const pcl::PointXYZ& p) {
    return std::abs(p.z - heightAt(p)) < kAround;
  };
  const auto around = static_cast<std::size_t>(std::count_if(near->begin(), near->end(), isAround));
  if (2 * inliers.indices.size() < around)
    return std::nullopt;  // walls have as many at all heights
  Floor floor;
  floor.points = inliers.indices.size();
  floor.highest_m = -INFINITY;
  double squares = 0.0;
  for (const int index : inliers.indices) {
    const pcl::PointXYZ& p = (*near)[static_cast<std::size_t>(index)];
    const double height = heightAt(p);
    floor.highest_m = std::max(floor.highest_m, height);
    squares += (p.z - height) * (p.z - height);
  }
  floor.noise_m = std::sqrt(squares / static_cast<double>(floor.points));
  return floor;
}

}  // namespace tccm
