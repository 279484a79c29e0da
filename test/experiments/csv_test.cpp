#include "experiments/csv.h"

#include <gtest/gtest.h>

namespace tccm::simulation {
namespace {

TEST(CsvTest, ANumberHasAsManyDecimalsAsAskedFor) {
  EXPECT_EQ(fixed(-0.12345, 3), "-0.123");
  EXPECT_EQ(fixed(2.5, 0), "2");
  EXPECT_EQ(fixed(std::optional<double>(1.0), 2), "1.00");
}

TEST(CsvTest, WhatIsNotThereIsAnEmptyCell) {
  EXPECT_EQ(csvRow(7, fixed(std::nullopt, 3), "end"), "7,,end\n");
}

TEST(CsvTest, ARowTakesTextsWholeNumbersAndTruths) {
  const std::string link = "hand";
  EXPECT_EQ(csvRow(std::uint64_t{1} << 63, -1, link, true, false, ""),
            "9223372036854775808,-1,hand,1,0,\n");
  EXPECT_EQ(csvRow("only"), "only\n");
}

TEST(CsvTest, SomeCellsMayBePutTogetherBefore) {
  EXPECT_EQ(csvRow(1, csvCells("", ""), csvCells(2, "three")), "1,,,2,three\n");
}

}  // namespace
}  // namespace tccm::simulation
