#include "tccm_monitor/geometry/pose.h"

#include <algorithm>
#include <cmath>

namespace tccm {

Pose interpolate(const Pose& from, const Pose& to, double u) {
  const Eigen::Quaterniond q_from(from.linear());
  const Eigen::Quaterniond q_to(to.linear());
  Pose pose = Pose::Identity();
  pose.linear() = q_from.slerp(u, q_to).toRotationMatrix();
  pose.translation() = (1.0 - u) * from.translation() + u * to.translation();
  return pose;
}

double displacement(const Pose& from, const Pose& to, double radius_m) {
  const Eigen::Matrix3d turn = from.linear().transpose() * to.linear();
  const double angle = std::acos(std::clamp(0.5 * (turn.trace() - 1.0), -1.0, 1.0));
  return (to.translation() - from.translation()).norm() + angle * radius_m;
}

bool isRigid(const Pose& pose) {
  constexpr double kTolerance = 1e-6;
  if (!pose.matrix().allFinite()) return false;
  const Eigen::Matrix3d rotation = pose.linear();
  return (rotation * rotation.transpose()).isIdentity(kTolerance) && rotation.determinant() > 0.0;
}

bool PosePath::add(Time stamp, const Pose& pose) {
  if ((!stamps_.empty() && stamp <= stamps_.back()) || !isRigid(pose)) return false;
  stamps_.push_back(stamp);
  poses_.push_back(pose);
  return true;
}

void PosePath::clear() {
  stamps_.clear();
  poses_.clear();
  hint_ = 0;
}

bool PosePath::covers(Time first, Time last) const {
  return !stamps_.empty() && stamps_.front() <= first && last <= stamps_.back();
}

std::optional<Pose> PosePath::at(Time stamp) const {
  if (!covers(stamp, stamp)) return std::nullopt;
  if (hint_ >= stamps_.size() || stamps_[hint_] > stamp) hint_ = 0;
  while (hint_ + 1 < stamps_.size() && stamps_[hint_ + 1] <= stamp) ++hint_;
  if (stamps_[hint_] == stamp) return poses_[hint_];
  const double u =
      toSeconds(stamp - stamps_[hint_]) / toSeconds(stamps_[hint_ + 1] - stamps_[hint_]);
  return interpolate(poses_[hint_], poses_[hint_ + 1], u);
}

}  // namespace tccm
