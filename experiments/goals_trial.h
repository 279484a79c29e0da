#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "experiments/nodelet_guardian.h"
#include "simulation/simulator.h"
#include "tccm_monitor/robot_model.h"

namespace tccm::simulation {

/// Random goals for an arm behind a TrajectoryGate, through the nodelets of a running ROS system:
/// over a cluttered table, while obstacles come and go. Some goals are cancelled, and some
/// replaced.
class GoalsTrial {
 public:
  struct Config {
    CommandedArms::Config arms;  ///< the first controller is that of the goals
    std::string action = "right_arm/follow_joint_trajectory";
    std::string controller = "right_arm_controller";  ///< the arm's own
    std::size_t goals = 25;
    double speed_min_rps = 0.2, speed_max_rps = 0.8;  ///< of the fastest joint
    double obstacle_every_s = 5.0;
    double cancelled_share = 0.15, replaced_share = 0.1;
    double longest_s = 60.0;  ///< for a goal; then it hangs
    double noise_m = 0.01;
    double seen_after_s = 2.2;  ///< what has stood for so long was seen: a tilt, and what it takes
    NodeletGuardian* guardian = nullptr;

    /// @throws ConfigError
    void validate() const;
  };
  struct Goal {
    std::string end;     ///< as actionlib calls the state, "hangs", or "contact"
    std::string reason;  ///< in one word, where it did not succeed
    double took_s = 0.0;
  };
  struct Contact {
    std::string object;
    double hand_mps = 0.0;  ///< of the palm, then
    double stood_s = 0.0;   ///< for how long the object had been in its place; below 0: it moved
    bool avoidable = false;
  };
  struct Result {
    std::uint64_t seed = 0;
    std::vector<Goal> goals;
    std::optional<Contact> contact;  ///< ends the trial
    double simulated_s = 0.0;
  };

  GoalsTrial(const Config& config, std::shared_ptr<const RobotModel> model, std::uint64_t seed);
  ~GoalsTrial();

  [[nodiscard]] Result run();

 private:
  struct Sent;
  struct Parts;

  [[nodiscard]] Simulator::Config simulatorConfig();
  void addObstacles(World& world);
  /// Of the arm's joints, that bring the hand to a random place.
  [[nodiscard]] std::vector<double> randomTarget();
  void send();
  /// @return whether a goal is under way.
  bool followGoals();
  void resetWhatHolds(bool is_held);
  void lookForContact(const RobotSample& robot);

  Config config_;
  std::shared_ptr<const RobotModel> model_;
  std::unique_ptr<Parts> parts_;
  Result result_;
};

}  // namespace tccm::simulation
