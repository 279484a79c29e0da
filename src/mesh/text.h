#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

/// Text of files that others wrote: its words and numbers.
namespace tccm {

/// Walks through a text's words, which white space parts. Numbers are read alike in every locale.
/// The text has to outlive the reader.
class TokenReader {
 public:
  explicit TokenReader(std::string_view text) : text_(text) {}

  /// The next word; empty at the end.
  std::string_view next();
  /// The next word without stepping on.
  [[nodiscard]] std::string_view peek() const;
  void skipLine();
  [[nodiscard]] std::size_t position() const { return position_; }

 private:
  std::string_view text_;
  std::size_t position_ = 0;
};

/// Nothing unless the whole word is a number; NaN and infinity are numbers.
[[nodiscard]] std::optional<double> toNumber(std::string_view word);
/// Nothing unless the whole word is an integer of 32 bits.
[[nodiscard]] std::optional<std::int32_t> toInteger(std::string_view word);

/// @throws ConfigError naming what the next word should have been.
[[nodiscard]] double readNumber(TokenReader& words, const std::string& what);

}  // namespace tccm
