#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "base/line_of.h"
#include "tccm_monitor/time.h"

namespace tccm {

/// Steps back of the clock by which checks are made. A clock that is set back steps once, and so
/// does a recording that begins anew. Where steps come close together, time goes to and fro: it has
/// two sources.
class ClockSteps {
 public:
  /// To be told of each check's time.
  void add(Time now) {
    ++checks_;
    if (last_ && now < *last_) {
      back_ = *last_ - now;
      steps_[count_++ % steps_.size()] = checks_;
    }
    last_ = now;
  }
  [[nodiscard]] bool goesToAndFro() const {
    return count_ >= steps_.size() && checks_ - steps_[count_ % steps_.size()] < kChecks;
  }
  /// For people.
  [[nodiscard]] std::string text() const {
    return lineOf("time goes to and fro, back by %.4g s lately: two sources of /clock? stop one",
                  toSeconds(back_));
  }

 private:
  static constexpr std::uint64_t kChecks = 100;  ///< within which all steps have to lie
  std::array<std::uint64_t, 3> steps_ = {};      ///< the checks that came with the last ones
  std::size_t count_ = 0;
  std::uint64_t checks_ = 0;
  std::optional<Time> last_;
  Duration back_{0};
};

}  // namespace tccm
