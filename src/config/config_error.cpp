#include "tccm_monitor/config_error.h"

#include <sstream>

namespace tccm {

void requireInRange(const std::string& key, double value, double lowest, double highest) {
  if (value >= lowest && value <= highest) return;  // false for NaN
  std::ostringstream message;
  message << key << ": " << value << " is outside the allowed range [" << lowest << ", " << highest
          << "]";
  throw ConfigError(message.str());
}

}  // namespace tccm
