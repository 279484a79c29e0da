#pragma once

#include <string>

#include "check/checker_config.h"
#include "report.h"

namespace tccm {

/// What evaluation found over time, as CSV, a row a check:
/// stamp,time_s,level,reason,link,clearance_m,visible,map_age_s,joints_age_s,speed_scale. The time
/// is since the recording's first message; empty is what is not known. `visible` is the lowest of
/// all watched links, the map's age that of the sensor whose newest scan is oldest.
class Timeline {
 public:
  /// @throws InputError where the file cannot be written.
  explicit Timeline(const std::string& path);

  /// @param start of the recording. @throws InputError where the disk is full.
  void add(const Verdict& verdict, const Checker& checker, Time start);
  /// @throws InputError where not all of it could be written.
  void close() { file_.close(); }

 private:
  CsvFile file_;
};

}  // namespace tccm
