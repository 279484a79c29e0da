#include "map/appearances.h"

#include <algorithm>
#include <cmath>

namespace tccm {
namespace {

constexpr double kThrough = 0.05;      // [m] that a look must have gone on behind a place
constexpr double kBefore = 0.2;        // [s] between the images of where places were free
constexpr double kLookedLately = 0.3;  // [s] before its newest frame
constexpr double kOldest = 0.6;        // [s]; what was free longer ago need not have been since
constexpr Duration kLongest = std::chrono::hours(24 * 24);  // that milliseconds are counted for
constexpr std::uint32_t kMissed_ms = 400;   // what was missed for less is still the same
constexpr std::size_t kFoundMax = 50000;    // in one frame
constexpr std::uint32_t kReturnsLeast = 8;  // in a frame: flying pixels are fewer
constexpr double kMost = 0.65;              // of the returns around a cuboid
constexpr std::size_t kAhead = 64;          // returns; as long as a place takes to come

}  // namespace

void Appearances::Config::describe(ParameterTable& table) {
  table.add("appeared_s", &lasts_s, "s", {0.0, 60.0},
            "for so long a camera's or lidar's cuboids count as appeared where it saw through "
            "their place before; 0: none does");
}

Appearances::Appearances(const Config& config, const IntegrationMap& map, double resolution_rad)
    : grid_(map.grid()),
      lowest_m_(grid_.metres(map.returnCounts().lowest())),
      layer_m_(grid_.metres(map.returnCounts().layer())),
      layers_(map.returnCounts().layers()),
      lasts_(static_cast<Ticks>(std::lround(1e3 * config.lasts_s))),
      images_{Image{std::nullopt, LookImage(resolution_rad)},
              Image{std::nullopt, LookImage(resolution_rad)}} {}

void Appearances::clear() {
  std::fill(places_.begin(), places_.end(), Place());
  for (Image& image : images_) image.stamp.reset();
  first_.reset();
  last_.reset();
  now_ = newest_ = 0;
}

void Appearances::begin(Time now) {
  if (places_.empty()) {
    places_.resize(grid_.cells() * layers_);
    found_.reserve(kFoundMax);
  }
  if (first_ && now - *first_ > kLongest) clear();
  if (!first_) first_ = now;
  now_ = 1 + static_cast<Ticks>((now - *first_) / std::chrono::milliseconds(1));
}

void Appearances::follow(const IntegrationMap& map, const LookImage& looks) {
  if (lasts_ == 0) return;
  begin(map.newestStamp());
  if (last_) keep(*last_, looks);
  last_ = map.newestStamp();
  found_.clear();
  // The places lie far apart in memory: each is asked for some returns before it is needed.
  std::array<Found, kAhead> asked;
  std::size_t returns = 0;
  map.visitNewest([&](const MappedReturn& entry) {
    Found& slot = asked[returns % kAhead];
    if (returns++ >= kAhead) see(slot);
    slot = {entry.cell, map.returnCounts().layerOf(entry.height)};
    __builtin_prefetch(&at(slot.cell, slot.layer));
  });
  for (std::size_t i = returns - std::min(returns, kAhead); i < returns; ++i) {
    see(asked[i % kAhead]);
  }
  const auto appear = [this](const Found& found) {
    at(found.cell, found.layer).appeared = newest_ = now_;
  };
  for (const Found& found : found_) {
    if (wasFreeAround(found)) appear(found);
  }
  const bool has_any = newest_ != 0 && now_ - newest_ <= lasts_;
  for (const Found& found : found_) {
    if (has_any && isBesideAppeared(found) && wasFree(found)) appear(found);
  }
}

/// A return of the newest frame.
void Appearances::see(const Found& found) {
  Place& place = at(found.cell, found.layer);
  if (place.seen == now_) {
    ++place.returns;
    return;
  }
  const bool was_seen = place.seen != 0 && now_ - place.seen <= kMissed_ms;
  place.seen = now_;
  place.returns = 1;
  if (!was_seen && found_.size() < kFoundMax) found_.push_back(found);
}

/// In place of the older one, once the other is old enough.
void Appearances::keep(Time stamp, const LookImage& looks) {
  Image& older = images_[0];
  Image& newer = images_[1];
  if (newer.stamp && stamp - *newer.stamp < fromSeconds(kBefore)) return;
  std::swap(older, newer);
  newer.stamp = stamp;
  newer.looks.copyFrom(looks);
}

/// What came after a gap of frames may have stood there all along.
bool Appearances::isLately(const Image& image) const {
  return image.stamp && *last_ - *image.stamp <= fromSeconds(kOldest);
}

Vector3 Appearances::middleOf(const Found& found) const {
  const Eigen::Vector2d centre = grid_.centre(found.cell);
  return {centre.x(), centre.y(), lowest_m_ + (static_cast<double>(found.layer) + 0.5) * layer_m_};
}

/// In either image: the older one tells of a thing that comes slowly, the newer one of what follows
/// the robot into a place that it has just left.
bool Appearances::wasFreeAround(const Found& found) const {
  const Vector3 middle = middleOf(found);
  return std::any_of(images_.begin(), images_.end(), [&](const Image& image) {
    return isLately(image) &&
           image.looks.inViewSince(*image.stamp - fromSeconds(kLookedLately), middle, -kThrough);
  });
}

bool Appearances::wasFree(const Found& found) const {
  const Vector3 middle = middleOf(found);
  return std::any_of(images_.begin(), images_.end(), [&](const Image& image) {
    if (!isLately(image)) return false;
    const LookImage::Sight sight = image.looks.at(middle, -kThrough);
    return sight.kind == LookImage::Sight::Kind::kSeen &&
           *image.stamp - sight.stamp <= fromSeconds(kLookedLately);
  });
}

bool Appearances::isBesideAppeared(const Found& found) const {
  bool is_beside = false;
  const std::size_t from = found.layer - std::min<std::size_t>(found.layer, 1);
  const std::size_t to = std::min(found.layer + 2, layers_);
  grid_.visitAround(found.cell, [&](CellIndex cell) {
    for (std::size_t layer = from; layer < to; ++layer) {
      is_beside |= isLately(places_[cell * layers_ + layer]);
    }
  });
  return is_beside;
}

void Appearances::apply(const IntegrationMap& map, CuboidMap& snapshot) const {
  snapshot.appeared = 0;
  if (newest_ == 0 || now_ - newest_ > lasts_) return;
  for (Cuboid& cuboid : snapshot.cuboids) {
    cuboid.appeared = !cuboid.held && hasAppeared(cuboid, map);
    snapshot.appeared += cuboid.appeared ? 1 : 0;
  }
}

bool Appearances::hasAppeared(const Cuboid& cuboid, const IntegrationMap& map) const {
  const ReturnCounts& counts = map.returnCounts();
  const std::size_t low = counts.layerOf(std::min(map.lowestReturn(cuboid.bottom), cuboid.top));
  const std::size_t high = counts.layerOf(cuboid.top);
  const Place* own = &places_[cuboid.cell * layers_];
  if (std::none_of(own + low, own + high + 1, [this](const Place& p) { return isLately(p); })) {
    return false;
  }
  Around around;
  const std::size_t from = low - std::min<std::size_t>(low, 1);
  const std::size_t to = std::min(high + 2, layers_);
  grid_.visitAround(cuboid.cell, [&](CellIndex cell) {
    for (std::size_t layer = from; layer < to; ++layer) {
      const Place& place = places_[cell * layers_ + layer];
      const std::uint32_t returns = counts.at(cell, layer);
      around.all += returns;
      if (!isLately(place)) continue;
      around.appeared += returns;
      around.newest += place.seen == now_ ? place.returns : 0;
    }
  });
  return around.newest >= kReturnsLeast && around.appeared >= kMost * around.all;
}

}  // namespace tccm
