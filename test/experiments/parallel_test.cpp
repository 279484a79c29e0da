#include "experiments/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace tccm::simulation {
namespace {

TEST(InParallelTest, EveryIndexIsWorkedOnceWhateverTheNumberOfThreads) {
  for (const int threads : {1, 2, 7}) {
    std::vector<std::atomic<int>> worked(1000);
    inParallel(worked.size(), threads, [&](std::size_t i) { ++worked[i]; }, {});
    for (const auto& times : worked) EXPECT_EQ(times, 1);
  }
}

TEST(InParallelTest, ProgressRisesTo1) {
  double last = 0.0;
  inParallel(
      100, 3, [](std::size_t) {},
      [&](double share) {
        EXPECT_GE(share, last);
        last = share;
      });
  EXPECT_EQ(last, 1.0);
}

TEST(InParallelTest, NothingToDoIsDone) {
  inParallel(0, 2, [](std::size_t) { FAIL(); }, {});
}

TEST(InParallelTest, WhatWorkThrowsComesOutAndEndsIt) {
  std::atomic<int> worked{0};
  const auto work = [&](std::size_t i) {
    if (i == 5) throw std::runtime_error("five");
    ++worked;
  };
  EXPECT_THROW(inParallel(1000000, 2, work, {}), std::runtime_error);
  EXPECT_LT(worked, 1000000);
}

}  // namespace
}  // namespace tccm::simulation
