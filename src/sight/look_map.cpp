#include "sight/look_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr double kMeanShare = 0.02;  // of the newest scan in the mean viewpoint
constexpr double kJump = 0.05;       // [m] beyond that a sensor does not swing, it drives
constexpr double kMoveMax = 0.01;    // [m] of the mean, before directions are taken from there
constexpr double kRounding = 1e-9;   // of a cosine; plenty
constexpr float kElsewhere = 0.25F;  // [m]; a head that turns moves its sensor by less
constexpr Duration kLongest = std::chrono::hours(24 * 24);  // that milliseconds are counted for

/// A look that is unclear counts only where no other does.
double handicap(Seen end) { return end == Seen::kUnclear ? 2.0 : 0.0; }

LookImage::Ticks toTicks(Duration duration) {
  return static_cast<LookImage::Ticks>(
      std::chrono::duration_cast<std::chrono::milliseconds>(duration).count());
}

/// Rounded down: what is not sure to have been seen was not. @param metres above 0.
std::uint16_t toMillimetres(double metres) {
  constexpr double kMost = std::numeric_limits<std::uint16_t>::max();
  return static_cast<std::uint16_t>(std::min(kMost, 1e3 * metres));
}

}  // namespace

void LookMap::Config::describe(ParameterTable& table) {
  table.add("look_resolution_rad", &resolution_rad, "rad", {0.01, 0.2},
            "edge of a pixel of the image of where the sensor looked");
  table.add("look_spread_rad", &spread_rad, "rad", {0.001, 0.2},
            "a beam speaks for the directions within it: at least half of what scans are apart");
  table.add("look_pass_gap_s", &pass_gap_s, "s", {0.001, 10.0},
            "looks in one direction that are further apart are two passes; each cloud is one");
}

LookMap::LookMap(const Config& config)
    : config_(validated(config)),
      image_(config.resolution_rad),
      spread_cosine_(std::cos(config.spread_rad)),
      spread_(image_.grid().around(config.spread_rad)),
      pass_gap_(toTicks(fromSeconds(config.pass_gap_s))),
      aims_(image_.grid().pixels()),
      changed_(image_.grid().pixels()),
      old_image_(config.resolution_rad),
      old_aims_(image_.grid().pixels()) {}

void LookMap::clear() {
  image_.clear();
  std::fill(aims_.begin(), aims_.end(), Aims());
  started_ = false;
}

void LookMap::add(Time stamp, const std::vector<Look>& looks, bool is_pass) {
  changed_.clear();
  if (looks.empty()) return;
  gap_ = is_pass ? 0 : pass_gap_;
  const Vector3& viewpoint = looks[looks.size() / 2].viewpoint;
  if (!started_ || stamp - image_.epoch() > kLongest) {
    clear();
    image_.begin(stamp, viewpoint);
    mean_viewpoint_ = viewpoint;
    started_ = true;
  }
  follow(viewpoint);
  const Ticks now = toTicks(stamp - image_.epoch());
  // Neighbouring beams are nearer to each other than pixels: of those that follow one another in a
  // pixel the one nearest to its middle speaks.
  PixelFollower follower(image_.grid());
  Beam best, beam;
  bool has_best = false;
  for (const Look& look : looks) {
    if (!aimAt(look.end, look.what, follower, beam)) continue;
    const bool is_elsewhere = has_best && best.pixel != beam.pixel;
    if (is_elsewhere) note(best, now);
    if (!has_best || is_elsewhere || beam.aim > best.aim) best = beam;
    has_best = true;
  }
  if (has_best) note(best, now);
}

void LookMap::follow(const Vector3& viewpoint) {
  mean_viewpoint_ += kMeanShare * (viewpoint - mean_viewpoint_);
  if ((viewpoint - mean_viewpoint_).norm() > kJump) mean_viewpoint_ = viewpoint;
  if ((mean_viewpoint_ - image_.viewpoint()).norm() > kMoveMax) moveTo(mean_viewpoint_);
}

bool LookMap::aimAt(const Vector3& end, Seen what, PixelFollower& follower, Beam& beam) const {
  const Vector3 sight = end - image_.viewpoint();
  const double range = sight.norm();
  if (!(range > kNearestLook)) return false;  // NaN, too
  follower.follow(sight);
  beam.end = end;
  beam.direction = sight / range;
  beam.range = range;
  beam.what = what;
  beam.pixel = follower.pixel();
  beam.aim = follower.middle().dot(beam.direction) - handicap(what);
  return true;
}

/// From its own column on to either side they come further from it.
template <typename Note>
void LookMap::spread(const Beam& beam, Note&& note) const {
  const DirectionGrid& grid = image_.grid();
  const Eigen::Vector2d across = beam.direction.head<2>();
  const double up = beam.direction.z(), level = across.norm(), less = handicap(beam.what);
  const int middle_row = grid.rowOfPixel(beam.pixel);
  const int middle = grid.columnOfPixel(beam.pixel, middle_row);
  const int last = std::min(grid.rows() - 1, middle_row + spread_.rows);
  for (int row = std::max(0, middle_row - spread_.rows); row <= last; ++row) {
    const double share_up = grid.sine(row) * up, share_across = grid.cosine(row);
    // Most rows beside its own are too far from it.
    if (share_up + share_across * level < spread_cosine_ - kRounding) continue;
    const auto notes = [&](int column) {
      const double cosine = share_up + share_across * grid.columnMiddle(column).dot(across);
      if (cosine >= spread_cosine_) note(row, column, static_cast<float>(cosine - less));
      return cosine >= spread_cosine_;
    };
    if (!notes(middle)) continue;
    const int reach = spread_.columns[static_cast<std::size_t>(row)];
    for (const int side : {-1, 1}) {
      for (int c = 1; c <= reach; ++c) {
        if (!notes(grid.wrapped(middle + side * c))) break;
      }
    }
  }
}

void LookMap::note(const Beam& beam, Ticks now) {
  const Pass pass{now, now, toMillimetres(beam.range), beam.what};
  const Aim aimed{beam.end.cast<float>(), 0.0F, now, image_.viewpoint().cast<float>()};
  spread(beam, [&](int row, int column, float aim) {
    Aim at_pixel = aimed;
    at_pixel.aim = aim;
    note(row, column, pass, at_pixel);
  });
}

void LookMap::note(int row, int column, Pass newest, const Aim& aimed) {
  LookImage::Passes& passes = image_.edit(row, column);
  const std::size_t pixel = image_.grid().index(row, column);
  Aims& aims = aims_[pixel];
  const Ticks now = newest.last;
  const bool is_new = passes[0].end == Seen::kNever || now - passes[0].last > gap_;
  if (is_new) {
    std::move_backward(passes.begin(), passes.end() - 1, passes.end());
    std::move_backward(aims.begin(), aims.end() - 1, aims.end());
  } else {
    passes[0].last = now;
    // The best look of a long pass must not be one of long ago.
    if (aimed.aim < aims[0].aim && now - aims[0].stamp <= gap_) return;
    newest.first = passes[0].first;
  }
  changed_.insert(pixel);
  passes[0] = newest;
  aims[0] = aimed;
}

void LookMap::moveTo(const Vector3& viewpoint) {
  std::swap(image_, old_image_);
  std::swap(aims_, old_aims_);
  image_.begin(old_image_.epoch(), viewpoint);
  std::fill(aims_.begin(), aims_.end(), Aims());
  PixelFollower follower(image_.grid());
  Beam beam;
  for (int row = old_image_.rowBegin(); row < old_image_.rowEnd(); ++row) {
    for (int column = 0; column < image_.grid().columns(); ++column) {
      const std::size_t pixel = image_.grid().index(row, column);
      for (std::size_t k = 0; k < LookImage::kPasses; ++k) {
        Pass pass = old_image_.passes(pixel)[k];
        const Aim& old = old_aims_[pixel][k];
        if (pass.end == Seen::kNever) continue;
        if (!aimAt(old.end.cast<double>(), pass.end, follower, beam)) continue;
        pass.range_mm = toMillimetres(beam.range);
        spread(beam, [&](int r, int c, float aim) { noteAgain(r, c, k, pass, old, aim); });
      }
    }
  }
}

/// Passes that were the k-th newest in neighbouring directions are taken for one.
void LookMap::noteAgain(int row, int column, std::size_t k, const Pass& found, const Aim& old,
                        float aim) {
  Pass& pass = image_.edit(row, column)[k];
  Aim& best = aims_[image_.grid().index(row, column)][k];
  if (pass.end != Seen::kNever && aim <= best.aim) return;
  const float way = (image_.viewpoint().cast<float>() - old.viewpoint).norm();
  pass = found;
  pass.moved = way > kElsewhere;
  best = {old.end, aim, old.stamp, old.viewpoint};
}

}  // namespace tccm
