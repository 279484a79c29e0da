#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tccm_monitor/cuboid_map.h"
#include "tccm_monitor/verdict.h"

namespace tccm {

/// "OK", "SLOW", "STOP" or "FAULT".
[[nodiscard]] const char* name(Level level);

/// A cuboid, and why: col as in Cuboid.msg.
struct Flagged {
  std::uint32_t cuboid;
  std::uint8_t col;
};
/// What links touch, or hide behind, at the present pose and at the end of the way ahead.
[[nodiscard]] std::vector<Flagged> flaggedBy(const Verdict& verdict);

/// A cuboid's box, and its col as in Cuboid.msg.
using FlaggedBox = std::pair<UprightBox, std::uint8_t>;

/// Of what links touch, or hide behind. @param map that the verdict rests on.
[[nodiscard]] std::vector<FlaggedBox> flaggedBoxes(const Verdict& verdict, const CuboidMap& map);

/// What brought a stop about, kept while the stop lasts: people see nothing that is over within a
/// few hundredths of a second.
class StopCause {
 public:
  /// To be told each verdict. @param map that it rests on; null where there is none.
  void follow(const Verdict& verdict, const CuboidMap* map);

  /// Whether the stop lasts although nothing is found any more.
  [[nodiscard]] bool outlives(const Verdict& verdict) const;
  [[nodiscard]] Reason reason() const { return reason_; }
  [[nodiscard]] const std::string& detail() const { return detail_; }
  /// What was touched, or hid a link.
  [[nodiscard]] const std::vector<FlaggedBox>& boxes() const { return boxes_; }

 private:
  Reason reason_ = Reason::kClear;  ///< no stop lasts
  std::string detail_;
  std::vector<FlaggedBox> boxes_;
};

/// Which verdicts people are told of: each change, but what comes and goes many times a second, as
/// a contact does, only once, and anew when it has been there or away for a second. Each stop is
/// told.
class ToldChanges {
 public:
  /// To be asked of each verdict.
  [[nodiscard]] bool isNews(const Verdict& verdict);

 private:
  struct What {
    Level level;
    Reason reason;
    bool operator==(const What& other) const {
      return level == other.level && reason == other.reason;
    }
  };
  std::optional<What> told_, current_;
  Time since_;            ///< the current one
  bool is_back_ = false;  ///< it was there a moment before
  bool is_of_stop_ = false;
  /// When each reason was there last, of this stop or of the time between two.
  std::array<std::optional<Time>, static_cast<std::size_t>(Reason::kBadQuestion) + 1> seen_;
};

}  // namespace tccm
