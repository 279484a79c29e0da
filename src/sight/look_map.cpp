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
constexpr float kElsewhere = 0.25F;  // [m]; a head that turns moves its sensor by less
constexpr Duration kLongest = std::chrono::hours(24 * 24);  // that milliseconds are counted for

/// A look that is unclear counts only where no other does.
double handicap(Seen end) { return end == Seen::kUnclear ? 2.0 : 0.0; }

LookImage::Ticks toTicks(Duration duration) {
  return static_cast<LookImage::Ticks>(
      std::chrono::duration_cast<std::chrono::milliseconds>(duration).count());
}

/// Rounded down: what is not sure to have been seen was not.
std::uint16_t toMillimetres(double metres) {
  constexpr double kMost = std::numeric_limits<std::uint16_t>::max();
  return static_cast<std::uint16_t>(std::min(kMost, std::floor(1e3 * metres)));
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
  std::optional<Beam> best;
  for (const Look& look : looks) {
    const auto beam = beamTo(look.end, {now, now, 0, look.what}, best ? best->pixel : 0);
    if (!beam) continue;
    if (best && best->pixel != beam->pixel) note(*best);
    if (!best || best->pixel != beam->pixel || beam->aim > best->aim) best = beam;
  }
  if (best) note(*best);
}

void LookMap::follow(const Vector3& viewpoint) {
  mean_viewpoint_ += kMeanShare * (viewpoint - mean_viewpoint_);
  if ((viewpoint - mean_viewpoint_).norm() > kJump) mean_viewpoint_ = viewpoint;
  if ((mean_viewpoint_ - image_.viewpoint()).norm() > kMoveMax) moveTo(mean_viewpoint_);
}

std::optional<LookMap::Beam> LookMap::beamTo(const Vector3& end, const Pass& pass,
                                             std::size_t near) const {
  const Vector3 sight = end - image_.viewpoint();
  const double range = sight.norm();
  if (!(range > kNearestLook)) return std::nullopt;  // NaN, too
  const DirectionGrid& grid = image_.grid();
  Beam beam{end, sight / range, pass, grid.pixelNear(near, sight)};
  beam.pass.range_mm = toMillimetres(range);
  beam.aim = grid.middle(beam.pixel).dot(beam.direction) - handicap(pass.end);
  return beam;
}

template <typename Note>
void LookMap::spread(const Beam& beam, Note&& note) const {
  const DirectionGrid& grid = image_.grid();
  const Vector3& d = beam.direction;
  grid.visitAround(beam.pixel, spread_, [&](int row, int column) {
    const double cosine =
        grid.sine(row) * d.z() + grid.cosine(row) * grid.columnMiddle(column).dot(d.head<2>());
    if (cosine >= spread_cosine_) {
      note(row, column, static_cast<float>(cosine - handicap(beam.pass.end)));
    }
    return false;
  });
}

void LookMap::note(const Beam& beam) {
  spread(beam, [&](int row, int column, float aim) { note(row, column, beam, aim); });
}

void LookMap::note(int row, int column, const Beam& beam, float aim) {
  LookImage::Passes& passes = image_.edit(row, column);
  const std::size_t pixel = image_.grid().index(row, column);
  Aims& aims = aims_[pixel];
  const Ticks now = beam.pass.last;
  const bool is_new = passes[0].end == Seen::kNever || now - passes[0].last > gap_;
  if (is_new) {
    std::move_backward(passes.begin(), passes.end() - 1, passes.end());
    std::move_backward(aims.begin(), aims.end() - 1, aims.end());
  } else {
    passes[0].last = now;
    // The best look of a long pass must not be one of long ago.
    if (aim < aims[0].aim && now - aims[0].stamp <= gap_) return;
  }
  changed_.insert(pixel);
  const Ticks first = is_new ? now : passes[0].first;
  passes[0] = beam.pass;
  passes[0].first = first;
  aims[0] = {beam.end.cast<float>(), aim, now, image_.viewpoint().cast<float>()};
}

void LookMap::moveTo(const Vector3& viewpoint) {
  std::swap(image_, old_image_);
  std::swap(aims_, old_aims_);
  image_.begin(old_image_.epoch(), viewpoint);
  std::fill(aims_.begin(), aims_.end(), Aims());
  for (int row = old_image_.rowBegin(); row < old_image_.rowEnd(); ++row) {
    for (int column = 0; column < image_.grid().columns(); ++column) {
      const std::size_t pixel = image_.grid().index(row, column);
      for (std::size_t k = 0; k < LookImage::kPasses; ++k) {
        const Pass& pass = old_image_.passes(pixel)[k];
        const Aim& old = old_aims_[pixel][k];
        const auto beam = beamTo(old.end.cast<double>(), pass, pixel);
        if (pass.end == Seen::kNever || !beam) continue;
        spread(*beam, [&](int r, int c, float aim) { noteAgain(r, c, k, *beam, old, aim); });
      }
    }
  }
}

/// Passes that were the k-th newest in neighbouring directions are taken for one.
void LookMap::noteAgain(int row, int column, std::size_t k, const Beam& beam, const Aim& old,
                        float aim) {
  Pass& pass = image_.edit(row, column)[k];
  Aim& best = aims_[image_.grid().index(row, column)][k];
  if (pass.end != Seen::kNever && aim <= best.aim) return;
  const float way = (image_.viewpoint().cast<float>() - old.viewpoint).norm();
  pass = beam.pass;
  pass.moved = way > kElsewhere;
  best = {old.end, aim, old.stamp, old.viewpoint};
}

}  // namespace tccm
