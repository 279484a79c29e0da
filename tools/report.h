#pragma once

#include <fstream>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>

#include "evaluation.h"
#include "program.h"

namespace tccm {

/// A CSV file that somebody asked for, with its header line. Positions carry 6 decimals [m].
class CsvFile {
 public:
  /// @throws InputError where the file cannot be written.
  CsvFile(const std::string& path, const std::string& header);

  /// One line. Arguments as of printf. @throws InputError where the disk is full.
  template <typename... Values>
  void line(const char* format, Values... values) {
    char text[512];
    const int length = std::snprintf(text, sizeof text, format, values...);
    if (length < static_cast<int>(sizeof text)) {
      write(text, length);
    } else {
      write(formatted(format, values...));
    }
  }
  /// @throws InputError where not all of it could be written.
  void close();

 private:
  void write(const char* text, int length);
  void write(const std::string& text) { write(text.data(), static_cast<int>(text.size())); }

  std::string path_;
  std::ofstream stream_;
};

/// The points of a sensor's newest scan as its map took them: scan,x,y,z.
void dumpPoints(const Monitor& monitor, std::size_t sensor, CsvFile& file);
/// The live cuboids: x,y,bottom,top,age_scans,dyn,held; x and y of the cell's centre.
void dumpCuboids(const CuboidMap& map, CsvFile& file);
/// One check: stamp,scan,collision,occlusion,stop,reason,link. No stamp where no joint was known.
void dumpVerdict(const Verdict& verdict, CsvFile& file);

/// One check, a line for each link that is watched for occlusion or whose way is watched, at the
/// present pose and, for the former, at the one ahead:
/// stamp,scan,link,ahead,visible,occluded,unseen,way_unseen,evidence_age_s,next_look_s. Empty where
/// something is not known or not watched, no line where the robot was not placed. The stamp is the
/// check's.
void dumpVisibility(const Verdict& verdict, const Checker& checker, CsvFile& file);

/// All figures of a run but how long things took: the same in each run.
[[nodiscard]] nlohmann::ordered_json summaryOf(const Evaluation& evaluation,
                                               const MonitorConfig& settings);
/// How long things took. @param each besides the percentiles, of each check after a scan.
[[nodiscard]] nlohmann::ordered_json timesOf(const Totals& totals, bool each);
/// Either for people, in a few lines.
void printSummary(const nlohmann::ordered_json& summary, std::ostream& out);
void printTimes(const nlohmann::ordered_json& timing, std::ostream& out);
/// A line for each of the first 20 stops: when, for how long, reason, link and detail.
void printStops(const Totals& totals, std::ostream& out);
/// Why a sensor's scans were dropped for that reason, and what to set.
[[nodiscard]] std::string dropText(const Evaluation& evaluation, const MonitorConfig& settings,
                                   std::size_t sensor, const std::string& reason);
/// One line: why the scans were dropped, and what to set. @pre no scan was mapped
[[nodiscard]] std::string whyNothingMapped(const Evaluation& evaluation,
                                           const MonitorConfig& settings);

}  // namespace tccm
