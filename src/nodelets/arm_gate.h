#pragma once

#include <actionlib/server/action_server.h>
#include <control_msgs/FollowJointTrajectoryAction.h>
#include <ros/ros.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gate/gate_config.h"
#include "nodelets/arm_driver.h"
#include "nodelets/joint_positions.h"
#include "nodelets/trajectory_questions.h"

namespace tccm {

/// The action in front of one arm's controller: a goal is checked and then done as far and as fast
/// as is permitted. However a goal ends, the arm is held and the goal has its result; it is never
/// resumed. One goal at a time: a new one takes the place of the one before, once the arm stands.
class ArmGate {
 public:
  /// What the gates of one node share.
  struct Shared {
    JointPositions& joints;
    const PermissionGate& permission;
    TrajectoryQuestions& questions;
    ros::Publisher& trajectory;       ///< for the monitor
    ros::Publisher& execution_event;  ///< of planners; may be none
    const int& guards;                ///< so many hear whether arms move
  };

  /// @param node of the gate's namespace. @param rules of the controller downstream.
  ArmGate(const ros::NodeHandle& node, const GateConfig& config,
          const GateConfig::Controller& controller, const GoalRules::Config& rules, Shared shared);
  /// Holds the arm, and ends its goals.
  ~ArmGate();

  /// At the configured rate, and when a permission has come.
  void step(const Instant& now);
  /// A goal is being done, which the arm's controller would go on with alone.
  [[nodiscard]] bool isMoving() const { return forwards_ && active_; }
  /// What is wrong with the arm, in one line; empty where nothing is.
  [[nodiscard]] const std::string& fault() const { return fault_; }

 private:
  using Server = actionlib::ActionServer<control_msgs::FollowJointTrajectoryAction>;
  using Handle = Server::GoalHandle;
  using Result = control_msgs::FollowJointTrajectoryResult;
  /// A goal that was not begun yet.
  struct Pending {
    Handle handle;
    control_msgs::FollowJointTrajectoryGoal goal;
    JudgedGoal judged;
    std::shared_ptr<void> reported;                                 ///< once the arm stands
    std::shared_ptr<const TrajectoryQuestions::Question> question;  ///< the same
    std::chrono::nanoseconds asked{0};
    std::optional<std::chrono::nanoseconds> told{};  ///< to the monitor, to be permitted
  };

  /// The name of the node that has sent it.
  [[nodiscard]] static std::string ownerOf(const Handle& handle);
  void hearGoal(Handle handle);
  /// A node listens to the action, or does not any more: a goal does not outlive its owner.
  void hearListener(const std::string& name, int change);
  void hearCancel(const Handle& handle);
  /// Where the joints are. @return why that is not known; empty where it is.
  [[nodiscard]] std::string readJoints(Time now);
  /// Whether the arm has not moved for a while, by its positions: velocities may be noise.
  void watchRest(const Instant& now);
  [[nodiscard]] bool isAtRest(const Instant& now) const;
  /// The arm was told to halt, and does not: it is told again.
  void watchHold(const Instant& now);
  void stepPending(const Instant& now);
  void stepActive(const Instant& now);
  /// Why the arm cannot be moved, whatever is permitted; empty where it can.
  [[nodiscard]] std::string objection(const Instant& now);
  /// @return why it cannot be begun; empty where it is, or has to wait.
  [[nodiscard]] std::string beginIfPermitted(const Instant& now);
  void begin(const Instant& now);
  void publishFeedback(const Instant& now);
  /// The monitor is told what is being done.
  void tell(const JointTrajectory& way, Time start);
  void tellNothing();
  /// The controller stops, and the monitor is told so.
  void hold(const Instant& now);
  void reject(std::int32_t code, const std::string& why);
  void cancelPending(const std::string& why);
  void finish(GatedMotion::End end, const std::string& why, const Instant& now);
  void abort(std::int32_t code, const std::string& why, const Instant& now);
  void succeed();

  GateConfig config_;
  std::string name_;
  bool forwards_;
  GoalRules rules_;
  Shared shared_;
  std::vector<const JointPositions::Joint*> watched_;  ///< one for each of the controller's joints
  std::vector<double> positions_, velocities_;         ///< the same
  std::vector<double> told_velocities_;                ///< the same, or empty where one is not told
  std::vector<double> rest_;                           ///< where it has not moved away from
  std::chrono::nanoseconds rests_since_{0};
  GatedMotion motion_;
  std::optional<Handle> active_;
  std::shared_ptr<void> reported_;  ///< that it is under way
  std::optional<Pending> pending_;
  std::optional<std::chrono::nanoseconds> held_;  ///< when the arm was last told to stop
  int holds_ = 0;                                 ///< so often in a row
  std::string fault_;
  Time feedback_due_;
  control_msgs::FollowJointTrajectoryFeedback feedback_;  ///< reused
  std::unique_ptr<ArmDriver> driver_;
  std::map<std::string, int> listeners_;  ///< to the action's status, by node
  Server server_;
  ros::Publisher status_;  ///< the server's: tells who listens
};

}  // namespace tccm
