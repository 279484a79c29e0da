#include "experiments/statistics.h"

#include <gtest/gtest.h>

namespace tccm::simulation {
namespace {

TEST(StatisticsTest, AShareOfNothingIsWhatIsSaidOfIt) {
  EXPECT_EQ(share(1, 4), 0.25);
  EXPECT_EQ(share(0, 0), 0.0);
  EXPECT_EQ(share(0, 0, 1.0), 1.0);
}

TEST(StatisticsTest, AQuantileIsOneOfTheNumbersAndNeverAGreaterOneThanIsDue) {
  const std::vector<double> sorted = {1.0, 2.0, 3.0, 4.0};
  EXPECT_EQ(quantile(sorted, 0.0), 1.0);
  EXPECT_EQ(quantile(sorted, 0.5), 2.0);
  EXPECT_EQ(quantile(sorted, 0.99), 3.0);
  EXPECT_EQ(quantile(sorted, 1.0), 4.0);
  EXPECT_EQ(quantile({}, 0.5), 0.0);
}

}  // namespace
}  // namespace tccm::simulation
