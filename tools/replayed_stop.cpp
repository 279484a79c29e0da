#include "replayed_stop.h"

#include "program.h"
#include "report_figures.h"
#include "ros/stops/stop_replay.h"

namespace tccm {
namespace {

constexpr double kShort_s = 1.5;  // after which a checker that begins anew knows what it has to

std::string textOf(const StopReplay::Found& found) {
  return std::string(found.stop ? "STOP " : "no stop: ") + found.reason +
         (found.link.empty() ? "" : " of '" + found.link + "'") +
         (found.detail.empty() ? "" : ": " + found.detail);
}

StopReplay replayOf(const std::string& path) {
  try {
    return replayStop(path);
  } catch (const std::exception& error) {
    throw InputError(path + ": " + error.what());
  }
}

}  // namespace

int replayStopIn(const std::string& path, std::ostream& out) {
  const StopReplay replay = replayOf(path);
  out << formatted("stop     at %s, after %.1f s with %zu checks\n",
                   stampText(replay.recorded.stamp).c_str(), replay.seconds, replay.checks)
      << "recorded " << textOf(replay.recorded) << "\nreplayed " << textOf(replay.replayed) << '\n';
  const bool is_same = replay.recorded == replay.replayed;
  out << (is_same ? "the same verdict" : "NOT the same verdict")
      << formatted("; %zu of %zu checks found the same", replay.same, replay.checks) << std::endl;
  if (!is_same && replay.seconds < kShort_s) {
    out << formatted("%.1f s are too short for a replay: raise collision_checker/stops_memory_mb\n",
                     replay.seconds);
  }
  return is_same ? kDone : kLimitMissed;
}

}  // namespace tccm
