#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "check/collision_check.h"
#include "config/parameter_table.h"
#include "tccm_monitor/robot_model.h"
#include "tccm_monitor/verdict.h"

namespace tccm {

/// The exemptions that were asked for: by link and region, timed, named; there is none for
/// everything. Which of them are in force, and where their regions are.
///
/// A region stays where it is in the fixed frame, moves with one of the robot's links, or lies
/// where the newest transform of a frame puts it.
class Exemptions {
 public:
  struct Config {
    double duration_max_s = 60.0;
    int count_max = 32;

    void describe(ParameterTable& table);
  };
  /// Of transforms that place regions.
  struct Limits {
    double timeout_s = 0.5;
    double future_max_s = 0.5;
  };
  /// Goals that are known at once; of more the oldest counts as ended.
  static constexpr std::size_t kGoalsMax = 64;

  /// @throws ConfigError
  explicit Exemptions(const Config& config) : config_(validated(config)) {}

  /// One of the same owner for the same link is replaced. It is in force from the next update() on.
  /// @param duration_s 0 ends it. @throws ConfigError naming what is wrong; then nothing changes.
  void add(Time now, const Exemption& exemption, double duration_s, const RobotModel& model);
  /// @param link as it was added; empty: all of that owner. @return how many have ended.
  std::size_t lift(const std::string& owner, const std::string& link);
  /// A goal of an owner begins or ends; what waited for its begin counts from now on, and ends with
  /// the last goal of that owner. A slash in front of an owner makes no difference here.
  /// @param goal names it. Where it ends, empty: all goals of that owner.
  /// @throws ConfigError where owner or goal have no name.
  void reportGoal(Time now, const std::string& owner, const std::string& goal, bool under_way);
  /// What transforms say of a frame. @param is_static it never grows old.
  void setFrame(const std::string& frame, Time stamp, const Pose& T_fixed_frame, bool is_static);
  /// Ends those whose time is over, and looks which of the others are in force.
  /// @return whether any ended.
  bool update(Time now, const Limits& limits);
  void clear();

  /// As the last update() found them.
  [[nodiscard]] const std::vector<Exemption>& list() const { return list_; }
  /// Of each in the list.
  [[nodiscard]] const std::vector<ExemptRegion>& regions() const { return regions_; }
  /// The same, and for each of the shapes which of them are for it; no shapes where there is no
  /// exemption at all.
  [[nodiscard]] ExemptRegions regionsOf(const RobotModel& model,
                                        const std::vector<std::size_t>& shapes) const;
  /// The frames that transforms have to place, each once.
  [[nodiscard]] std::vector<std::string> frames() const;

 private:
  struct Goal {
    std::string owner, id;
  };
  /// What else there is to know of an exemption.
  struct Anchor {
    Duration duration{0};  ///< from when it counts
    bool begun = true;     ///< it waits for no goal
    bool by_transform = false;
    bool placed = false;  ///< the frame was heard of
    bool is_static = false;
    Time stamp = {};  ///< of the frame's newest transform
  };
  void begin(Time now, std::size_t i);
  void erase(std::size_t i);
  [[nodiscard]] bool hasGoal(const std::string& owner) const;
  /// @return whether any goal ended.
  bool endGoals(const std::string& owner, const std::string& id);
  void endWithGoalsOf(const std::string& owner);
  [[nodiscard]] Exemption::State stateOf(Time now, const Limits& limits, std::size_t i) const;

  Config config_;
  // Of each exemption:
  std::vector<Exemption> list_;
  std::vector<Anchor> anchors_;
  std::vector<ExemptRegion> regions_;

  std::vector<Goal> goals_;  ///< under way, the oldest first
};

/// Why an exemption is not in force, for people; empty where it is.
[[nodiscard]] std::string whyNotInForce(const Exemption& exemption,
                                        const Exemptions::Limits& limits);

}  // namespace tccm
