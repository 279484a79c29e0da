#include "tccm_monitor/pose.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tccm {

Interpolation::Interpolation(const Pose& from, const Pose& to)
    : q_from_(from.linear()),
      q_to_(to.linear()),
      angle_(0.0),
      per_sine_(0.0),
      p_from_(from.translation()),
      p_to_(to.translation()) {
  double cosine = q_from_.dot(q_to_);
  if (cosine < 0.0) {
    q_to_.coeffs() = -q_to_.coeffs();
    cosine = -cosine;
  }
  if (cosine >= 1.0 - std::numeric_limits<double>::epsilon()) return;
  angle_ = std::acos(cosine);
  per_sine_ = 1.0 / std::sin(angle_);
}

Pose Interpolation::at(double u) const {
  const bool turns = angle_ > 0.0;
  const double share_from = turns ? std::sin((1.0 - u) * angle_) * per_sine_ : 1.0 - u;
  const double share_to = turns ? std::sin(u * angle_) * per_sine_ : u;
  const Eigen::Quaterniond q(share_from * q_from_.coeffs() + share_to * q_to_.coeffs());
  Pose pose = Pose::Identity();
  pose.linear() = q.toRotationMatrix();
  pose.translation() = (1.0 - u) * p_from_ + u * p_to_;
  return pose;
}

double displacement(const Pose& from, const Pose& to, double radius_m) {
  const Eigen::Matrix3d turn = from.linear().transpose() * to.linear();
  const double angle = std::acos(std::clamp(0.5 * (turn.trace() - 1.0), -1.0, 1.0));
  return (to.translation() - from.translation()).norm() + angle * radius_m;
}

bool isRigid(const Pose& pose) {
  constexpr double kTolerance = 1e-6;
  constexpr double kFurthest = 1e6;  // [m]; sums and squares of what is further end at infinity
  if (!pose.matrix().allFinite()) return false;
  if (pose.translation().cwiseAbs().maxCoeff() > kFurthest) return false;
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
  from_hint_.reset();
}

bool PosePath::covers(Time first, Time last) const {
  return !stamps_.empty() && stamps_.front() <= first && last <= stamps_.back();
}

std::optional<Pose> PosePath::at(Time stamp) const {
  if (!covers(stamp, stamp)) return std::nullopt;
  const std::size_t before = hint_;
  if (stamps_[hint_] > stamp) hint_ = 0;
  while (hint_ + 1 < stamps_.size() && stamps_[hint_ + 1] <= stamp) ++hint_;
  if (hint_ != before) from_hint_.reset();
  if (stamps_[hint_] == stamp) return poses_[hint_];
  const double u =
      toSeconds(stamp - stamps_[hint_]) / toSeconds(stamps_[hint_ + 1] - stamps_[hint_]);
  if (!from_hint_) from_hint_.emplace(poses_[hint_], poses_[hint_ + 1]);
  return from_hint_->at(u);
}

}  // namespace tccm
