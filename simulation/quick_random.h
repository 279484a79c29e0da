#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace tccm::simulation {

/// Random numbers for pixels, of which there are millions a second: xoshiro256++ of Blackman and
/// Vigna 2019 ("Scrambled linear pseudorandom number generators"). Repeatable from its seed.
class QuickRandom {
 public:
  explicit QuickRandom(std::uint64_t seed) {
    for (std::uint64_t& word : state_) word = splitMix(seed);
  }

  std::uint64_t operator()() {
    const std::uint64_t result = rotated(state_[0] + state_[3], 23) + state_[0];
    const std::uint64_t shifted = state_[1] << 17;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= shifted;
    state_[3] = rotated(state_[3], 45);
    return result;
  }
  /// From 0 to below 1.
  double uniform() { return static_cast<double>((*this)() >> 11) * 0x1.0p-53; }

 private:
  static std::uint64_t rotated(std::uint64_t word, int by) {
    return word << by | word >> (64 - by);
  }
  static std::uint64_t splitMix(std::uint64_t& seed) {
    seed += 0x9E3779B97F4A7C15ULL;
    std::uint64_t word = (seed ^ seed >> 30) * 0xBF58476D1CE4E5B9ULL;
    word = (word ^ word >> 27) * 0x94D049BB133111EBULL;
    return word ^ word >> 31;
  }

  std::array<std::uint64_t, 4> state_;
};

/// Numbers of a normal distribution with mean 0 and deviation 1, of which none is beyond 5.5: each
/// is the sum of two drawn from a table.
class QuickNormal {
 public:
  QuickNormal() {
    double squares = 0.0;
    for (std::size_t i = 0; i < kEntries; ++i) {
      const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(kEntries);
      const double number = quantile(share);
      squares += number * number;
      table_[i] = static_cast<float>(number);
    }
    const auto scale = static_cast<float>(std::sqrt(0.5 * static_cast<double>(kEntries) / squares));
    for (float& number : table_) number *= scale;
  }

  float operator()(QuickRandom& random) const {
    const std::uint64_t word = random();
    return table_[word >> 52] + table_[word >> 40 & (kEntries - 1)];
  }

 private:
  static constexpr std::size_t kEntries = 4096;

  /// Of the distribution, by bisection: it is done once.
  static double quantile(double share) {
    double low = -10.0, high = 10.0;
    while (high - low > 1e-9) {
      const double middle = 0.5 * (low + high);
      (0.5 * std::erfc(-middle / std::sqrt(2.0)) < share ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }

  std::array<float, kEntries> table_;
};

}  // namespace tccm::simulation
