#pragma once

#include <string>
#include <vector>

namespace tccm::simulation {

/// A table in Markdown, line by line.
class MarkdownTable {
 public:
  enum class Column { kNumber, kText };

  /// Numbers stand at the right of their column, texts at the left.
  void addColumn(const std::string& name, Column column = Column::kNumber) {
    lines_[0] += ' ' + name + " |";
    lines_[1] += column == Column::kNumber ? "---:|" : "---|";
  }
  void addRow(const std::vector<std::string>& cells) {
    std::string& line = lines_.emplace_back("|");
    for (const std::string& cell : cells) line += ' ' + cell + " |";
  }
  [[nodiscard]] const std::vector<std::string>& lines() const { return lines_; }

 private:
  std::vector<std::string> lines_{"|", "|"};
};

}  // namespace tccm::simulation
