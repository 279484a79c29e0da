#pragma once

#include <diagnostic_msgs/DiagnosticArray.h>
#include <tccm_monitor/MonitorStatus.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tccm {

/// A line of the panel.
struct TextRow {
  std::string name, text;
};

[[nodiscard]] std::string levelName(std::uint8_t level);

/// Why it is as it is: of a stop what brought it about and, where that is over, what holds it.
[[nodiscard]] std::string reasonOf(const tccm_monitor::MonitorStatus& status);
/// The detail of what brought a stop about, else of the reason.
[[nodiscard]] std::string detailOf(const tccm_monitor::MonitorStatus& status);

/// What a status says besides level, reason and detail, one line a fact, always the same lines.
[[nodiscard]] std::vector<TextRow> rowsOf(const tccm_monitor::MonitorStatus& status);

/// Whether `reset` would be refused: a fault or a contact lasts.
[[nodiscard]] bool refusesReset(const tccm_monitor::MonitorStatus& status);

/// The last stop that was heard of: many are over before anybody has read them. What stops a robot
/// before it could move for the first time is none.
class LastStop {
 public:
  /// To be told each status. @param now_s on a clock that never jumps [s].
  void take(const tccm_monitor::MonitorStatus& status, double now_s);

  /// Why, which link, and how long ago.
  [[nodiscard]] std::string text(double now_s) const;

 private:
  std::string reason_, link_;
  double at_s_ = 0.0;  ///< when it was there last
  bool lasts_ = false;
  bool could_move_ = false;
};

/// The health of the sensors' nodelets in a namespace, as they tell it on /diagnostics.
class SensorHealth {
 public:
  static constexpr double kSilence_s = 3.0;  ///< after which one is silent

  /// @param name_space absolute. Forgets what was heard.
  explicit SensorHealth(const std::string& name_space = "/");

  /// @param now_s on a clock that never jumps [s].
  void take(const diagnostic_msgs::DiagnosticArray& message, double now_s);

  struct Line {
    std::uint8_t level;  ///< of diagnostic_msgs/DiagnosticStatus
    std::string name;    ///< the nodelet's, in the namespace
    std::string text;
  };
  [[nodiscard]] std::vector<Line> lines(double now_s) const;

 private:
  struct Heard {
    std::uint8_t level;
    std::string text;
    double at_s;
  };
  std::string prefix_;
  std::map<std::string, Heard> heard_;
};

}  // namespace tccm
