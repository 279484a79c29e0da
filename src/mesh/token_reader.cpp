#include "mesh/token_reader.h"

#include <clocale>
#include <cstdlib>
#include <limits>

#include "mesh/printable.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr std::string_view kWhiteSpace = " \t\r\n\f\v";
constexpr std::size_t kNumberLength = 400;  // more digits than any double needs

locale_t plainLocale() {
  static const locale_t locale = newlocale(LC_ALL_MASK, "C", nullptr);
  return locale;
}

}  // namespace

std::string_view TokenReader::peek() const {
  const std::string_view text(text_);
  const std::size_t begin = text.find_first_not_of(kWhiteSpace, position_);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_first_of(kWhiteSpace, begin) - begin);
}

std::string_view TokenReader::next() {
  const std::string_view word = peek();
  position_ = word.empty() ? text_.size()
                           : static_cast<std::size_t>(word.data() - text_.data()) + word.size();
  return word;
}

void TokenReader::skipLine() {
  const std::size_t end = text_.find('\n', position_);
  position_ = end == std::string::npos ? text_.size() : end + 1;
}

std::optional<double> toNumber(std::string_view word) {
  if (word.empty() || word.size() > kNumberLength) return std::nullopt;
  const std::string text(word);
  char* end = nullptr;
  const double value = strtod_l(text.c_str(), &end, plainLocale());
  if (end != text.c_str() + text.size()) return std::nullopt;
  return value;
}

std::optional<std::int64_t> toInteger(std::string_view word) {
  const bool negative = !word.empty() && word.front() == '-';
  const std::string_view digits = word.substr(negative ? 1 : 0);
  if (digits.empty()) return std::nullopt;
  std::int64_t value = 0;
  for (const char digit : digits) {
    if (digit < '0' || digit > '9') return std::nullopt;
    value = 10 * value + (digit - '0');
    if (value > std::numeric_limits<std::int32_t>::max()) return std::nullopt;
  }
  return negative ? -value : value;
}

double readNumber(TokenReader& words, const std::string& what) {
  const std::string_view word = words.next();
  if (const auto value = toNumber(word)) return *value;
  if (word.empty()) throw ConfigError(what + ": it ends where a number should stand");
  throw ConfigError(what + ": '" + printable(std::string(word)) + "' is no number");
}

}  // namespace tccm
