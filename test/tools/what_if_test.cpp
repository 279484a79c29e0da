#include "tools/what_if.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace tccm {
namespace {

using Kind = StopChange::Kind;

ComparedStop stop(double from_s, double to_s, const std::string& reason = "COLLISION") {
  return {from_s, to_s, reason, "hand", {}};
}

/// "moved 1 3": what became of each, and where it was and is; "-" where there is none.
std::vector<std::string> changes(const std::vector<ComparedStop>& before,
                                 const std::vector<ComparedStop>& after) {
  const auto beginOf = [](const std::optional<ComparedStop>& stop) {
    return stop ? std::to_string(static_cast<int>(stop->from_s)) : std::string("-");
  };
  const std::vector<std::string> names{"same", "moved", "other", "gone", "come"};
  std::vector<std::string> told;
  for (const StopChange& change : compareStops(before, after)) {
    told.push_back(names[static_cast<std::size_t>(change.kind)] + ' ' + beginOf(change.before) +
                   ' ' + beginOf(change.after));
  }
  return told;
}

TEST(WhatIfTest, StopsThatOverlapMostBelongTogether) {
  // The first of those before touches both of those after, the second the later one alone.
  EXPECT_EQ(changes({stop(1, 5)}, {stop(0, 2), stop(3, 6)}),
            (std::vector<std::string>{"come - 0", "moved 1 3"}));
  EXPECT_EQ(changes({stop(0, 4), stop(5, 9)}, {stop(3, 9)}),
            (std::vector<std::string>{"gone 0 -", "moved 5 3"}));
  EXPECT_EQ(changes({stop(0, 4), stop(5, 9)}, {stop(3, 9), stop(0, 2)}),
            (std::vector<std::string>{"moved 0 0", "moved 5 3"}));
}

TEST(WhatIfTest, OfEqualOverlapsTheEarlierCounts) {
  EXPECT_EQ(changes({stop(0, 10)}, {stop(1, 3), stop(5, 7)}),
            (std::vector<std::string>{"moved 0 1", "come - 5"}));
}

TEST(WhatIfTest, StopsThatDoNotOverlapComeAndGo) {
  EXPECT_EQ(changes({stop(1, 2)}, {stop(3, 4)}),
            (std::vector<std::string>{"gone 1 -", "come - 3"}));
  EXPECT_EQ(changes({stop(1, 2)}, {stop(1, 2)}), std::vector<std::string>{"same 1 1"});
  EXPECT_EQ(changes({stop(1, 2)}, {stop(1, 2, "INIT")}), std::vector<std::string>{"other 1 1"});
  EXPECT_EQ(changes({}, {}), std::vector<std::string>{});
}

}  // namespace
}  // namespace tccm
