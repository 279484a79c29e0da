#pragma once

#include <benchmark/benchmark.h>

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

  void report(benchmark::State& state) {
    std::sort(times_us_.begin(), times_us_.end());
    state.counters["p50_us"] = percentile(0.5);
    state.counters["p99_us"] = percentile(0.99);
    state.counters["max_us"] = percentile(1.0);
  }

 private:
  [[nodiscard]] double percentile(double share) const {
    if (times_us_.empty()) return 0.0;
    return times_us_[static_cast<std::size_t>(share * static_cast<double>(times_us_.size() - 1))];
  }

  std::vector<double> times_us_;
};

}  // namespace tccm
