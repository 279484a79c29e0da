#pragma once

#include <array>
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace tccm::simulation {

/// How a trial ends in which an arm moves towards something and should stop before it.
enum class Outcome {
  kStopped,     ///< without a contact
  kTouched,     ///< a contact, whatever the monitor said
  kNotStarted,  ///< it never came to the point: the arm was not on its way, or not permitted to be
  kUndecided,   ///< neither until the end
};

/// "stopped", "touched", "not_started" or "undecided".
[[nodiscard]] const char* name(Outcome outcome);

/// How often each came.
class OutcomeCounts {
 public:
  void add(Outcome outcome) { ++counts_[static_cast<std::size_t>(outcome)]; }

  [[nodiscard]] std::size_t of(Outcome outcome) const {
    return counts_[static_cast<std::size_t>(outcome)];
  }
  /// Each under its name.
  void addTo(nlohmann::ordered_json& figures) const;
  /// What should not be at all: those of not_started and undecided that are.
  void addMissed(std::vector<std::string>& missed) const;

 private:
  std::array<std::size_t, 4> counts_{};
};

}  // namespace tccm::simulation
