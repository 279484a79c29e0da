#include "map/place_ages.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tccm {
namespace {

constexpr std::size_t kWord = 64;
constexpr std::size_t kAround = 9;       // cells, a cell itself included
constexpr double kLayer = 0.02;          // [m] at least: most of a range's noise stays in it
constexpr double kAbove = 0.2;           // [m] up to which what stands on a place is around it
constexpr int kGapLayers = 2;            // without a return: what is above does not stand on it
constexpr double kThrough = 0.03;        // [m] that a look must go on behind a place
constexpr double kMost = 0.65;           // of the returns around a place
constexpr std::size_t kScansLeast = 20;  // of a window, while it fills

}  // namespace

PlaceAges::PlaceAges(const IntegrationMap& map)
    : grid_(map.grid()),
      lowest_(grid_.heightFloor(grid_.config().height_min_m)),
      counted_(static_cast<std::size_t>(
          std::ceil(kLayer / grid_.metres(map.returnCounts().layer()) - 1e-9))),
      layer_(static_cast<int>(counted_) * map.returnCounts().layer()),
      above_(static_cast<std::size_t>(std::lround(kAbove / grid_.metres(layer_)))),
      layers_((map.returnCounts().layers() + counted_ - 1) / counted_),
      seen_(grid_.cells() * layers_, 0),
      known_(seen_.size(), 0),
      age_(seen_.size(), 0),
      words_((layers_ + kWord - 1) / kWord),
      stamps_(map.config().scans_max + 1),
      judged_(grid_.cells()) {
  kept_.resize(grid_.cells() * words_, 0);
  around_.reserve(kAround);
  known_around_.reserve(kAround * (above_ + 2));
  judged_.insertAll();  // the map may have been told the ages of another
}

void PlaceAges::clear() {
  std::fill(seen_.begin(), seen_.end(), 0U);
  std::fill(known_.begin(), known_.end(), Age{0});
  std::fill(age_.begin(), age_.end(), Age{0});
  std::fill(kept_.begin(), kept_.end(), std::uint64_t{0});
  judged_.insertAll();
  next_ = 0;
  due_ = 0.0;
}

Vector3 PlaceAges::middleOf(const Place& place) const {
  const Eigen::Vector2d centre = grid_.centre(place.cell);
  const double layers = static_cast<double>(place.layer) + 0.5;
  return {centre.x(), centre.y(), grid_.metres(lowest_) + layers * grid_.metres(layer_)};
}

void PlaceAges::follow(const IntegrationMap& map, const LookImage& looks) {
  if (beginnings_ != map.beginnings()) clear();
  beginnings_ = map.beginnings();
  stamps_[map.serial() % stamps_.size()] = map.newestStamp();
  std::size_t last = seen_.size();  // returns side by side are mostly of one place
  map.visitNewest([&](const MappedReturn& entry) {
    const std::size_t layer = layerOf(entry.height, map);
    const std::size_t place = index({entry.cell, layer});
    if (place == last) return;
    last = place;
    seen_[place] = map.serial();
    kept_[entry.cell * words_ + layer / kWord] |= std::uint64_t{1} << (layer % kWord);
  });
  const double scans = static_cast<double>(std::max(kScansLeast, map.scans()));
  for (due_ += 2.0 * grid_.cells() / scans; due_ >= 1.0; due_ -= 1.0) {
    judge(next_, map, looks);
    next_ = next_ + 1 < grid_.cells() ? next_ + 1 : 0;
  }
}

void PlaceAges::judge(CellIndex cell, const IntegrationMap& map, const LookImage& looks) {
  around_.clear();
  for (std::size_t word = 0; word < words_; ++word) {
    std::uint64_t& kept = kept_[cell * words_ + word];
    if (kept == 0) continue;
    if (around_.empty()) {
      grid_.visitAround(cell, [this](CellIndex c) { around_.push_back(c); });
      judged_.insert(cell);
    }
    for (std::uint64_t left = kept; left != 0; left &= left - 1) {
      const auto bit = static_cast<std::size_t>(__builtin_ctzll(left));
      if (!isKept({cell, word * kWord + bit}, map, looks)) kept &= ~(std::uint64_t{1} << bit);
    }
  }
}

bool PlaceAges::isKept(const Place& place, const IntegrationMap& map, const LookImage& looks) {
  const std::size_t i = index(place);
  const bool is_seen = returnsAt(map, place) > 0;
  if (known_[i] == 0) {
    known_[i] = is_seen ? 1 : 0;
  } else if (wasLookedThrough(place, map, looks)) {
    known_[i] = 0;
  } else if (known_[i] < kOldest) {
    ++known_[i];
  }
  if (is_seen) {
    age_[i] = ageAround(place, map);
  } else if (known_[i] == 0) {
    age_[i] = 0;
  }
  return known_[i] > 0 || is_seen;
}

/// Since it was seen last. Most never were: of these it need not be known when that was.
bool PlaceAges::wasLookedThrough(const Place& place, const IntegrationMap& map,
                                 const LookImage& looks) const {
  const Vector3 middle = middleOf(place);
  return looks.inViewSince(Time::min(), middle, -kThrough) &&
         looks.inViewSince(seenAround(place.layer, map), middle, -kThrough);
}

std::size_t PlaceAges::layerOf(Height height, const IntegrationMap& map) const {
  const std::size_t layer = map.returnCounts().layerOf(height);
  return counted_ == 1 ? layer : layer / counted_;
}

std::uint32_t PlaceAges::returnsAt(const IntegrationMap& map, const Place& place) const {
  const ReturnCounts& counts = map.returnCounts();
  if (counted_ == 1) return counts.at(place.cell, place.layer);
  const std::size_t begin = place.layer * counted_;
  const std::size_t end = std::min(begin + counted_, counts.layers());
  std::uint32_t returns = 0;
  for (std::size_t layer = begin; layer < end; ++layer) returns += counts.at(place.cell, layer);
  return returns;
}

/// When the newest return came in around_; not long ago, where it is long.
Time PlaceAges::seenAround(std::size_t layer, const IntegrationMap& map) const {
  auto scans_ago = static_cast<std::uint32_t>(stamps_.size() - 1);
  for (const CellIndex cell : around_) {
    const std::uint32_t seen = seen_[index({cell, layer})];
    if (seen > 0) scans_ago = std::min(scans_ago, map.serial() - seen);
  }
  return stamps_[(map.serial() - scans_ago) % stamps_.size()];
}

/// What most returns around the place have. It is mostly one more than when last judged.
PlaceAges::Age PlaceAges::ageAround(const Place& place, const IntegrationMap& map) {
  gatherAround(place, map);
  int age = std::min(age_[index(place)] + 1, int{kOldest});
  Around around = countAround(age);
  while (around.older >= kMost * around.returns && age < kOldest) around = countAround(++age);
  while (around.old < kMost * around.returns) around = countAround(--age);
  return static_cast<Age>(age);
}

/// In around_, from the layer below up to where two layers have no return.
void PlaceAges::gatherAround(const Place& place, const IntegrationMap& map) {
  known_around_.clear();
  const std::size_t from = place.layer - std::min<std::size_t>(place.layer, 1);
  const std::size_t to = std::min(place.layer + above_ + 1, layers_);
  std::array<std::uint64_t, kAround> kept;  // most places have no return
  std::uint64_t any = 0;
  for (std::size_t i = 0; i < around_.size(); ++i) any |= kept[i] = keptFrom({around_[i], from});
  int empty = 0;
  for (std::size_t layer = from; layer < to && empty < kGapLayers; ++layer) {
    ++empty;
    if ((any >> (layer - from) & 1U) == 0) continue;
    for (std::size_t i = 0; i < around_.size(); ++i) {
      if ((kept[i] >> (layer - from) & 1U) == 0) continue;
      const std::uint32_t returns = returnsAt(map, {around_[i], layer});
      if (returns == 0) continue;
      known_around_.push_back({known_[index({around_[i], layer})], returns});
      empty = 0;
    }
  }
}

PlaceAges::Around PlaceAges::countAround(int age) const {
  Around around;
  for (const Known& known : known_around_) {
    around.returns += known.returns;
    around.old += known.age >= age ? known.returns : 0;
    around.older += known.age > age ? known.returns : 0;
  }
  return around;
}

/// What is kept of a cell's layers from one on, its bit the lowest.
std::uint64_t PlaceAges::keptFrom(const Place& place) const {
  const std::uint64_t* words = &kept_[place.cell * words_];
  const std::size_t word = place.layer / kWord, bit = place.layer % kWord;
  std::uint64_t kept = words[word] >> bit;
  if (bit > 0 && word + 1 < words_) kept |= words[word + 1] << (kWord - bit);
  return kept;
}

/// Of the place in which most of its returns lie.
std::uint32_t PlaceAges::windowsOf(const Cuboid& cuboid, const IntegrationMap& map) const {
  const Height lowest = std::min(map.lowestReturn(cuboid.bottom), cuboid.top);
  const std::size_t from = layerOf(lowest, map);
  const std::size_t to = layerOf(cuboid.top, map);
  if (from == to) return age_[index({cuboid.cell, to})] / 2U;
  std::size_t best = to;
  std::uint32_t most = 0;
  for (std::size_t layer = from; layer <= to; ++layer) {
    const std::uint32_t returns = returnsAt(map, {cuboid.cell, layer});
    if (returns <= most) continue;
    most = returns;
    best = layer;
  }
  return age_[index({cuboid.cell, best})] / 2U;
}

void PlaceAges::apply(IntegrationMap& map, CuboidMap& newest) {
  if (beginnings_ != map.beginnings()) return;  // of these places nothing is known
  map.tellDyn(judged_, newest, [&](const Cuboid& cuboid) { return windowsOf(cuboid, map); });
  judged_.clear();
}

}  // namespace tccm
