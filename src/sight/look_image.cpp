#include "tccm_monitor/look_image.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "sight/look.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

/// Pixels; a thing as large as a hand shows in directions beside that of its middle.
constexpr double kNeighbours = 1.0;
constexpr LookImage::Ticks kSameStroke = 100;  // [ms] between passes in neighbouring directions
constexpr LookImage::Ticks kFrames = 100;      // [ms]; less between passes: a camera's frames

bool isClear(const LookImage::Pass& pass) {
  return pass.end != Seen::kNever && pass.end != Seen::kUnclear;
}

/// Whether a pass saw the place itself; what the robot ends on hides all that is behind it.
bool reached(const LookImage::Pass& pass, double range_m, double margin_m) {
  return isClear(pass) && pass.range() >= (pass.end == Seen::kRobot ? range_m : range_m - margin_m);
}

double validated(double resolution_rad) {
  requireInRange("look_resolution_rad", resolution_rad, 0.01, 0.2);
  return resolution_rad;
}

}  // namespace

LookImage::LookImage(double resolution_rad)
    : grid_(validated(resolution_rad)),
      passes_(grid_.pixels()),
      edits_((grid_.pixels() + kBlock - 1) / kBlock, 0),
      row_begin_(grid_.rows()) {}

std::uint64_t LookImage::EditNumbers::fresh() {
  static std::atomic<std::uint32_t> ranges{0};
  return (std::uint64_t{++ranges} << 32U) + 1;
}

LookImage::Sight LookImage::at(const Vector3& p_fixed, double margin_m) const {
  const Vector3 sight = p_fixed - viewpoint_;
  const double range = sight.norm();
  if (!(range > kNearestLook)) return {Sight::Kind::kNeverLooked, epoch_};
  return at(grid_.pixelOf(sight), range, margin_m);
}

LookImage::Sight LookImage::at(std::size_t pixel, double range_m, double margin_m) const {
  Sight sight{Sight::Kind::kNeverLooked, epoch_};
  const Passes& passes = passes_[pixel];
  const bool is_regular = std::all_of(passes.begin(), passes.end(), [](const Pass& pass) {
    return pass.end != Seen::kNever && !pass.moved;
  });
  if (is_regular) sight.looked = timeOf(passes.front().last);
  for (const Pass& pass : passes) {
    if (pass.end == Seen::kNever) break;
    const bool reaches = pass.range() >= range_m - margin_m;
    const bool is_clear = pass.end != Seen::kUnclear;
    if (is_clear && (reaches || pass.end != Seen::kRobot)) {
      sight.kind = reaches ? Sight::Kind::kSeen : Sight::Kind::kBehind;
      sight.stamp = timeOf(pass.last);
      return sight;
    }
    if (sight.kind == Sight::Kind::kUnclear) continue;
    sight.kind = Sight::Kind::kUnclear;
    sight.stamp = timeOf(pass.last);
  }
  return sight;
}

bool LookImage::reachedSince(Time since, std::size_t pixel, double range_m) const {
  const Passes& passes = passes_[pixel];
  return std::any_of(passes.begin(), passes.end(), [&](const Pass& pass) {
    return isClear(pass) && timeOf(pass.first) > since && pass.range() >= range_m;
  });
}

bool LookImage::inViewSince(Time since, const Vector3& p_fixed, double margin_m) const {
  const Vector3 sight = p_fixed - viewpoint_;
  const double range = sight.norm();
  if (!(range > kNearestLook)) return false;
  const std::size_t pixel = grid_.pixelOf(sight);
  const int row = grid_.rowOfPixel(pixel), column = grid_.columnOfPixel(pixel, row);
  if (row <= row_begin_ || row + 1 >= row_end_) return false;
  const auto reached = [&](int r, int c) {
    return reachedSince(since, grid_.index(r, grid_.wrapped(c)), range - margin_m);
  };
  return reached(row, column) && reached(row, column - 1) && reached(row, column + 1) &&
         reached(row - 1, column) && reached(row + 1, column);
}

Time LookImage::lookedAround(const Vector3& p_fixed, double angle) const {
  const std::size_t pixel = grid_.pixelOf(p_fixed - viewpoint_);
  const int middle_row = grid_.rowOfPixel(pixel);
  const int middle = grid_.columnOfPixel(pixel, middle_row);
  const int rows = static_cast<int>(std::ceil(angle / grid_.resolution()));
  Ticks newest = 0;
  for (int row = std::max(row_begin_, middle_row - rows);
       row < std::min(row_end_, middle_row + rows + 1); ++row) {
    const int reach = grid_.columnsWithin(row, angle);
    for (int c = middle - reach; c <= middle + reach; ++c) {
      const Pass& pass = passes_[grid_.index(row, grid_.wrapped(c))].front();
      if (pass.end != Seen::kNever && !pass.moved) newest = std::max(newest, pass.last);
    }
  }
  return timeOf(newest);
}

template <typename Visit>
void LookImage::visitSeen(const Vector3& p_fixed, double margin_m, Visit&& visit) const {
  const Vector3 sight = p_fixed - viewpoint_;
  const double range = sight.norm();
  if (!(range > kNearestLook)) return;
  const std::size_t pixel = grid_.pixelOf(sight);
  const int row = grid_.rowOfPixel(pixel), column = grid_.columnOfPixel(pixel, row);
  const double along_least = range * std::cos(kNeighbours * grid_.resolution());
  const auto reachedWith = [&](const Pass& own, int r, int c) {
    if (r < row_begin_ || r >= row_end_) return false;
    const std::size_t near = grid_.index(r, grid_.wrapped(c));
    if (grid_.middle(near).dot(sight) < along_least) return false;
    return std::any_of(passes_[near].begin(), passes_[near].end(), [&](const Pass& pass) {
      return reached(pass, range, margin_m) && pass.first <= own.last + kSameStroke &&
             own.first <= pass.last + kSameStroke;
    });
  };
  // A frame looks in each direction itself.
  const bool asks_beside = !betweenFrames(p_fixed);
  for (const Pass& own : passes_[pixel]) {
    if (own.end == Seen::kNever) return;
    const bool is_seen =
        reached(own, range, margin_m) ||
        (asks_beside && (reachedWith(own, row, column - 1) || reachedWith(own, row, column + 1) ||
                         reachedWith(own, row - 1, column) || reachedWith(own, row + 1, column)));
    if (is_seen) visit(own);
  }
}

std::optional<Duration> LookImage::betweenFrames(const Vector3& p_fixed) const {
  const Vector3 sight = p_fixed - viewpoint_;
  if (!(sight.norm() > kNearestLook)) return std::nullopt;
  const Passes& passes = passes_[grid_.pixelOf(sight)];
  if (passes.back().end == Seen::kNever) return std::nullopt;
  const Ticks between = passes.front().first - passes.back().first;
  if (between == 0 || between >= kFrames) return std::nullopt;
  return std::chrono::milliseconds(between);
}

bool LookImage::passedSince(Time since, const Vector3& p_fixed, double margin_m) const {
  bool passed = false;
  visitSeen(p_fixed, margin_m,
            [&](const Pass& pass) { passed = passed || timeOf(pass.first) > since; });
  return passed;
}

std::optional<Time> LookImage::nextLook(const Vector3& p_fixed, double margin_m, Time now,
                                        Duration period, Duration late_max) const {
  const std::optional<Duration> frame = betweenFrames(p_fixed);
  const Duration again = std::min(period, frame.value_or(period));
  const Time newest =
      frame ? timeOf(passes_[grid_.pixelOf(p_fixed - viewpoint_)].front().first) : Time{};
  std::optional<Time> next;
  visitSeen(p_fixed, margin_m, [&](const Pass& pass) {
    const Time due = timeOf(pass.first) + again;
    // A frame after the one before the newest came the newest, which did not see the place.
    if (frame && due <= newest) return;
    if (due >= now - late_max && (!next || due < *next)) next = due;
  });
  return next;
}

void LookImage::clear() {
  for (std::size_t block = 0; block < edits_.size(); ++block) {
    if (edits_[block] == 0) continue;
    edits_[block] = 0;
    const std::size_t begin = block * kBlock;
    std::fill_n(&passes_[begin], std::min(kBlock, passes_.size() - begin), Passes());
  }
  row_begin_ = grid_.rows();
  row_end_ = 0;
}

void LookImage::begin(Time epoch, const Vector3& viewpoint) {
  clear();
  epoch_ = epoch;
  viewpoint_ = viewpoint;
}

void LookImage::copyFrom(const LookImage& other) {
  if (grid_.rows() != other.grid_.rows()) {
    *this = other;
    return;
  }
  for (std::size_t block = 0; block < edits_.size(); ++block) {
    if (edits_[block] == other.edits_[block]) continue;
    edits_[block] = other.edits_[block];
    const std::size_t begin = block * kBlock;
    std::copy_n(&other.passes_[begin], std::min(kBlock, passes_.size() - begin), &passes_[begin]);
  }
  epoch_ = other.epoch_;
  viewpoint_ = other.viewpoint_;
  row_begin_ = other.row_begin_;
  row_end_ = other.row_end_;
}

}  // namespace tccm
