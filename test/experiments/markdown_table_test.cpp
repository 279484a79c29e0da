#include "experiments/markdown_table.h"

#include <gtest/gtest.h>

namespace tccm::simulation {
namespace {

TEST(MarkdownTableTest, ARuleThatAlignsStandsBetweenNamesAndRows) {
  MarkdownTable table;
  table.addColumn("speed");
  table.addColumn("from", MarkdownTable::Column::kText);
  table.addRow({"0.5 m/s", "side"});
  table.addRow({"1.0 m/s", "behind"});
  const std::vector<std::string> lines = {"| speed | from |", "|---:|---|", "| 0.5 m/s | side |",
                                          "| 1.0 m/s | behind |"};
  EXPECT_EQ(table.lines(), lines);
}

}  // namespace
}  // namespace tccm::simulation
