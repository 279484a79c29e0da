// What docs/failures.md says of the reasons, held against the code.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "check/permission.h"

namespace tccm {
namespace {

struct Row {
  std::string reason, level, wrong, limit, lifted;
};

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(' ');
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

std::vector<std::string> cellsOf(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line.substr(1));
  for (std::string cell; std::getline(stream, cell, '|');) cells.push_back(trimmed(cell));
  return cells;
}

/// The rows of the page's table of reasons.
std::vector<Row> rowsOfPage() {
  std::ifstream page(std::string(TCCM_SOURCE_DIR) + "/docs/failures.md");
  std::vector<Row> rows;
  bool in_table = false;
  for (std::string line; std::getline(page, line);) {
    if (line.rfind("| reason |", 0) == 0) {
      in_table = true;
      EXPECT_EQ(line,
                "| reason | level | what is wrong | time or other limit | how it is lifted | "
                "what to do |");
    } else if (in_table && line.rfind("| `", 0) == 0) {
      const auto cells = cellsOf(line);
      EXPECT_EQ(cells.size(), 6u) << line;
      if (cells.size() != 6) continue;
      rows.push_back(
          {cells[0].substr(1, cells[0].size() - 2), cells[1], cells[2], cells[3], cells[4]});
    } else if (line.rfind("|--", 0) != 0) {
      in_table = false;
    }
  }
  return rows;
}

/// All that the code has.
std::map<std::string, Reason> allReasons() {
  std::map<std::string, Reason> reasons;
  for (int i = 0; std::string(name(static_cast<Reason>(i))) != "UNKNOWN"; ++i) {
    reasons[name(static_cast<Reason>(i))] = static_cast<Reason>(i);
  }
  return reasons;
}

std::string levelText(Level level) {
  constexpr const char* kTexts[] = {"OK", "SLOW", "STOP", "FAULT"};
  return kTexts[static_cast<std::size_t>(level)];
}

/// Of what is configured to be milder or stricter, or comes later: the other level.
const std::map<Reason, std::string> kOtherLevels{
    {Reason::kCollisionAhead, "SLOW"}, {Reason::kKeepOutAhead, "SLOW"},
    {Reason::kOcclusion, "SLOW"},      {Reason::kOcclusionAhead, "SLOW"},
    {Reason::kEvidenceOld, "SLOW"},    {Reason::kUnseenAhead, "STOP"}};

/// What follows once a cause is over, in the page's words.
std::string liftingOf(Reason reason, const std::string& level) {
  Cause cause{reason, "detail", "link"};
  if (level == "STOP") cause.level = Level::kStop;
  if (level == "SLOW") cause.level = Level::kSlow;
  Permission permission{Permission::Config()};
  const auto decide = [&permission](double seconds, std::vector<Cause> causes) {
    Permission::Findings findings;
    findings.known = true;
    findings.window = std::chrono::seconds(1);
    findings.causes = std::move(causes);
    return permission.decide(Time(fromSeconds(seconds)), findings).worst.reason;
  };
  EXPECT_EQ(decide(1.00, {}), Reason::kClear);
  EXPECT_EQ(decide(1.02, {cause}), reason);
  const Reason next = decide(1.04, {});
  if (next == Reason::kAwaitingReset) return "reset";
  return next == Reason::kReleasing ? "release" : "at once";
}

TEST(ReasonsPageTest, EveryReasonOfTheCodeStandsInTheTableWithItsLevel) {
  std::map<std::string, std::set<std::string>> levels;
  for (const Row& row : rowsOfPage()) levels[row.reason].insert(row.level);
  for (const auto& [text, reason] : allReasons()) {
    std::set<std::string> expected{levelText(levelOf(reason))};
    const auto other = kOtherLevels.find(reason);
    if (other != kOtherLevels.end()) expected.insert(other->second);
    EXPECT_EQ(levels[text], expected) << "docs/failures.md: the table of reasons, " << text;
  }
}

TEST(ReasonsPageTest, TheTableHasNoReasonThatTheCodeHasNot) {
  const auto reasons = allReasons();
  const auto rows = rowsOfPage();
  EXPECT_GE(rows.size(), reasons.size());
  for (const Row& row : rows) {
    EXPECT_EQ(reasons.count(row.reason), 1u) << "docs/failures.md: no such reason: " << row.reason;
  }
}

TEST(ReasonsPageTest, EachRowSaysWhatIsWrongAndHowItIsLifted) {
  for (const Row& row : rowsOfPage()) {
    EXPECT_FALSE(row.wrong.empty()) << row.reason;
    EXPECT_EQ(row.lifted.empty(), row.level == "OK") << row.reason;
  }
}

TEST(ReasonsPageTest, WhatIsLiftedIsLiftedAsTheTableSays) {
  const auto reasons = allReasons();
  // These two are what the others end in.
  const std::map<std::string, std::string> own{{"AWAITING_RESET", "reset"},
                                               {"RELEASING", "when the time is over"}};
  for (const Row& row : rowsOfPage()) {
    const auto reason = reasons.find(row.reason);
    if (reason == reasons.end() || row.level == "OK") continue;
    // What only an answer of a service says is in that answer alone.
    if (row.lifted == "at once: it is in this answer alone") continue;
    const auto exception = own.find(row.reason);
    const std::string lifted =
        exception != own.end() ? exception->second : liftingOf(reason->second, row.level);
    EXPECT_EQ(row.lifted.substr(0, row.lifted.find(',')), lifted)
        << "docs/failures.md: " << row.reason << ", " << row.level;
  }
}

}  // namespace
}  // namespace tccm
