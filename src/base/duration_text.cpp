#include "base/duration_text.h"

#include "base/line_of.h"

namespace tccm {

std::string durationText(Duration duration) {
  struct Unit {
    const char* name;
    double seconds;
  };
  constexpr Unit kUnits[] = {
      {"years", 31557600.0}, {"days", 86400.0}, {"h", 3600.0}, {"min", 60.0}, {"s", 1.0}};
  const double seconds = toSeconds(duration);
  for (const Unit& unit : kUnits) {
    const double count = seconds / unit.seconds;
    if (count >= 1.995) return lineOf(count < 9.95 ? "%.1f %s" : "%.0f %s", count, unit.name);
  }
  return lineOf("%.0f ms", 1e3 * seconds);
}

std::string stampText(Time stamp, Time now) {
  if (stamp == Time()) return "its stamp is 0: whoever publishes it sets none";
  const bool is_ahead = stamp > now;
  return "its stamp is " + durationText(is_ahead ? stamp - now : now - stamp) +
         (is_ahead ? " ahead of the monitor's clock" : " behind the monitor's clock");
}

}  // namespace tccm
