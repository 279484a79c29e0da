#include "ros/advice.h"

#include <algorithm>
#include <regex>
#include <sstream>
#include <vector>

namespace tccm {
namespace {

/// Text as Markdown has it, without links and marks.
std::string plain(const std::string& markdown) {
  static const std::regex link(R"(\[([^\]]*)\]\([^)]*\))");
  std::string text = std::regex_replace(markdown, link, "$1");
  text.erase(std::remove(text.begin(), text.end(), '`'), text.end());
  return text;
}

/// The cells of a table's row, without blanks at their ends.
std::vector<std::string> cellsOf(const std::string& row) {
  std::vector<std::string> cells;
  std::istringstream text(row);
  std::string cell;
  std::getline(text, cell, '|');  // before the first bar
  while (std::getline(text, cell, '|')) {
    const auto begin = cell.find_first_not_of(' '), end = cell.find_last_not_of(' ');
    cells.push_back(begin == std::string::npos ? "" : cell.substr(begin, end - begin + 1));
  }
  return cells;
}

}  // namespace

Advice Advice::ofThePage() { return Advice(failuresPage()); }

Advice::Advice(const std::string& page) {
  std::istringstream lines(page);
  for (std::string line; std::getline(lines, line);) {
    if (line.compare(0, 3, "| `") != 0) continue;
    const std::vector<std::string> cells = cellsOf(line);
    if (cells.size() != 6) continue;
    std::string& text = by_reason_[plain(cells[0]) + " " + cells[1]];
    const std::string what = plain(cells[5]);
    if (text.find(what) != std::string::npos) continue;
    text += (text.empty() ? "" : "; or: ") + what;
  }
}

std::string Advice::about(const std::string& reason, const std::string& level) const {
  const auto found = by_reason_.find(reason + " " + level);
  return found == by_reason_.end() ? "" : found->second;
}

}  // namespace tccm
