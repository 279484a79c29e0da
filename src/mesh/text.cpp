#include "mesh/text.h"

#include <algorithm>
#include <charconv>
#include <clocale>
#include <cstdlib>

#include "base/printable.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr std::string_view kWhiteSpace = " \t\r\n\f\v";
constexpr std::size_t kNumberLength = 400;  // more digits than any double needs

}  // namespace

std::string_view TokenReader::peek() const {
  const std::size_t begin = std::min(text_.find_first_not_of(kWhiteSpace, position_), text_.size());
  return text_.substr(begin, text_.find_first_of(kWhiteSpace, begin) - begin);
}

std::string_view TokenReader::next() {
  const std::string_view word = peek();
  position_ = static_cast<std::size_t>(word.data() - text_.data()) + word.size();
  return word;
}

void TokenReader::skipLine() { position_ = std::min(text_.find('\n', position_), text_.size()); }

std::optional<double> toNumber(std::string_view word) {
  static const locale_t kPlain = newlocale(LC_ALL_MASK, "C", nullptr);
  if (word.empty() || word.size() > kNumberLength) return std::nullopt;
  const std::string text(word);
  char* end = nullptr;
  const double value = strtod_l(text.c_str(), &end, kPlain);
  if (end != text.c_str() + text.size()) return std::nullopt;
  return value;
}

std::optional<std::int32_t> toInteger(std::string_view word) {
  std::int32_t value = 0;
  const char* const end = word.data() + word.size();
  const auto [rest, error] = std::from_chars(word.data(), end, value);
  if (error != std::errc() || rest != end) return std::nullopt;
  return value;
}

double readNumber(TokenReader& words, const std::string& what) {
  const std::string_view word = words.next();
  if (const auto value = toNumber(word)) return *value;
  if (word.empty()) throw ConfigError(what + ": it ends where a number should stand");
  throw ConfigError(what + ": '" + printable(word) + "' is no number");
}

}  // namespace tccm
