#include "experiments/outcome.h"

#include <nlohmann/json.hpp>

namespace tccm::simulation {

const char* name(Outcome outcome) {
  constexpr std::array kNames = {"stopped", "touched", "not_started", "undecided"};
  return kNames[static_cast<std::size_t>(outcome)];
}

void OutcomeCounts::addTo(nlohmann::ordered_json& figures) const {
  for (const Outcome outcome :
       {Outcome::kStopped, Outcome::kTouched, Outcome::kNotStarted, Outcome::kUndecided}) {
    figures[name(outcome)] = of(outcome);
  }
}

void OutcomeCounts::addMissed(std::vector<std::string>& missed) const {
  for (const Outcome outcome : {Outcome::kNotStarted, Outcome::kUndecided}) {
    if (of(outcome) > 0) missed.emplace_back(name(outcome));
  }
}

}  // namespace tccm::simulation
