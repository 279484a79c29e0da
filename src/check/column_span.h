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

  /// In the window's order.
  template <typename Visit>
  void visit(Visit&& visit) const {
    const bool is_split = is_round_ && (left_ < 0 || right_ > columns_);
    if (!is_split) {
      for (int c = left_; c < right_; ++c) visit(wrapped(c));
      return;
    }
    const int turn = left_ < 0 ? columns_ : 0;  // the last column is between the two
    for (int c = 0; c < right_ + turn - columns_; ++c) visit(c);
    for (int c = left_ + turn; c < columns_; ++c) visit(c);
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
