#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "tccm_monitor/time.h"

namespace tccm {

/// The share of what the sensor measures inside the area and below it that is taken for the robot,
/// over a whole period of the tilt: nearly all of it is no robot, but one that is described too
/// large.
class SelfShare {
 public:
  /// @param scans that are remembered at most.
  explicit SelfShare(std::size_t scans) : scans_(scans) {}

  /// @param self returns in the area that were taken for the robot. @param others all other returns
  /// in it. @param period of the tilt; 0 where it is not known.
  void add(Time stamp, std::size_t self, std::size_t others, Duration period) {
    if (count_ == scans_.size()) drop();
    scans_[(begin_ + count_++) % scans_.size()] = {stamp, self, others};
    self_ += self;
    others_ += others;
    const bool known = period > Duration::zero();
    while (known && count_ > 1 && stamp - scans_[begin_].stamp > period) drop();
    // After a pause of the scans as at the start.
    is_whole_ = known && stamp - scans_[begin_].stamp >= period - period / 8;
  }
  void clear() { *this = SelfShare(scans_.size()); }

  /// Nothing where it is not known: before a whole period, or with too few returns to tell.
  [[nodiscard]] std::optional<double> share() const {
    const std::size_t all = self_ + others_;
    if (!is_whole_ || all < kReturnsMin * count_) return std::nullopt;
    return static_cast<double>(self_) / static_cast<double>(all);
  }
  [[nodiscard]] std::size_t memoryBytes() const { return scans_.capacity() * sizeof(Scan); }

 private:
  static constexpr std::size_t kReturnsMin = 50;  // a scan

  struct Scan {
    Time stamp;
    std::size_t self, others;
  };
  void drop() {
    self_ -= scans_[begin_].self;
    others_ -= scans_[begin_].others;
    begin_ = (begin_ + 1) % scans_.size();
    --count_;
  }

  std::vector<Scan> scans_;
  std::size_t begin_ = 0, count_ = 0;
  std::size_t self_ = 0, others_ = 0;  ///< of those remembered
  bool is_whole_ = false;              ///< they reach back for a period, but for a few scans
};

}  // namespace tccm
