#include "experiments/nodelet_guardian.h"

#include <rosgraph_msgs/Clock.h>
#include <std_srvs/Trigger.h>

#include <algorithm>

#include "ros/conversions.h"
#include "simulation/messages.h"
#include "tools/program.h"

namespace tccm::simulation {
namespace {

constexpr Duration kBetween = std::chrono::seconds(2);   // two simulations
constexpr Duration kSettling = std::chrono::seconds(4);  // of a simulation: what held lets go
constexpr double kPatience = 20.0;                       // [s] for the nodelets to come up

/// ros::NodeHandle can only be made after this.
ros::NodeHandle connected() {
  if (!ros::isInitialized()) {
    ros::init(ros::M_string(), "trials", ros::init_options::NoSigintHandler);
  }
  if (!ros::master::check()) {
    throw InputError("--ros: no ROS master at " + ros::master::getURI() +
                     "; try roslaunch tccm_monitor trials.launch");
  }
  return {};
}

}  // namespace

NodeletGuardian::NodeletGuardian(Time start)
    : node_(connected()),
      clock_(node_.advertise<rosgraph_msgs::Clock>("/clock", 10)),
      scan_(node_.advertise<sensor_msgs::LaserScan>("scan", 10)),
      joints_(node_.advertise<sensor_msgs::JointState>("joint_states", 10)),
      transforms_(node_.advertise<tf2_msgs::TFMessage>("/tf", 100)),
      permission_(node_.subscribe("motion_permission", 10, &NodeletGuardian::hear, this,
                                  ros::TransportHints().tcpNoDelay())),
      reset_(node_.serviceClient<std_srvs::Trigger>("reset")),
      now_(start) {
  const ros::WallTime give_up = ros::WallTime::now() + ros::WallDuration(kPatience);
  const auto isHeard = [this] {
    return scan_.getNumSubscribers() > 0 && joints_.getNumSubscribers() > 0 &&
           permission_.getNumPublishers() > 0;
  };
  while (!isHeard()) {
    if (ros::WallTime::now() > give_up) {
      throw InputError(
          "--ros: nobody takes scan and joint_states and gives motion_permission; try roslaunch "
          "tccm_monitor trials.launch");
    }
    publishClock(now_);
    ros::spinOnce();
    ros::WallDuration(0.05).sleep();
  }
}

void NodeletGuardian::pause() {
  publishClock(now_);
  ros::spinOnce();
  ros::WallDuration(0.01).sleep();
}

Time NodeletGuardian::nextStart() const { return now_ + kBetween; }

void NodeletGuardian::publishClock(Time now) {
  rosgraph_msgs::Clock clock;
  clock.clock = toRos(now);
  clock_.publish(clock);
}

Guardian::Word NodeletGuardian::watch(const Simulator& simulator, const StepOutput& output) {
  const Time now = simulator.now();
  if (!began_ || now - now_ > fromSeconds(0.1)) {
    began_ = now;
    reset_next_ = now + fromSeconds(1.0);
    wall_began_ = ros::WallTime::now();
    heard_.reset();
  }
  now_ = now;
  if (output.robot || output.scan) publishClock(now);
  if (output.robot) {
    transforms_.publish(transformMessage(simulator.model(), *output.robot));
    joints_.publish(jointMessage(simulator.model(), *output.robot));
  }
  if (output.scan) scan_.publish(toMessage(output.scan->scan, Scanner::Config().period_s));
  keepPace(now);
  ros::spinOnce();
  reset(now);
  if (!heard_) return {true, 0.0, "NO_PERMISSION"};
  if (toRos(now) > heard_->valid_until) return {true, 0.0, "PERMISSION_EXPIRED"};
  const std::string reason = heard_->reasons.empty() ? "" : heard_->reasons.front();
  return {heard_->permitted == 0, heard_->speed_scale, reason};
}

/// Simulated time passes as the wall clock's does, and waits where that is behind.
void NodeletGuardian::keepPace(Time now) {
  const ros::WallTime due = wall_began_ + ros::WallDuration(toSeconds(now - *began_));
  const ros::WallDuration early = due - ros::WallTime::now();
  if (early > ros::WallDuration(0.0)) early.sleep();
}

/// What holds from the simulation before is let go while this one settles.
void NodeletGuardian::reset(Time now) {
  if (!heard_ || now < reset_next_ || now - *began_ > kSettling) return;
  reset_next_ = now + fromSeconds(0.5);
  const auto& reasons = heard_->reasons;
  if (std::find(reasons.begin(), reasons.end(), "AWAITING_RESET") == reasons.end()) return;
  std_srvs::Trigger trigger;
  reset_.call(trigger);
}

}  // namespace tccm::simulation
