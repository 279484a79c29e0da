#include "robot/path_cursor.h"

#include <algorithm>

namespace tccm {
namespace {

constexpr double kJump = 1e-6;  // [s]; a motion that is as short cannot be followed

}  // namespace

double PathCursor::metresAt(std::size_t point) const {
  const double* travel = path_->travel(point);
  double sum = 0.0;
  for (std::size_t v = 0; v < path_->variables(); ++v) sum += arms_[v] * travel[v];
  return sum;
}

void PathCursor::start(const JointPath& path, const double* arms) {
  path_ = &path;
  arms_ = arms;
  point_ = 0;
  before_m_ = 0.0;
  after_m_ = path.size() > 1 ? metresAt(1) : 0.0;
  time_s_ = path.begin();
  jump_m_ = 0.0;
  positions_.assign(path.positions(0), path.positions(0) + path.variables());
}

void PathCursor::noteJump() {
  const bool is_jump = path_->time(point_ + 1) - path_->time(point_) < kJump;
  if (is_jump) jump_m_ = std::max(jump_m_, after_m_ - before_m_);
}

bool PathCursor::moveTo(double metres) {
  if (metres < before_m_ || metres <= 0.0) start(*path_, arms_);
  if (metres <= 0.0) return true;
  jump_m_ = 0.0;
  while (after_m_ < metres) {
    if (point_ + 2 >= path_->size()) return false;
    noteJump();
    ++point_;
    before_m_ = after_m_;
    after_m_ = metresAt(point_ + 1);
  }
  noteJump();
  const double share = (metres - before_m_) / (after_m_ - before_m_);
  const double* from = path_->positions(point_);
  const double* to = path_->positions(point_ + 1);
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    positions_[v] = from[v] + share * (to[v] - from[v]);
  }
  time_s_ = path_->time(point_) + share * (path_->time(point_ + 1) - path_->time(point_));
  return true;
}

double PathCursor::metresUntil(double time_s) const {
  std::size_t point = 0;
  while (point + 1 < path_->size() && path_->time(point + 1) <= time_s) ++point;
  const double before = metresAt(point);
  if (point + 1 == path_->size() || time_s <= path_->time(point)) return before;
  const double share =
      (time_s - path_->time(point)) / (path_->time(point + 1) - path_->time(point));
  return before + share * (metresAt(point + 1) - before);
}

}  // namespace tccm
