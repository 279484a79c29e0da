#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/bytes_of.h"

namespace tccm {

/// Indices below a bound, one bit each: to note what has changed, and to go through it in order.
class IndexSet {
 public:
  explicit IndexSet(std::size_t bound) : bound_(bound), words_((bound + kWord - 1) / kWord, 0) {}

  void insert(std::size_t index) {
    words_[index / kWord] |= std::uint64_t{1} << (index % kWord);
    empty_ = false;
  }
  void insertAll() {
    for (std::size_t i = 0; i < bound_; ++i) insert(i);
  }
  /// All of another of the same bound.
  void insert(const IndexSet& other) {
    for (std::size_t i = 0; i < words_.size(); ++i) words_[i] |= other.words_[i];
    empty_ = empty_ && other.empty_;
  }
  [[nodiscard]] bool has(std::size_t index) const {
    return (words_[index / kWord] >> (index % kWord) & 1U) != 0;
  }
  [[nodiscard]] bool empty() const { return empty_; }
  void clear() {
    if (!empty_) std::fill(words_.begin(), words_.end(), std::uint64_t{0});
    empty_ = true;
  }
  /// @param visit (std::size_t): is handed each index, the lowest first.
  template <typename Visit>
  void visit(Visit&& visit) const {
    for (std::size_t word = 0; word < words_.size(); ++word) {
      for (std::uint64_t left = words_[word]; left != 0; left &= left - 1) {
        visit(word * kWord + static_cast<std::size_t>(__builtin_ctzll(left)));
      }
    }
  }
  [[nodiscard]] std::size_t memoryBytes() const { return bytesOf(words_); }

 private:
  static constexpr std::size_t kWord = 64;
  std::size_t bound_;
  std::vector<std::uint64_t> words_;
  bool empty_ = true;
};

}  // namespace tccm
