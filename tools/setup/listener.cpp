#include "listener.h"

#include <ros/callback_queue.h>
#include <ros/master.h>
#include <ros/param.h>
#include <ros/ros.h>
#include <rosbag/bag.h>
#include <topic_tools/shape_shifter.h>

#include <map>
#include <set>

namespace tccm {
namespace {

const std::set<std::string> kTypes{"sensor_msgs/LaserScan", "sensor_msgs/PointCloud2",
                                   "sensor_msgs/JointState", "tf2_msgs/TFMessage", "tf/tfMessage"};

class Recorder {
 public:
  explicit Recorder(const std::string& path) { bag_.open(path, rosbag::bagmode::Write); }

  void hearAll() {
    ros::master::V_TopicInfo topics;
    if (!ros::master::getTopics(topics)) throw InputError("the ROS master has gone");
    for (const ros::master::TopicInfo& topic : topics) {
      if (kTypes.count(topic.datatype) == 0 || subscribers_.count(topic.name) > 0) continue;
      using Event = ros::MessageEvent<topic_tools::ShapeShifter const>;
      const auto write = [this, name = topic.name](const Event& event) {
        bag_.write(name, ros::Time::now(), *event.getMessage(), event.getConnectionHeaderPtr());
      };
      subscribers_[topic.name] = node_.subscribe<topic_tools::ShapeShifter>(
          topic.name, 1000, boost::function<void(const Event&)>(write));
    }
  }

 private:
  ros::NodeHandle node_;
  rosbag::Bag bag_;
  std::map<std::string, ros::Subscriber> subscribers_;
};

}  // namespace

void recordRobot(double seconds, const std::string& path, const Progress& progress) {
  Recorder recorder(path);
  const ros::WallTime begin = ros::WallTime::now();
  double passed = 0.0;
  while ((passed = (ros::WallTime::now() - begin).toSec()) < seconds) {
    recorder.hearAll();
    const ros::WallTime next = ros::WallTime::now() + ros::WallDuration(0.5);
    while (ros::WallTime::now() < next) {
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.05));
      if (!ros::ok()) throw InputError("interrupted");
    }
    if (progress) progress(std::min(1.0, passed / seconds));
  }
}

std::vector<ArmController> runningControllers() {
  const std::string action = "/follow_joint_trajectory/result";
  ros::master::V_TopicInfo topics;
  ros::master::getTopics(topics);
  std::vector<ArmController> controllers;
  for (const ros::master::TopicInfo& topic : topics) {
    if (topic.name.size() <= action.size()) continue;
    const std::size_t length = topic.name.size() - action.size();
    if (topic.name.compare(length, action.size(), action) != 0) continue;
    ArmController controller{topic.name.substr(0, length)};
    if (!ros::param::has(controller.name + "/joints")) continue;  // a gate's, or another's
    ros::param::get(controller.name + "/stop_trajectory_duration", controller.stop_duration_s);
    controllers.push_back(controller);
  }
  return controllers;
}

}  // namespace tccm
