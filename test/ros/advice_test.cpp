#include "ros/advice.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

namespace tccm {
namespace {

TEST(AdviceTest, ItIsThatOfThePageForReasonAndLevel) {
  std::ifstream file(std::string(TCCM_SOURCE_DIR) + "/docs/failures.md");
  ASSERT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), failuresPage());
  const Advice advice = Advice::ofThePage();
  EXPECT_EQ(advice.about("INIT", "STOP").substr(0, 4), "wait");
  EXPECT_NE(advice.about("KEEP_OUT_AHEAD", "STOP"), advice.about("KEEP_OUT_AHEAD", "SLOW"));
  EXPECT_EQ(advice.about("COLLISION", "OK"), "");
  const std::string collision = advice.about("COLLISION", "STOP");
  EXPECT_NE(collision.find("move out of the contact"), std::string::npos) << collision;
  EXPECT_EQ(collision.find_first_of("[]`"), std::string::npos) << collision;
}

TEST(AdviceTest, WithoutThePageThereIsNone) {
  EXPECT_EQ(Advice().about("COLLISION", "STOP"), "");
  EXPECT_EQ(Advice("| `COLLISION` | STOP |\n|").about("COLLISION", "STOP"), "");
}

}  // namespace
}  // namespace tccm
