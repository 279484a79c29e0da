#pragma once

#include <stdexcept>
#include <string>

namespace tccm {

/// A configuration that must not be run with. what() names key, value and what is allowed, in one
/// line.
class ConfigError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// @throws ConfigError "key: value is outside [lowest, highest]" unless value is finite and inside.
void requireInRange(const std::string& key, double value, double lowest, double highest);

}  // namespace tccm
