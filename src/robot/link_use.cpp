#include "robot/link_use.h"

#include "tccm_monitor/config_error.h"

namespace tccm {

void LinkUse::validate(const Keys& keys) const {
  const auto require = [](const std::string& scale_key, const std::string& padding_key,
                          double scale, double padding_m) {
    requireInRange(scale_key, scale, 1.0, 3.0);
    requireInRange(padding_key, padding_m, 0.0, 1.0);
  };
  require(keys.scale, keys.padding, expansion.scale, expansion.padding_m);
  for (const Exception& exception : exceptions) {
    if (exception.links.empty()) throw ConfigError(keys.exceptions + ": links is missing or empty");
    if (!exception.scale && !exception.padding_m) {
      throw ConfigError(keys.exceptions + ": '" + exception.links.front() +
                        "' has neither scale nor padding_m");
    }
    require(keys.exceptions + "/scale", keys.exceptions + "/padding_m",
            exception.scale.value_or(expansion.scale),
            exception.padding_m.value_or(expansion.padding_m));
  }
}

}  // namespace tccm
