/// Checker::checkState, and that it never answers free without knowing.

#include "support/checker_fixture.h"

namespace tccm {
namespace {

using test::at;
using test::kStart;

class CheckStateTest : public test::CheckerFixture {
 protected:
  StateAnswer ask(const std::vector<std::string>& names, const std::vector<double>& positions,
                  double now = kStart) {
    return checker_->checkState(at(now), names, positions);
  }
};

TEST_F(CheckStateTest, AFreePoseIsFreeWhenAllIsWell) {
  feed(kStart, post_);
  const auto answer = ask({"slide"}, {0.5});
  EXPECT_EQ(answer.cause.reason, Reason::kClear);
  EXPECT_EQ(answer.findings.links.size(), 2U);
}

TEST_F(CheckStateTest, APoseThatTouchesOrIsHiddenIsNamed) {
  feed(kStart, post_);
  const auto touching = ask({"slide"}, {0.8});
  EXPECT_EQ(touching.cause.reason, Reason::kCollision);
  EXPECT_EQ(touching.cause.link, "hand");
  feed(kStart + 0.01, shelf_, -0.5);
  EXPECT_EQ(ask({"slide"}, {0.6}, kStart + 0.01).cause.reason, Reason::kOcclusion);
}

TEST_F(CheckStateTest, JointsThatAreNotNamedAreTakenWhereTheyAre) {
  feed(kStart, post_, 0.8);
  EXPECT_EQ(ask({"glide"}, {0.2}).cause.reason, Reason::kCollision);
  EXPECT_EQ(ask({"slide"}, {0.2}).cause.reason, Reason::kClear);
}

TEST_F(CheckStateTest, BadQuestionsAreAnsweredAsSuch) {
  feed(kStart, clear_);
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(ask({}, {}).cause.reason, Reason::kBadQuestion);
  EXPECT_EQ(ask({"slide"}, {}).cause.reason, Reason::kBadQuestion);
  EXPECT_EQ(ask({"slide"}, {0.1, 0.2}).cause.reason, Reason::kBadQuestion);
  EXPECT_EQ(ask({"slide"}, {kNaN}).cause.reason, Reason::kBadQuestion);
  EXPECT_EQ(ask({"slide"}, {kInfinity}).cause.reason, Reason::kBadQuestion);
  const auto unknown = ask({"slide", "sldie"}, {0.1, 0.1});
  EXPECT_EQ(unknown.cause.reason, Reason::kBadQuestion);
  EXPECT_NE(unknown.cause.detail.find("'sldie'"), std::string::npos);
}

TEST_F(CheckStateTest, AMimicJointHasToFollowTheJointThatItMimics) {
  using namespace test;
  const std::string sliding = axisOf("1 0 0") + limitOf("-1", "1");
  model_ = modelOf(robotOf(linkOf("base") + ballLink("hand") + ballLink("finger") +
                           jointOf("slide", "prismatic", "base", "hand", sliding) +
                           jointOf("close", "prismatic", "hand", "finger",
                                   sliding + "<mimic joint=\"slide\" multiplier=\"0.5\"/>")));
  remake();
  feed(kStart, clear_);
  EXPECT_EQ(ask({"slide", "close"}, {0.2, 0.1}).cause.reason, Reason::kClear);
  EXPECT_EQ(ask({"slide", "close"}, {0.2, 0.2}).cause.reason, Reason::kBadQuestion);
  EXPECT_EQ(ask({"close"}, {0.1}).cause.reason, Reason::kBadQuestion) << "the slide is at 0";
}

TEST_F(CheckStateTest, NothingIsFreeWhileAnythingIsMissing) {
  for (int given = 0; given < 7; ++given) {
    remakeWith(given);
    EXPECT_EQ(ask({"slide", "glide"}, {0.0, 0.0}).cause.reason, Reason::kInit) << given;
    EXPECT_GT(ask({"slide", "glide"}, {0.0, 0.0}, kStart + 2.0).cause.reason, Reason::kInit)
        << given;
  }
}

TEST_F(CheckStateTest, FaultsAreNamed) {
  feed(kStart, clear_);
  EXPECT_EQ(ask({"slide"}, {0.1}, kStart + 0.1001).cause.reason, Reason::kNoJoints);
  setMap(kStart, clear_, kStart - 0.6);
  EXPECT_EQ(ask({"slide"}, {0.1}).cause.reason, Reason::kMapLate);
  clear_.overflowed = true;
  setMap(kStart, clear_);
  EXPECT_EQ(ask({"slide"}, {0.1}).cause.reason, Reason::kMapOverflow);
  clear_.overflowed = clear_.complete = false;
  setMap(kStart, clear_);
  EXPECT_EQ(ask({"slide"}, {0.1}).cause.reason, Reason::kInit);
}

TEST_F(CheckStateTest, AskingChangesNoVerdict) {
  feedAndCheck(kStart, post_);
  ask({"slide"}, {0.8});
  EXPECT_EQ(reasonAt(kStart + 0.01), Reason::kClear);
}

}  // namespace
}  // namespace tccm
