#pragma once

#include <set>
#include <string>
#include <vector>

#include "ros/planner_objects.h"

namespace tccm {

/// What has to be attached and detached so that the monitor holds what a planner does. The
/// monitor's rules stand: what it refuses is asked for again later, at most once between two calls
/// of askAgain(). What others have attached is left alone.
class AttachedMirror {
 public:
  void plan(HeldShapes planned) {
    planned_ = std::move(planned);
    for (const auto& entry : planned_) ours_.insert(entry.first);
    refused_.clear();  // what is refused may be another shape now
    forgetGone();
  }
  /// What the monitor holds. It forgets when it starts anew.
  void hear(HeldShapes held) {
    held_ = std::move(held);
    is_heard_ = true;
    forgetGone();
  }
  void askAgain() { refused_.clear(); }

  /// Names. Nothing is while the monitor was not heard of.
  [[nodiscard]] std::vector<std::string> toAttach() const {
    std::vector<std::string> names;
    for (const auto& [name, shape] : planned_) {
      const auto held = held_.find(name);
      const bool is_held = held != held_.end() && held->second == shape;
      if (is_heard_ && !is_held && refused_.count(name) == 0) names.push_back(name);
    }
    return names;
  }
  [[nodiscard]] std::vector<std::string> toDetach() const {
    std::vector<std::string> names;
    for (const std::string& name : ours_) {
      const bool is_wanted = held_.count(name) == 0 || planned_.count(name) > 0;
      if (is_heard_ && !is_wanted && refused_.count(name) == 0) names.push_back(name);
    }
    return names;
  }
  [[nodiscard]] const HeldShape& planned(const std::string& name) const {
    return planned_.at(name);
  }

  // What the monitor answered:

  void attached(const std::string& name) { held_[name] = planned_.at(name); }
  void detached(const std::string& name) {
    held_.erase(name);
    ours_.erase(name);
  }
  void refused(const std::string& name) { refused_.insert(name); }

 private:
  /// What is neither planned nor held may be another's next time.
  void forgetGone() {
    for (auto name = ours_.begin(); is_heard_ && name != ours_.end();) {
      const bool is_gone = planned_.count(*name) + held_.count(*name) == 0;
      name = is_gone ? ours_.erase(name) : std::next(name);
    }
  }

  HeldShapes planned_, held_;
  bool is_heard_ = false;
  std::set<std::string> ours_;     ///< that were planned, as long as they are held
  std::set<std::string> refused_;  ///< not to be asked for now
};

}  // namespace tccm
