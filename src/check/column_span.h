#pragma once

#include <algorithm>

namespace tccm {

/// The columns of one row of a picture whose rays pass near a shape: a run around that of its
/// centre, hardly another than in the row before. So most columns of what stands all around the
/// viewpoint, as the robot's own body below a head, are never looked at.
class ColumnSpan {
 public:
  /// @param begin, end the window's columns; may run past the last. @param middle column of the
  /// shape's centre.
  ColumnSpan(int begin, int end, int middle, int columns)
      : begin_(begin), end_(end), columns_(columns), is_round_(end - begin == columns) {
    if (is_round_) {
      begin_ = middle - columns / 2;
      end_ = begin_ + columns;
    }
    middle_ = std::clamp(middle < begin_ ? middle + columns : middle, begin_, end_ - 1);
    left_ = right_ = middle_;
  }

  /// To the next row. @param is_near whether a column's ray passes near the shape.
  template <typename IsNear>
  void fit(IsNear&& is_near) {
    const auto holds = [&](int c) { return is_near(wrapped(c)); };
    while (right_ > middle_ && !holds(right_ - 1)) --right_;
    while (right_ < end_ && holds(right_)) ++right_;
    while (left_ < middle_ && !holds(left_)) ++left_;
    while (left_ > begin_ && holds(left_ - 1)) --left_;
  }

  /// One or two runs, in the window's order. @param visit (begin, end)
  template <typename Visit>
  void visit(Visit&& visit) const {
    const int turn = left_ < 0 ? columns_ : left_ >= columns_ ? -columns_ : 0;
    const int left = left_ + turn, right = right_ + turn;
    if (right <= columns_) {
      visit(left, right);
    } else if (is_round_) {  // the last column is between the two
      visit(0, right - columns_);
      visit(left, columns_);
    } else {
      visit(left, columns_);
      visit(0, right - columns_);
    }
  }

 private:
  [[nodiscard]] int wrapped(int c) const {
    return c < 0 ? c + columns_ : c < columns_ ? c : c - columns_;
  }
  int begin_, end_, columns_;
  bool is_round_;
  int middle_;
  int left_, right_;
};

}  // namespace tccm
