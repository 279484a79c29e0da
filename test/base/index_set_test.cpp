#include "base/index_set.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "support/random.h"

namespace tccm {
namespace {

std::vector<std::size_t> in(const IndexSet& set) {
  std::vector<std::size_t> indices;
  set.visit([&](std::size_t i) { indices.push_back(i); });
  return indices;
}

TEST(IndexSetTest, ItHasWhatWasInsertedInOrderUntilItIsCleared) {
  IndexSet set(130);
  EXPECT_TRUE(set.empty());
  for (const std::size_t i : {129U, 0U, 64U, 63U, 64U}) set.insert(i);
  EXPECT_EQ(in(set), (std::vector<std::size_t>{0, 63, 64, 129}));
  EXPECT_TRUE(set.has(64));
  EXPECT_FALSE(set.has(65));
  EXPECT_FALSE(set.empty());
  set.clear();
  EXPECT_TRUE(set.empty());
  EXPECT_TRUE(in(set).empty());
}

TEST(IndexSetTest, AllAreThoseBelowTheBound) {
  for (const std::size_t bound : {1U, 64U, 65U}) {
    IndexSet set(bound);
    set.insertAll();
    EXPECT_EQ(in(set).size(), bound);
    EXPECT_EQ(in(set).back(), bound - 1);
  }
}

TEST(IndexSetTest, RandomUnionsHaveWhatEitherHas) {
  test::Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    IndexSet a(200), b(200);
    std::set<std::size_t> expected;
    for (int i = random.integer(0, 40); i > 0; --i) {
      const auto index = static_cast<std::size_t>(random.integer(0, 199));
      (random.chance(0.5) ? a : b).insert(index);
      expected.insert(index);
    }
    a.insert(b);
    EXPECT_EQ(in(a), std::vector<std::size_t>(expected.begin(), expected.end()));
    EXPECT_EQ(a.empty(), expected.empty());
  }
}

}  // namespace
}  // namespace tccm
