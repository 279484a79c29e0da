#include "experiments/outcome.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace tccm::simulation {
namespace {

TEST(OutcomeTest, EachIsCountedUnderItsName) {
  OutcomeCounts counts;
  for (const Outcome outcome : {Outcome::kTouched, Outcome::kStopped, Outcome::kStopped}) {
    counts.add(outcome);
  }
  EXPECT_EQ(counts.of(Outcome::kStopped), 2U);
  nlohmann::ordered_json figures;
  counts.addTo(figures);
  EXPECT_EQ(figures.dump(), R"({"stopped":2,"touched":1,"not_started":0,"undecided":0})");
}

TEST(OutcomeTest, TrialsThatCameToNothingMissALimit) {
  OutcomeCounts counts;
  std::vector<std::string> missed;
  counts.add(Outcome::kTouched);
  counts.addMissed(missed);
  EXPECT_TRUE(missed.empty());
  counts.add(Outcome::kUndecided);
  counts.add(Outcome::kNotStarted);
  counts.addMissed(missed);
  EXPECT_EQ(missed, (std::vector<std::string>{"not_started", "undecided"}));
}

}  // namespace
}  // namespace tccm::simulation
