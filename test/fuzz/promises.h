#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>

#include "tccm_monitor/config_error.h"

/// What every reader of files promises on whatever input.
namespace tccm::test {

/// A promise that was broken.
class BrokenPromise : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

inline void promise(bool kept, const std::string& what) {
  if (!kept) throw BrokenPromise(what);
}

/// An error's text is one line of bearable length, without control characters.
inline void requireOneLine(const std::string& message) {
  promise(!message.empty(), "an error's text is empty");
  promise(message.size() < 2000, "an error's text is longer than a line: " + message);
  promise(std::none_of(message.begin(), message.end(),
                       [](unsigned char c) { return c < 0x20U || c == 0x7fU; }),
          "an error's text is not one line: " + message);
}

/// What `read` broke of its promises, or nothing: it may throw ConfigError of one line alone.
template <typename Read>
std::string brokenPromise(const Read& read) {
  try {
    try {
      read();
    } catch (const ConfigError& error) {
      requireOneLine(error.what());
    }
  } catch (const std::exception& error) {
    return error.what();
  }
  return {};
}

}  // namespace tccm::test
