#pragma once

#include <ostream>
#include <string>

namespace tccm {

/// Says whether the stop of a bag comes about again, when a checker is told the same.
/// @return the exit status: kDone, or kLimitMissed where it does not.
/// @throws InputError where the file is none of a stop.
[[nodiscard]] int replayStopIn(const std::string& path, std::ostream& out);

}  // namespace tccm
