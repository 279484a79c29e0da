/// Passes the simulation's clock on to the monitor, as it is or as a fault makes it. In the soak's
/// own process, through which all else goes, it would come late.
///
///   raw/clock          in: rosgraph_msgs/Clock
///   clock_gate/change  in: std_msgs/String: empty, as it is; `stopped`; `to_and_fro S`, as of two
///                      sources; `earlier S`
///   /clock             out

#include <ros/ros.h>
#include <rosgraph_msgs/Clock.h>
#include <std_msgs/String.h>

#include <sstream>
#include <string>

namespace {

class ClockGate {
 public:
  ClockGate()
      : clock_(node_.advertise<rosgraph_msgs::Clock>("/clock", 10)),
        change_(node_.subscribe("clock_gate/change", 10, &ClockGate::change, this, noDelay())),
        raw_(node_.subscribe("raw/clock", 100, &ClockGate::pass, this, noDelay())) {}

 private:
  static ros::TransportHints noDelay() { return ros::TransportHints().tcpNoDelay(); }

  void change(const std_msgs::String& message) {
    kind_.clear();
    double seconds = 0.0;
    std::istringstream(message.data) >> kind_ >> seconds;
    earlier_ = ros::Duration(seconds);
  }

  void pass(const rosgraph_msgs::Clock& raw) {
    if (kind_ == "stopped") return;
    rosgraph_msgs::Clock message = raw;
    const bool is_other_source = kind_ == "to_and_fro" && ++count_ % 3 == 0;
    if (kind_ == "earlier" || is_other_source) message.clock -= earlier_;
    clock_.publish(message);
  }

  ros::NodeHandle node_;
  ros::Publisher clock_;
  std::string kind_;
  ros::Duration earlier_;
  unsigned count_ = 0;
  ros::Subscriber change_, raw_;
};

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "clock_gate");
  const ClockGate gate;
  ros::spin();
}
