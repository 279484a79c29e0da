#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "evaluation.h"
#include "ros/stop_cause.h"

namespace tccm {

/// Scenes of the stops of an evaluation, for pictures: of each stop's first check, and of the first
/// for each further reason and link, the gravest among them. Of what nothing can be drawn yet, the
/// first of which something can. As Totals::stop_runs has stops.
class StopScenes {
 public:
  static constexpr std::size_t kStopsMax = 50;  ///< that have scenes
  static constexpr std::size_t kScenesMax = 5;  ///< of a stop

  /// To be told each verdict. @param start of the recording
  void add(const Verdict& verdict, const Checker& checker, Time start);
  /// The stops with their scenes and what helps, and what is there at the end.
  /// @param interrupted the recording went on.
  [[nodiscard]] nlohmann::ordered_json json(const Evaluation& evaluation,
                                            const MonitorConfig& settings, bool interrupted) const;

 private:
  struct Scene {
    Reason reason;
    std::string link;
    bool is_placed;  ///< the robot is in it
    nlohmann::ordered_json json;
  };
  /// One of the stop that a verdict's takes the place of: nothing new, or new to all of them.
  [[nodiscard]] static std::optional<std::size_t> placeFor(const Verdict& verdict,
                                                           const std::vector<Scene>& scenes);

  std::vector<std::vector<Scene>> stops_;  ///< in the order of time
  StopCause cause_;
  bool stopped_ = false;  ///< by the last check
  bool full_ = false;
  bool was_placed_ = false;
};

}  // namespace tccm
