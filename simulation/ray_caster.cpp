#include "simulation/ray_caster.h"

#include <algorithm>
#include <cassert>

namespace tccm::simulation {

RayCaster::RayCaster(const Snapshot& snapshot)
    : sensor_(snapshot.T_fixed_sensor.translation()),
      normal_(snapshot.T_fixed_sensor.linear().col(2)) {
  for (std::size_t i = 0; i < snapshot.targets.shapes.size(); ++i) {
    const Pose& T_fixed_shape = snapshot.targets.poses[i];
    const Pose T_shape_fixed = T_fixed_shape.inverse();
    if (distance(snapshot.targets.shapes[i], T_shape_fixed * sensor_) == 0.0) continue;
    targets_.push_back({snapshot.targets.shapes[i], T_shape_fixed, T_fixed_shape.translation(),
                        boundingRadius(snapshot.targets.shapes[i]), snapshot.labels[i]});
    all_.push_back(all_.size());
    if (meetsScanPlane(targets_.back())) near_plane_.push_back(all_.back());
  }
}

void RayCaster::aim(const Ray& axis, double angle) {
  const double spread = std::tan(angle);
  aimed_at_.clear();
  for (const std::size_t i : isNearPlane(axis, spread) ? near_plane_ : all_) {
    const Target& target = targets_[i];
    const Vector3 to_centre = target.centre - axis.origin;
    const double along = to_centre.dot(axis.direction);
    const double reach = target.radius + spread * (std::abs(along) + target.radius);
    const double across_squared = to_centre.squaredNorm() - along * along;
    if (along >= -target.radius - reach && across_squared <= reach * reach + kTiny) {
      aimed_at_.push_back(i);
    }
  }
}

Hit RayCaster::cast(const Ray& ray, double range_max) const {
  Hit nearest;
  for (const std::size_t i : aimed_at_) {
    const Target& target = targets_[i];
    const Vector3 to_centre = target.centre - ray.origin;
    const double along = to_centre.dot(ray.direction);
    const double across_squared = to_centre.squaredNorm() - along * along;
    if (along < -target.radius || across_squared > target.radius * target.radius) continue;
    const std::optional<LineSpan> span =
        intersect(target.shape, transformed(ray, target.T_shape_fixed));
    if (span && span->enter < nearest.range && span->enter <= range_max) {
      nearest = {span->enter, i, target.label};
    }
  }
  return nearest;
}

bool RayCaster::isNearPlane(const Ray& axis, double spread) const {
  return (axis.origin - sensor_).norm() <= kAside &&
         std::abs(normal_.dot(axis.direction)) + spread <= kSlope;
}

bool RayCaster::meetsScanPlane(const Target& target) const {
  const Vector3 to_centre = target.centre - sensor_;
  const double length_max = to_centre.norm() + target.radius + kAside;
  return std::abs(normal_.dot(to_centre)) <= target.radius + kAside + kSlope * length_max;
}

MovingScene::MovingScene(const std::vector<Snapshot>& snapshots)
    : snapshots_(snapshots), casters_(snapshots.size()) {
  for (const Snapshot& snapshot : snapshots) {
    T_fixed_sensor_.add(snapshot.stamp, snapshot.T_fixed_sensor);
  }
}

Pose MovingScene::sensorAt(Time stamp) const {
  const std::optional<Pose> pose = T_fixed_sensor_.at(stamp);
  assert(pose);
  return *pose;
}

RayCaster& MovingScene::casterAt(Time stamp) {
  const std::size_t index = nearestTo(stamp);
  if (!casters_[index]) casters_[index].emplace(snapshots_[index]);
  return *casters_[index];
}

std::size_t MovingScene::nearestTo(Time stamp) const {
  const auto later = std::find_if(snapshots_.begin(), snapshots_.end(),
                                  [&](const Snapshot& s) { return s.stamp >= stamp; });
  auto index = static_cast<std::size_t>(later - snapshots_.begin());
  if (index == snapshots_.size()) return index - 1;
  if (index > 0 && stamp - snapshots_[index - 1].stamp < later->stamp - stamp) --index;
  return index;
}

}  // namespace tccm::simulation
