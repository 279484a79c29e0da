#pragma once

#include <initializer_list>
#include <string>

#include "tccm_monitor/config_error.h"

namespace tccm::simulation {

/// An enumerator by its name. @param names all there are, in the order of the enumerators.
/// @throws ConfigError naming the key and them.
template <typename Enum>
[[nodiscard]] Enum named(const std::string& key, const std::string& name,
                         std::initializer_list<const char*> names) {
  std::string all;
  int value = 0;
  for (const std::string known : names) {
    if (name == known) return static_cast<Enum>(value);
    all += (value++ > 0 ? ", " : "") + known;
  }
  throw ConfigError(key + ": " + name + " is none of " + all);
}

}  // namespace tccm::simulation
