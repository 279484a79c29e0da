#include "check/way_speeds.h"

#include <algorithm>
#include <cmath>

namespace tccm {
namespace {

constexpr double kLookEach = 0.2;  // [rad or m] of the joint that goes furthest
constexpr double kFaster = 1.5;    // times as fast as when it was looked at last
constexpr std::size_t kPlacesMax = 256;
constexpr double kDifferent = 1e-3;  // [rad or m] between two poses that are differentiated

/// Between two poses that are almost the same [rad].
double angleBetween(const Pose& from, const Pose& to) {
  const Eigen::Matrix3d turn = from.linear().transpose() * to.linear();
  const Vector3 sine(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1));
  return std::atan2(0.5 * sine.norm(), 0.5 * (turn.trace() - 1.0));
}

}  // namespace

WaySpeeds::WaySpeeds(const std::shared_ptr<const CheckedRobot>& robot)
    : body_(robot->collision_body),
      gears_(robot->model->variables().size(), 0.0),
      kinematics_(robot->model),
      radii_m_(body_.radii(0.0)),
      speeds_mps_(body_.shapes.size(), 0.0),
      per_length_(body_.shapes.size(), 0.0),
      positions_(robot->model->variables().size()) {
  for (const RobotJoint& joint : robot->model->joints()) {
    if (joint.motion == RobotJoint::Motion::kFixed) continue;
    gears_[joint.variable] = std::max(gears_[joint.variable], std::abs(joint.multiplier));
  }
}

WaySpeeds::Piece WaySpeeds::pieceAfter(const JointPath& path, std::size_t point) const {
  Piece piece{path.time(point), path.positions(point), path.positions(point + 1), 0.0, 0.0};
  for (std::size_t v = 0; v < path.variables(); ++v) {
    piece.length = std::max(piece.length, gears_[v] * std::abs(piece.to[v] - piece.from[v]));
  }
  const double seconds = path.time(point + 1) - path.time(point);
  if (seconds > 0.0) piece.rate = piece.length / seconds;
  return piece;
}

void WaySpeeds::find(const Way& way, const Halting& halting) {
  std::fill(speeds_mps_.begin(), speeds_mps_.end(), 0.0);
  fastest_mps_ = 0.0;
  length_ = next_look_ = looked_rate_ = most_rate_ = 0.0;
  places_ = 0;
  exhausted_ = false;
  for (std::size_t point = 0; point + 1 < way.path.size(); ++point) {
    const Piece piece = pieceAfter(way.path, point);
    if (piece.begin_s >= halting.lookTime(fastest_mps_)) return;
    if (piece.rate > 0.0) follow(way, piece, halting);
    if (exhausted_) return;
  }
}

void WaySpeeds::follow(const Way& way, const Piece& piece, const Halting& halting) {
  double done = 0.0;
  while (done < piece.length) {
    if (length_ >= next_look_) {
      next_look_ += kLookEach;
      looked_rate_ = most_rate_ = 0.0;
    }
    const double time_s = piece.begin_s + done / piece.rate;
    if (time_s >= halting.lookTime(fastest_mps_)) return;
    if (piece.rate > kFaster * looked_rate_) {
      exhausted_ = places_ == kPlacesMax;
      if (exhausted_) return;
      look(way, piece, done);
      looked_rate_ = piece.rate;
    }
    if (piece.rate > most_rate_) {
      most_rate_ = piece.rate;
      raise(time_s, piece.rate, halting);
    }
    const double left = piece.length - done, until_look = next_look_ - length_;
    done = left <= until_look ? piece.length : done + until_look;
    length_ = left <= until_look ? length_ + left : next_look_;
  }
}

void WaySpeeds::place(const Piece& piece, double length) {
  const double share = length / piece.length;
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    positions_[v] = piece.from[v] + share * (piece.to[v] - piece.from[v]);
  }
}

void WaySpeeds::look(const Way& way, const Piece& piece, double length) {
  ++places_;
  place(piece, length);
  body_.place(kinematics_.update(positions_, way.T_fixed_roots));
  place(piece, length + kDifferent);
  const std::vector<Pose>& poses = kinematics_.update(positions_, way.T_fixed_roots).T_fixed_shapes;
  for (std::size_t i = 0; i < body_.shapes.size(); ++i) {
    const Pose& from = body_.body.poses[i];
    const Pose& to = poses[body_.shapes[i]];
    const double moved = (to.translation() - from.translation()).norm();
    per_length_[i] = (moved + radii_m_[i] * angleBetween(from, to)) / kDifferent;
  }
}

void WaySpeeds::raise(double time_s, double rate, const Halting& halting) {
  for (std::size_t i = 0; i < speeds_mps_.size(); ++i) {
    if (time_s >= halting.lookTime(speeds_mps_[i])) continue;
    speeds_mps_[i] = std::max(speeds_mps_[i], rate * per_length_[i]);
    fastest_mps_ = std::max(fastest_mps_, speeds_mps_[i]);
  }
}

}  // namespace tccm
