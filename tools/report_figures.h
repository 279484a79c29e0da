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

/// A stretch of checks that all said stop, for whatever reasons.
struct Stop {
  std::vector<const StopRun*> runs;  ///< of one reason each, in order
  Duration length{0};                ///< without what a jump of time would add
};
/// Valid as long as the totals.
[[nodiscard]] std::vector<Stop> stopsOf(const Totals& totals);
/// Worse reasons are larger; of one reason the first.
[[nodiscard]] const StopRun& gravestOf(const Stop& stop);
/// Each reason and link once, in the order in which they came; empty where there is but one.
[[nodiscard]] std::string inTurn(const Stop& stop);
/// The summary's list of what the stops were for, one entry a reason.
[[nodiscard]] nlohmann::ordered_json stopSegmentsOf(const Totals& totals);

}  // namespace tccm
