#include "ros/advice.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "tccm_monitor/verdict.h"

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

TEST(AdviceTest, EachReasonHasSome) {
  const Advice advice = Advice::ofThePage();
  const char* const levels[] = {"OK", "SLOW", "STOP", "FAULT"};
  for (int i = 1; i <= static_cast<int>(Reason::kBadQuestion); ++i) {
    const auto reason = static_cast<Reason>(i);
    if (reason == Reason::kBadQuestion) continue;  // an answer's, no status'
    const char* level = levels[static_cast<int>(levelOf(reason))];
    EXPECT_NE(advice.about(name(reason), level), "") << name(reason) << " at " << level;
  }
}

TEST(AdviceTest, WithoutThePageThereIsNone) {
  EXPECT_EQ(Advice().about("COLLISION", "STOP"), "");
  EXPECT_EQ(Advice("| `COLLISION` | STOP |\n|").about("COLLISION", "STOP"), "");
}

}  // namespace
}  // namespace tccm
