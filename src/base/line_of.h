#pragma once

#include <cstdarg>
#include <cstdio>
#include <string>

namespace tccm {

/// One line for people: a printf of at most 400 characters.
[[nodiscard, gnu::format(printf, 1, 2)]] inline std::string lineOf(const char* format, ...) {
  char text[400];
  va_list values;
  va_start(values, format);
  std::vsnprintf(text, sizeof text, format, values);
  va_end(values);
  return text;
}

}  // namespace tccm
