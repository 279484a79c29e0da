/// An arm's controller client that obeys tccm_monitor's permission, to be copied from.

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/String.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "guarded_motion.h"
#include "tccm_monitor/CheckTrajectory.h"

namespace tccm::example {
namespace {

constexpr char kUsage[] =
    R"(usage: controller_client [--help] [NAME:=VALUE ...]

Moves an arm along goals, and only as long as the monitor permits it.

  goal               in: trajectory_msgs/JointTrajectory; without points: cancels
  motion_permission  in: tccm_monitor/MotionPermission
  joint_states       in: sensor_msgs/JointState
  check_trajectory   asked before a goal is begun; only FREE will do
  trajectory         out: what is being done, for the monitor; without points: nothing any more
  command            out: setpoints for the arm's controller; without points: stop and hold
  client_state       out: std_msgs/String, IDLE, CHECKING, MOVING, HELD or REFUSED and why; latched

Once held, it waits for a new goal. All names can be remapped. Private parameters:
  _rate_hz             of the setpoints, 100 to 1000 (200)
  _lookahead_s         setpoints are to be reached so much later (0.04)
  _scale_change_per_s  how fast the scale of the speed may change (4)
  _start_tolerance     between the joints and a goal's point at time 0, rad or m (0.01)
)";

struct Config {
  GuardedMotion::Config motion;
  double rate_hz = 200.0;
  double start_tolerance = 0.01;
};

Config readConfig() {
  const ros::NodeHandle node("~");
  Config config;
  node.param("rate_hz", config.rate_hz, config.rate_hz);
  node.param("lookahead_s", config.motion.lookahead_s, config.motion.lookahead_s);
  node.param("scale_change_per_s", config.motion.scale_change_per_s,
             config.motion.scale_change_per_s);
  node.param("start_tolerance", config.start_tolerance, config.start_tolerance);
  requireInRange("rate_hz", config.rate_hz, 100.0, 1000.0);
  requireInRange("start_tolerance", config.start_tolerance, 0.0, 1.0);
  return config;
}

class ControllerClient {
 public:
  explicit ControllerClient(const Config& config)
      : config_(config), motion_(config.motion), goal_spinner_(2, &goal_queue_) {
    command_ = node_.advertise<trajectory_msgs::JointTrajectory>("command", 10);
    trajectory_ = node_.advertise<trajectory_msgs::JointTrajectory>("trajectory", 10);
    state_ = node_.advertise<std_msgs::String>("client_state", 10, true);
    check_ = node_.serviceClient<tccm_monitor::CheckTrajectory>("check_trajectory");
    const auto hints = ros::TransportHints().tcpNoDelay();
    permission_ = node_.subscribe("motion_permission", 10, &ControllerClient::hear, this, hints);
    joints_ = node_.subscribe("joint_states", 10, &ControllerClient::hearJoints, this, hints);
    // While a goal is checked, permissions and cancelling goals are heard all the same.
    ros::SubscribeOptions goal = ros::SubscribeOptions::create<trajectory_msgs::JointTrajectory>(
        "goal", 10, [this](const auto& message) { hearGoal(*message); }, {}, &goal_queue_);
    goal.allow_concurrent_callbacks = true;
    goal_ = node_.subscribe(goal);
    // Of the wall clock: it goes on where simulated time stands still.
    timer_ = node_.createSteadyTimer(ros::WallDuration(1.0 / config.rate_hz),
                                     [this](const ros::SteadyTimerEvent&) {
                                       with([this] { return motion_.step(Instant::now()); });
                                     });
    with([] { return GuardedMotion::Output(); });
    goal_spinner_.start();
  }

 private:
  /// Does something to the motion and publishes what comes of it.
  void with(const std::function<GuardedMotion::Output()>& action) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const GuardedMotion::Output output = action();
    if (output.command) command_.publish(*output.command);
    if (output.trajectory) trajectory_.publish(*output.trajectory);
    tellState();
  }

  void tellState() {
    const std::string text = motion_.stateText();
    if (text == told_) return;
    told_ = text;
    std_msgs::String message;
    message.data = text;
    state_.publish(message);
    const bool bad = motion_.state() == GuardedMotion::State::kHeld ||
                     motion_.state() == GuardedMotion::State::kRefused;
    ROS_LOG(bad ? ros::console::levels::Warn : ros::console::levels::Info, ROSCONSOLE_DEFAULT_NAME,
            "%s", text.c_str());
  }

  void hear(const tccm_monitor::MotionPermission::ConstPtr& permission) {
    with([&] { return motion_.hear(*permission, Instant::now()); });
  }

  void hearJoints(const sensor_msgs::JointState::ConstPtr& message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (std::size_t i = 0; i < std::min(message->name.size(), message->position.size()); ++i) {
      positions_[message->name[i]] = message->position[i];
    }
  }

  void hearGoal(const trajectory_msgs::JointTrajectory& goal) {
    if (goal.points.empty()) {
      with([this] { return ++goals_, motion_.cancel(); });
      return;
    }
    unsigned number = 0;
    const std::optional<GoalPath> path = accept(goal, number);
    if (!path) return;
    const std::string complaint = check(*path);
    with([&]() -> GuardedMotion::Output {
      if (number != goals_) return {};  // it was cancelled meanwhile
      const bool stands = path->startsAt(positions_, config_.start_tolerance);
      if (complaint.empty() && stands) return motion_.start(*path, Instant::now());
      motion_.refuse(stands ? complaint : "the joints moved meanwhile");
      return {};
    });
  }

  /// @param number is set to the goal's. @return nothing where the goal cannot be followed.
  std::optional<GoalPath> accept(const trajectory_msgs::JointTrajectory& goal, unsigned& number) {
    std::optional<GoalPath> path;
    with([&]() -> GuardedMotion::Output {
      if (motion_.busy()) {
        ROS_WARN("A goal came while another is not done; it is ignored.");
        return {};
      }
      number = ++goals_;
      motion_.beginCheck();
      tellState();
      try {
        path.emplace(goal, positions_, config_.start_tolerance);
      } catch (const std::invalid_argument& error) {
        motion_.refuse(error.what());
      }
      return {};
    });
    return path;
  }

  /// @return why the arm may not go there; empty where it may.
  std::string check(const GoalPath& path) {
    tccm_monitor::CheckTrajectory question;
    question.request.trajectory = path.whole();
    if (!check_.call(question)) return "check_trajectory does not answer";
    if (question.response.result == tccm_monitor::CheckTrajectory::Response::FREE) return {};
    return "not free: " + question.response.reason + ", " + question.response.detail;
  }

  Config config_;
  std::mutex mutex_;  ///< of all that follows but publishers and the like
  GuardedMotion motion_;
  std::map<std::string, double> positions_;  ///< of joints [rad] or [m]
  unsigned goals_ = 0;                       ///< goals and cancellations so far
  std::string told_;
  ros::NodeHandle node_;
  ros::Publisher command_;
  ros::Publisher trajectory_;
  ros::Publisher state_;
  ros::ServiceClient check_;
  ros::Subscriber permission_;
  ros::Subscriber joints_;
  ros::Subscriber goal_;
  ros::SteadyTimer timer_;
  ros::CallbackQueue goal_queue_;
  ros::AsyncSpinner goal_spinner_;
};

/// @return the exit status.
int run(int argc, char** argv) {
  std::vector<std::string> arguments;
  ros::removeROSArgs(argc, argv, arguments);
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    const bool help = arguments[i] == "--help" || arguments[i] == "-h";
    std::fputs(kUsage, help ? stdout : stderr);
    return help ? 0 : 2;
  }
  ros::init(argc, argv, "controller_client");
  const ros::NodeHandle node;  // outlives the try: ROS logs nothing after the last one
  try {
    ControllerClient client(readConfig());
    ros::spin();
  } catch (const std::invalid_argument& error) {
    ROS_FATAL("controller_client: %s", error.what());
    return 2;
  }
  return 0;
}

}  // namespace
}  // namespace tccm::example

int main(int argc, char** argv) { return tccm::example::run(argc, argv); }
