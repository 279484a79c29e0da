#pragma once

#include <algorithm>
#include <chrono>
#include <vector>

namespace tccm {

/// How long each of many calls took.
class Latencies {
 public:
  template <typename Call>
  void time(Call&& call) {
    const auto start = std::chrono::steady_clock::now();
    call();
    const std::chrono::duration<double, std::micro> taken =
        std::chrono::steady_clock::now() - start;
    times_us_.push_back(taken.count());
  }

  /// @param state google benchmark's.
  template <typename State>
  void report(State& state) {
    state.counters["p50_us"] = percentileUs(0.5);
    state.counters["p99_us"] = percentileUs(0.99);
    state.counters["max_us"] = percentileUs(1.0);
  }
  [[nodiscard]] double percentileUs(double share) {
    if (times_us_.empty()) return 0.0;
    std::sort(times_us_.begin(), times_us_.end());
    return times_us_[static_cast<std::size_t>(share * static_cast<double>(times_us_.size() - 1))];
  }

 private:
  std::vector<double> times_us_;
};

}  // namespace tccm
