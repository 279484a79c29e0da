/// What MoveIt has attached to the robot is attached in the monitor as well. Built where
/// moveit_msgs is found.

#include <moveit_msgs/AttachedCollisionObject.h>
#include <moveit_msgs/PlanningScene.h>
#include <ros/ros.h>
#include <tccm_monitor/AttachObject.h>
#include <tccm_monitor/AttachedObjects.h>
#include <tccm_monitor/DetachObject.h>

#include "ros/attached_mirror.h"
#include "ros/handles.h"
#include "ros/transform_history.h"

namespace tccm {
namespace {

constexpr double kAgain = 1.0;         // [s] of wall time until what was refused is asked for again
constexpr double kTransformOld = 0.5;  // [s]
constexpr double kTold = 5.0;          // [s] between two lines of one kind in the log

class MoveitAttachedObjects {
 public:
  explicit MoveitAttachedObjects(const ros::NodeHandle& node)
      : attach_(ros::NodeHandle(node).serviceClient<tccm_monitor::AttachObject>("attach_object")),
        detach_(ros::NodeHandle(node).serviceClient<tccm_monitor::DetachObject>("detach_object")) {
    using This = MoveitAttachedObjects;
    inputs_ = hearTransforms(node, transforms_, [](const auto&...) {});
    inputs_.push_back(hear(node, "attached_collision_object", 100, &This::receiveObject, this));
    inputs_.push_back(hear(node, "monitored_planning_scene", 100, &This::receiveScene, this));
    inputs_.push_back(hear(node, "attached_objects", 10, &This::receiveHeld, this));
    timer_ = ros::NodeHandle(node).createWallTimer(ros::WallDuration(kAgain),
                                                   [this](const ros::WallTimerEvent& /*event*/) {
                                                     mirror_.askAgain();
                                                     mirror();
                                                   });
  }

 private:
  void receiveObject(const moveit_msgs::AttachedCollisionObject::ConstPtr& message) {
    tell(objects_.take(*message));
    plan();
  }

  void receiveScene(const moveit_msgs::PlanningScene::ConstPtr& message) {
    for (const std::string& why : objects_.takeState(message->robot_state)) tell(why);
    plan();
  }

  void receiveHeld(const tccm_monitor::AttachedObjects::ConstPtr& message) {
    HeldShapes held;
    for (const auto& object : message->objects) {
      held[object.name] = {object.link, object.primitive};
    }
    mirror_.hear(std::move(held));
    mirror();
  }

  void plan() {
    HeldShapes shapes = objects_.shapes();
    if (shapes == planned_) return;
    planned_ = shapes;
    mirror_.plan(std::move(shapes));
    mirror();
  }

  void mirror() {
    for (const std::string& name : mirror_.toAttach()) {
      tccm_monitor::AttachObject call;
      call.request.name = name;
      call.request.link = mirror_.planned(name).link;
      call.request.primitive = mirror_.planned(name).primitive;
      if (isDone(attach_, call, name)) mirror_.attached(name);
    }
    for (const std::string& name : mirror_.toDetach()) {
      tccm_monitor::DetachObject call;
      call.request.name = name;
      if (isDone(detach_, call, name)) mirror_.detached(name);
    }
  }

  template <typename Service>
  bool isDone(ros::ServiceClient& client, Service& call, const std::string& name) {
    const bool is_answered = client.call(call);
    if (is_answered && call.response.success) {
      ROS_INFO("'%s': %s.", name.c_str(), client.getService().c_str());
      return true;
    }
    ROS_ERROR_THROTTLE(kTold, "'%s' is not taken, and asked for again: %s: %s", name.c_str(),
                       client.getService().c_str(),
                       is_answered ? call.response.message.c_str() : "no answer");
    mirror_.refused(name);
    return false;
  }

  [[nodiscard]] std::optional<Pose> placeOf(const std::string& link, const std::string& frame) {
    const auto newest = transforms_.newest(withoutSlash(link), withoutSlash(frame));
    if (!newest) return std::nullopt;
    const double age_s = (ros::Time::now() - toRos(newest->stamp)).toSec();
    if (!newest->is_static && std::abs(age_s) > kTransformOld) return std::nullopt;
    return newest->pose;
  }

  static void tell(const std::string& why) {
    if (!why.empty()) ROS_WARN_THROTTLE(kTold, "%s", why.c_str());
  }

  TransformHistory transforms_{fromSeconds(kTransformOld)};
  PlannerObjects objects_{
      [this](const std::string& link, const std::string& frame) { return placeOf(link, frame); }};
  AttachedMirror mirror_;
  HeldShapes planned_;
  ros::ServiceClient attach_, detach_;
  std::vector<ros::Subscriber> inputs_;
  ros::WallTimer timer_;
};

}  // namespace
}  // namespace tccm

int main(int argc, char** argv) {
  ros::init(argc, argv, "moveit_attached_objects");
  const tccm::MoveitAttachedObjects node{ros::NodeHandle()};
  ros::spin();
  return 0;
}
