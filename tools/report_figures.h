#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

#include "evaluation.h"

namespace tccm {

/// To six decimals.
[[nodiscard]] double rounded(double value);
/// Null of nothing: no checks are not "never a collision".
[[nodiscard]] nlohmann::ordered_json fraction(std::size_t part, std::size_t whole);
/// Seconds since 1970, with all nanoseconds.
[[nodiscard]] std::string stampText(Time stamp);

/// The summary's section of what the sensor did not see. @param newest map; null where there is
/// none.
[[nodiscard]] nlohmann::ordered_json sightOf(const Totals& totals, const CuboidMap* newest);

}  // namespace tccm
