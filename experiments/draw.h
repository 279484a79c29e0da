#pragma once

#include <cstdint>
#include <random>

namespace tccm::simulation {

/// Even draws, repeatable from the seed.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}

  double between(double least, double most) { return least + (most - least) * uniform_(random_); }
  template <typename List>
  auto of(const List& list) {
    return list[static_cast<std::size_t>(uniform_(random_) * static_cast<double>(list.size()))];
  }

 private:
  std::mt19937_64 random_;
  std::uniform_real_distribution<double> uniform_{0.0, 1.0};
};

}  // namespace tccm::simulation
