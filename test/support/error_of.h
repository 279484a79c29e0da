#pragma once

#include <functional>
#include <string>

#include "tccm_monitor/config_error.h"

namespace tccm::test {

/// What a configuration is refused with; empty where it is taken.
inline std::string errorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return {};
}

}  // namespace tccm::test
