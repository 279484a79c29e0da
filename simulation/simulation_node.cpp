#include <ros/ros.h>
#include <rosgraph_msgs/Clock.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Float64.h>
#include <std_msgs/String.h>

#include <algorithm>
#include <deque>
#include <nlohmann/json.hpp>
#include <sstream>

#include "ros/controller_parameters.h"
#include "ros/conversions.h"
#include "ros/server_config.h"
#include "simulation/controller_server.h"
#include "simulation/live.h"
#include "simulation/messages.h"
#include "simulation/robot/dual_arm.h"
#include "simulation/simulator.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

constexpr std::size_t kPutMax = 20;
const Eigen::Vector3f kPutColour(0.90F, 0.75F, 0.25F);

/// @throws ConfigError
SceneObject boxOf(const visualization_msgs::Marker& marker) {
  const Vector3 half = 0.5 * Vector3(marker.scale.x, marker.scale.y, marker.scale.z);
  if (!half.allFinite() || !(half.minCoeff() > 0.0)) throw ConfigError("a box has no such size");
  return {marker.ns, Box{half}, fromMessage(marker.pose, "a box"), kPutColour};
}

/// The simulated robot, live, at the pace of the wall clock, or of a share of it. Arms that are
/// commanded hear nobody's stop: who commands them has to obey it.
class SimulationNode {
 public:
  struct Config {
    Simulator::Config simulator;
    std::vector<std::string> controllers;  ///< of the arms that have one: names
    bool publish_clock = false;
    double clock_rate = 1.0;  ///< of what is published: its seconds in one of the wall clock
    double duration_s = 0.0;  ///< 0: until shut down
  };

  explicit SimulationNode(const Config& config) : config_(config), simulator_(config.simulator) {
    ros::NodeHandle node;
    if (config.publish_clock) clock_ = node.advertise<rosgraph_msgs::Clock>("/clock", 10);
    advertiseSensors(node);
    joints_ = node.advertise<sensor_msgs::JointState>("joint_states", 10);
    transforms_ = node.advertise<tf2_msgs::TFMessage>("/tf", 100);
    truth_ = node.advertise<std_msgs::String>("simulation/truth", 100, true);
    tilt_fault_ = node.subscribe("simulation/tilt_fault", 10, &SimulationNode::hearTiltFault, this);
    put_ = node.subscribe("simulation/put", 10, &SimulationNode::hearPut, this);
    markers_ = node.advertise<visualization_msgs::MarkerArray>("simulation/scene_markers", 1, true);
    if (config.simulator.motion == kCommanded) {
      command_ = node.subscribe("command", 10, &SimulationNode::hearCommand, this,
                                ros::TransportHints().tcpNoDelay());
      for (std::size_t arm = 0; arm < config.controllers.size(); ++arm) {
        controllers_.emplace_back(ros::NodeHandle(config.controllers[arm]),
                                  simulator_.armController(arm));
      }
      slider_ = node.subscribe("simulation/speed_slider", 10, &SimulationNode::hearSlider, this);
    } else {
      stop_ = node.subscribe("stop", 1, &SimulationNode::hearStop, this);
    }
  }

  void run() {
    const Time start = config_.simulator.start;
    // By the wall clock, what took time until here counts.
    const Time wall_start = config_.publish_clock ? wallNow() : start;
    keepUp(simulator_, start, wall_start, config_.clock_rate, fromSeconds(config_.duration_s),
           [this] { step(); });
  }

 private:
  void advertiseSensors(ros::NodeHandle& node) {
    const Simulator::Config& robot = config_.simulator;
    if (robot.has(SensorKind::kLaser)) scan_ = node.advertise<sensor_msgs::LaserScan>("scan", 10);
    if (robot.has(SensorKind::kCamera)) {
      camera_ = node.advertise<sensor_msgs::PointCloud2>(kCameraTopic, 3);
    }
    if (robot.has(SensorKind::kLidar)) {
      lidar_ = node.advertise<sensor_msgs::PointCloud2>(kLidarTopic, 3);
    }
    const tf2_msgs::TFMessage mounts = mountMessage(robot);
    if (mounts.transforms.empty()) return;
    mounts_ = node.advertise<tf2_msgs::TFMessage>("/tf_static", 1, true);
    mounts_.publish(mounts);
  }

  void publishSensors(const StepOutput& output) const {
    if (output.scan) {
      scan_.publish(toMessage(output.scan->scan, config_.simulator.scanner.period_s));
    }
    if (output.clouds.camera) camera_.publish(cameraMessage(output.clouds.camera->cloud));
    if (output.clouds.lidar) lidar_.publish(lidarMessage(output.clouds.lidar->cloud));
  }

  void hearStop(const std_msgs::Bool& message) {
    go_heard_ = !message.data ? std::optional<Time>(simulator_.now()) : std::nullopt;
  }

  void hearCommand(const trajectory_msgs::JointTrajectory& message) {
    const std::string defect = simulator_.command(toCommand(message, simulator_.now()));
    if (!defect.empty()) ROS_WARN_THROTTLE(1.0, "A command is not taken: %s.", defect.c_str());
  }

  void hearSlider(const std_msgs::Float64& message) {
    simulator_.setArmsSpeedScale(std::clamp(message.data, 0.0, 1.0));
  }

  void hearTiltFault(const std_msgs::String& message) {
    try {
      simulator_.setTiltFault(tiltFault(message.data));
    } catch (const ConfigError& error) {
      ROS_WARN_THROTTLE(1.0, "%s.", error.what());
    }
  }

  void hearPut(const visualization_msgs::MarkerArray& message) {
    try {
      World objects;
      for (const visualization_msgs::Marker& box : message.markers) objects.push_back(boxOf(box));
      if (objects.size() > kPutMax) throw ConfigError("too many boxes");
      if (config_.simulator.obstacle != ObstacleKind::kNone) {
        throw ConfigError("the parameter obstacle has to be none");
      }
      simulator_.put(objects);
      has_put_ = !objects.empty();
      markers_drawn_.reset();
    } catch (const ConfigError& error) {
      ROS_WARN("simulation/put: not taken: %s.", error.what());
    }
  }

  /// Silence means stop.
  [[nodiscard]] bool stopped() const {
    constexpr Duration kSilence = std::chrono::milliseconds(300);
    return !go_heard_ || simulator_.now() - *go_heard_ > kSilence;
  }

  void step() {
    simulator_.setStop(stopped());
    const StepOutput output = simulator_.step();
    for (ControllerServer& controller : controllers_) controller.report(simulator_.now());
    if (config_.publish_clock && (output.robot || output.scan)) {
      rosgraph_msgs::Clock clock;
      clock.clock = toRos(simulator_.now());
      clock_.publish(clock);
    }
    if (output.robot) {
      transforms_.publish(transformMessage(simulator_.model(), *output.robot));
      joints_.publish(jointMessage(simulator_.model(), *output.robot));
      publishDistance();
    }
    publishSensors(output);
    publishEvents();
    publishMarkers();
  }

  void publishTruth(const std::string& event, nlohmann::json content) {
    content["event"] = event;
    std_msgs::String message;
    message.data = content.dump();
    truth_.publish(message);
  }

  /// At 10 Hz, at 100 Hz while something is put there.
  void publishDistance() {
    if (++robot_samples_ % 10 == 0 || has_put_)
      publishTruth("hand", toJson(simulator_.truth().hand.back()));
  }

  void publishEvent(const std::string& event, const std::optional<Time>& stamp,
                    std::optional<Time>& published) {
    if (stamp == published) return;
    published = stamp;
    publishTruth(event, {{"stamp_s", toSeconds(*stamp)}});
  }

  void publishEvents() {
    const Truth& truth = simulator_.truth();
    publishEvent("obstacle_appeared", truth.appeared, published_.appeared);
    publishEvent("first_beam", truth.first_beam, published_.first_beam);
    publishEvent("stop_asserted", truth.stop_asserted, published_.stop_asserted);
    publishEvent("halted", truth.halted, published_.halted);
  }

  /// Once a second, and at once when something appears; ten times a second while it moves.
  void publishMarkers() {
    const Time now = simulator_.now();
    const bool moving = simulator_.truth().in_place && now <= *simulator_.truth().in_place;
    const Duration due = moving ? std::chrono::milliseconds(100) : std::chrono::milliseconds(1000);
    const bool appeared = simulator_.world().size() != objects_drawn_;
    if (markers_drawn_ && !appeared && now - *markers_drawn_ < due) return;
    markers_drawn_ = now;
    objects_drawn_ = simulator_.world().size();
    markers_.publish(sceneMarkers(simulator_.world(), "base_link", now));
  }

  Config config_;
  Simulator simulator_;
  std::optional<Time> go_heard_;
  std::optional<Time> markers_drawn_;
  std::size_t objects_drawn_ = 0;
  std::size_t robot_samples_ = 0;
  bool has_put_ = false;
  Truth published_;
  ros::Publisher clock_;
  ros::Publisher scan_;
  ros::Publisher camera_;
  ros::Publisher lidar_;
  ros::Publisher mounts_;
  ros::Publisher joints_;
  ros::Publisher transforms_;
  ros::Publisher truth_;
  ros::Publisher markers_;
  ros::Subscriber stop_;
  ros::Subscriber command_;
  ros::Subscriber tilt_fault_;
  ros::Subscriber slider_;
  ros::Subscriber put_;
  std::deque<ControllerServer> controllers_;
};

/// At commas.
std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> entries;
  std::istringstream stream(list);
  for (std::string entry; std::getline(stream, entry, ',');) entries.push_back(entry);
  return entries;
}

/// Each reads its parameters in the namespace of its name, as on a robot.
void loadControllers(const ros::NodeHandle& node, SimulationNode::Config& config) {
  double lag_s = 0.0;
  node.param("joint_lag_s", lag_s, lag_s);
  node.param("controllers", config.controllers, config.controllers);
  if (!config.controllers.empty() && config.simulator.motion != kCommanded) {
    throw ConfigError("controllers: they need the motion 'commanded'");
  }
  for (const std::string& name : config.controllers) {
    const ControllerParameters parameters =
        ControllerParameters::from(parametersOf(ros::NodeHandle(name)), name, *dualArm());
    config.simulator.commanded.controlled.push_back(
        {{parameters.rules, parameters.stop_duration_s}, lag_s});
  }
}

SimulationNode::Config load(const ros::NodeHandle& node) {
  SimulationNode::Config config;
  Simulator::Config& s = config.simulator;
  std::string obstacle = "none";
  std::string obstacle_for = "collision";
  std::string tilt_fault = "none";
  ScanningHead::Schedule fault;
  std::string sensors = "laser";
  std::string camera = "chest";
  node.param("sensors", sensors, sensors);
  node.param("camera", camera, camera);
  node.param("scene", s.scene, s.scene);
  node.param("motion", s.motion, s.motion);
  node.param("obstacle", obstacle, obstacle);
  node.param("obstacle_for", obstacle_for, obstacle_for);
  node.param("appear_s", s.appear_s, s.appear_s);
  node.param("gap_m", s.gap_m, s.gap_m);
  node.param("obstacle_speed_mps", s.obstacle_speed_mps, s.obstacle_speed_mps);
  node.param("speed_mps", s.controller.speed_mps, s.controller.speed_mps);
  node.param("commanded_deceleration_rps2", s.commanded.deceleration_rps2,
             s.commanded.deceleration_rps2);
  loadControllers(node, config);
  node.param("noise_m", s.scanner.noise_m, s.scanner.noise_m);
  node.param("tilt_fault", tilt_fault, tilt_fault);
  node.param("tilt_fault_at_s", fault.at_s, fault.at_s);
  node.param("tilt_fault_for_s", fault.for_s, fault.for_s);
  node.param("duration_s", config.duration_s, config.duration_s);
  node.param("publish_clock", config.publish_clock, config.publish_clock);
  node.param("clock_rate", config.clock_rate, config.clock_rate);
  requireInRange("duration_s", config.duration_s, 0.0, 1e6);
  requireInRange("clock_rate", config.clock_rate, 0.01, 10.0);
  s.seed = seedOf(node);
  s.keeps_hand_samples = false;
  s.obstacle = obstacleKind(obstacle);
  s.purpose = obstaclePurpose(obstacle_for);
  s.sensors = sensorKinds(split(sensors));
  s.clouds.camera_mount = cameraMount(camera);
  s.clouds.camera.pinhole = pinholeOf(node, 640);
  fault.fault = tiltFault(tilt_fault);
  if (fault.fault != TiltFault::kNone) s.head.faults.push_back(fault);
  if (!config.publish_clock) {
    if (config.clock_rate != 1.0) throw ConfigError("clock_rate: it needs publish_clock");
    if (!ros::Time::isSystemTime()) {
      throw ConfigError("publish_clock: must be true where use_sim_time is, for want of a clock");
    }
    s.start = wallNow();
  }
  return config;
}

}  // namespace
}  // namespace tccm::simulation

int main(int argc, char** argv) {
  using namespace tccm::simulation;
  ros::init(argc, argv, "simulation");
  const ros::NodeHandle parameters("~");  // outlives the try: ROS logs nothing after the last one
  try {
    SimulationNode node(load(parameters));
    node.run();
  } catch (const std::exception& error) {
    ROS_FATAL("simulation: %s", error.what());
    return 2;
  }
  return 0;
}
