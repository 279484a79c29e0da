#include <control_msgs/FollowJointTrajectoryAction.h>
#include <geometry_msgs/Point.h>
#include <ros/ros.h>
#include <std_msgs/Empty.h>

#include <memory>
#include <string>
#include <vector>

#include "ros/controller_parameters.h"
#include "ros/resources.h"
#include "ros/server_config.h"
#include "simulation/controller_server.h"
#include "simulation/live.h"
#include "simulation/messages.h"
#include "simulation/standing_arm.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

constexpr char kController[] = "arm_controller";
constexpr std::size_t kBoxesMax = 100;
constexpr float kBoxAlpha = 0.85F;  // what is taken for a box by the monitor lies on it

/// The robot that robot_description tells of, live, at the pace of the wall clock.
class ArmSimulationNode {
 public:
  ArmSimulationNode(const StandingArm::Config& config, std::shared_ptr<const RobotModel> model)
      : arm_(config, std::move(model)),
        start_(config.start),
        camera_(node_.advertise<sensor_msgs::PointCloud2>(kCameraTopic, 3)),
        joints_(node_.advertise<sensor_msgs::JointState>("joint_states", 10)),
        transforms_(node_.advertise<tf2_msgs::TFMessage>("/tf", 100)),
        mounts_(node_.advertise<tf2_msgs::TFMessage>("/tf_static", 1, true)),
        markers_(
            node_.advertise<visualization_msgs::MarkerArray>("simulation/scene_markers", 1, true)),
        box_(node_.subscribe("simulation/box", 10, &ArmSimulationNode::hearBox, this)),
        no_boxes_(node_.subscribe("simulation/no_boxes", 10, &ArmSimulationNode::hearNone, this)),
        controller_(ros::NodeHandle(kController), arm_.controller()) {
    mounts_.publish(mountMessage(arm_.mount(), kCameraFrame, start_));
    publishMarkers();
    ROS_INFO(
        "The simulated arm runs: %zu joints behind %s, a camera on %s, and boxes of %.2g m at "
        "simulation/box.",
        arm_.model().variables().size(), kController, camera_.getTopic().c_str(), config.box_m);
  }

  void run() {
    keepUp(arm_, start_, start_, 1.0, Duration::zero(), [this] { step(); });
  }

 private:
  void step() {
    const StandingArm::Output output = arm_.step();
    controller_.report(arm_.now());
    if (output.robot) {
      transforms_.publish(transformMessage(arm_.model(), *output.robot));
      joints_.publish(jointMessage(arm_.model(), *output.robot));
    }
    if (output.cloud) camera_.publish(cameraMessage(output.cloud->cloud));
  }

  void hearBox(const geometry_msgs::Point& message) {
    const Vector3 place(message.x, message.y, message.z);
    if (!place.allFinite() || arm_.world().size() > kBoxesMax) {
      ROS_WARN("simulation/box: not taken: x, y and z have to be finite, and %zu boxes are enough.",
               kBoxesMax);
      return;
    }
    arm_.putBox(place);
    publishMarkers();
  }
  void hearNone(const std_msgs::Empty& /*message*/) {
    arm_.takeBoxes();
    publishMarkers();
  }
  void publishMarkers() const {
    auto scene = sceneMarkers(arm_.world(), arm_.mount().link, arm_.now());
    for (visualization_msgs::Marker& box : scene.markers) box.color.a = kBoxAlpha;
    markers_.publish(scene);
  }

  ros::NodeHandle node_;
  StandingArm arm_;
  Time start_;
  ros::Publisher camera_;
  ros::Publisher joints_;
  ros::Publisher transforms_;
  ros::Publisher mounts_;
  ros::Publisher markers_;
  ros::Subscriber box_;
  ros::Subscriber no_boxes_;
  ControllerServer controller_;
};

void loadPlace(const ros::NodeHandle& node, const std::string& key, Vector3& place) {
  std::vector<double> values{place.x(), place.y(), place.z()};
  if (node.hasParam(key) && (!node.getParam(key, values) || values.size() != 3)) {
    throw ConfigError(key + ": it has to be [x, y, z] in metres");
  }
  place = {values[0], values[1], values[2]};
}

/// What a robot's launch file would set: one controller for all joints, if nobody has set another.
void setControllerParameters(const ros::NodeHandle& controller, const RobotModel& model) {
  if (controller.hasParam("joints")) return;
  std::vector<std::string> joints;
  for (const JointVariable& variable : model.variables()) joints.push_back(variable.name);
  controller.setParam("type", "position_controllers/JointTrajectoryController");
  controller.setParam("joints", joints);
  controller.setParam("allow_partial_joints_goal", true);
  controller.setParam("stop_trajectory_duration", 0.2);
}

StandingArm::Config load(const ros::NodeHandle& node, const RobotModel& model) {
  const ros::NodeHandle controller(kController);
  setControllerParameters(controller, model);
  const ControllerParameters parameters =
      ControllerParameters::from(parametersOf(controller), kController, model);
  StandingArm::Config config;
  config.arm.controller = {parameters.rules, parameters.stop_duration_s};
  node.param("posture", config.posture, config.posture);
  node.param("floor_m", config.floor_m, config.floor_m);
  node.param("box_m", config.box_m, config.box_m);
  loadPlace(node, "camera", config.camera_m);
  loadPlace(node, "look_at", config.look_at_m);
  config.camera.pinhole = pinholeOf(node, 320);
  config.seed = seedOf(node);
  if (!ros::Time::isSystemTime()) {
    throw ConfigError("use_sim_time: has to be false, as this robot lives by the wall clock");
  }
  config.start = wallNow();
  return config;
}

}  // namespace
}  // namespace tccm::simulation

int main(int argc, char** argv) {
  using namespace tccm::simulation;
  ros::init(argc, argv, "simulation");
  const ros::NodeHandle parameters("~");  // outlives the try: ROS logs nothing after the last one
  try {
    // As it stands, whatever the monitor leaves out or takes otherwise.
    const auto model = std::make_shared<const tccm::RobotModel>(
        tccm::robotDescription(parameters), tccm::RobotModel::Config(),
        tccm::RobotResources{tccm::resourceReader(""), tccm::fitCacheFolder(), {}});
    ArmSimulationNode node(load(parameters, *model), model);
    node.run();
  } catch (const std::exception& error) {
    ROS_FATAL("simulation: %s", error.what());
    return 2;
  }
  return 0;
}
