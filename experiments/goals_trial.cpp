#include "experiments/goals_trial.h"

#include <actionlib/client/simple_action_client.h>
#include <control_msgs/FollowJointTrajectoryAction.h>
#include <std_srvs/Trigger.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "experiments/draw.h"
#include "experiments/exact_clearance.h"
#include "experiments/robot_part.h"
#include "ros/conversions.h"
#include "simulation/controller_server.h"
#include "simulation/robot/dual_arm.h"
#include "tccm_monitor/config_error.h"
#include "tools/program.h"

namespace tccm::simulation {
namespace {

using Client = actionlib::SimpleActionClient<control_msgs::FollowJointTrajectoryAction>;

constexpr double kBetween_s = 0.3;      // goals
constexpr double kUnpermitted_s = 8.0;  // after which a goal is sent all the same
constexpr double kSettles_s = 4.0;      // after the start
constexpr double kPatience_s = 20.0;    // for the gate to come up
constexpr double kStands = 0.002;       // [m/s]
constexpr double kSpacing = 0.02;       // [m]
constexpr double kObstacleSpeed = 0.3;  // [m/s]

}  // namespace

struct GoalsTrial::Sent {
  Client* client;
  Time at;
  std::optional<Time> cancelled_at, replaced_at;
};

struct GoalsTrial::Parts {
  explicit Parts(std::uint64_t seed) : draw(seed) {}

  Draw draw;
  std::unique_ptr<Simulator> simulator;
  std::unique_ptr<ControllerServer> controller;
  std::unique_ptr<Client> clients[2];
  std::size_t next_client = 0;
  std::unique_ptr<RobotPart> arm;
  ros::ServiceClient reset;
  std::vector<Sent> sent;
  std::vector<double> targets;
  Time begun, idle_since, reset_next;
  std::optional<Vector3> palm_before;
  double palm_mps = 0.0;
};

void GoalsTrial::Config::validate() const {
  requireInRange("speed_min_rps", speed_min_rps, 0.01, 3.0);
  requireInRange("speed_max_rps", speed_max_rps, speed_min_rps, 3.0);
  requireInRange("obstacle_every_s", obstacle_every_s, 0.5, 1e6);
  requireInRange("noise_m", noise_m, 0.0, 0.1);
}

GoalsTrial::GoalsTrial(const Config& config, std::shared_ptr<const RobotModel> model,
                       std::uint64_t seed)
    : config_((config.validate(), config)),
      model_(std::move(model)),
      parts_(std::make_unique<Parts>(seed)) {
  result_.seed = seed;
  parts_->simulator = std::make_unique<Simulator>(simulatorConfig());
  parts_->arm =
      std::make_unique<RobotPart>(model_,
                                  std::vector<std::string>{"right_elbow_link", "right_wrist_*",
                                                           "right_palm_link", "right_*finger_link"},
                                  kSpacing);
  parts_->controller = std::make_unique<ControllerServer>(ros::NodeHandle(config_.controller),
                                                          parts_->simulator->armController(0));
  parts_->reset = ros::NodeHandle().serviceClient<std_srvs::Trigger>("reset");
  for (auto& client : parts_->clients) client = std::make_unique<Client>(config_.action, true);
  parts_->begun = parts_->idle_since = parts_->reset_next = parts_->simulator->now();
}

GoalsTrial::~GoalsTrial() = default;

Simulator::Config GoalsTrial::simulatorConfig() {
  Simulator::Config config;
  config.start = config_.guardian->nextStart();
  config.scene = "table";
  config.motion = kCommanded;
  config.commanded = config_.arms;
  config.scanner.noise_m = config_.noise_m;
  config.seed = result_.seed;
  addObstacles(config.objects);
  return config;
}

/// Each comes, stands for a while and goes.
void GoalsTrial::addObstacles(World& world) {
  Draw& draw = parts_->draw;
  const double lasts_s = static_cast<double>(config_.goals) * 12.0;
  const Time start = config_.guardian->nextStart();
  for (double at_s = kSettles_s; at_s < lasts_s;
       at_s += config_.obstacle_every_s * draw.between(0.5, 1.5)) {
    const double x = draw.between(0.5, 0.85), y = draw.between(-0.5, 0.15);
    const bool is_pole = draw.between(0.0, 1.0) < 0.5;
    const double height = is_pole ? draw.between(0.3, 0.5) : draw.between(0.1, 0.25);
    SceneObject object;
    object.name = is_pole ? "pole" : "box";
    if (is_pole) {
      object.shape = Cylinder{draw.between(0.015, 0.04), 0.5 * height};
    } else {
      object.shape = Box{Vector3(draw.between(0.03, 0.08), draw.between(0.03, 0.08), 0.5 * height)};
    }
    object.T_fixed_shape = at(x, y, kTableTop + 0.5 * height);
    object.colour = Eigen::Vector3f(0.8F, 0.2F, 0.2F);
    const Vector3 away = draw.between(0.0, 1.0) < 0.5 ? Vector3(0.0, 0.0, 0.6)
                                                      : Vector3(0.0, y > -0.2 ? 0.7 : -0.7, 0.0);
    object.entrance = Entrance{start + fromSeconds(at_s), away, kObstacleSpeed};
    object.departure = Departure{object.entrance->arrives() + fromSeconds(draw.between(4.0, 10.0)),
                                 away, kObstacleSpeed};
    world.push_back(object);
  }
}

std::vector<double> GoalsTrial::randomTarget() {
  Draw& draw = parts_->draw;
  const std::vector<std::string>& joints = parts_->simulator->armController(0).joints();
  while (true) {
    const Vector3 place(draw.between(0.4, 0.75), draw.between(-0.5, 0.1), draw.between(0.8, 1.15));
    try {
      const ArmPath path = reachVia(model_, {Vector3(0.5, -0.25, 0.95), place});
      const std::vector<double> all = path.positions(path.length());
      std::vector<double> target;
      target.reserve(joints.size());
      for (const std::string& joint : joints) target.push_back(all[variableIndex(*model_, joint)]);
      return target;
    } catch (const std::runtime_error&) {  // out of reach
    }
  }
}

void GoalsTrial::send() {
  Parts& p = *parts_;
  const TrajectoryController& arm = p.simulator->armController(0);
  control_msgs::FollowJointTrajectoryGoal goal;
  goal.trajectory.joint_names = arm.joints();
  goal.trajectory.points.resize(1);
  auto& point = goal.trajectory.points.front();
  point.positions = randomTarget();
  point.velocities.assign(point.positions.size(), 0.0);
  double furthest = 0.0;
  for (std::size_t j = 0; j < point.positions.size(); ++j) {
    furthest = std::max(furthest, std::abs(point.positions[j] - arm.positions()[j]));
  }
  const double speed = p.draw.between(config_.speed_min_rps, config_.speed_max_rps);
  point.time_from_start = ros::Duration(std::max(0.5, 1.5 * furthest / speed));
  Sent sent{p.clients[p.next_client].get(), p.simulator->now(), {}, {}};
  p.next_client = 1 - p.next_client;
  const double lot = p.draw.between(0.0, 1.0), after_s = p.draw.between(0.1, 2.0);
  const Time then = sent.at + fromSeconds(after_s);
  if (lot < config_.cancelled_share) {
    sent.cancelled_at = then;
  } else if (lot < config_.cancelled_share + config_.replaced_share) {
    sent.replaced_at = then;
  }
  sent.client->sendGoal(goal);
  p.sent.push_back(sent);
}

bool GoalsTrial::followGoals() {
  Parts& p = *parts_;
  const Time now = p.simulator->now();
  bool replaces = false;
  for (auto sent = p.sent.begin(); sent != p.sent.end();) {
    const actionlib::SimpleClientGoalState state = sent->client->getState();
    const double took_s = toSeconds(now - sent->at);
    if (!state.isDone() && took_s < config_.longest_s) {
      if (sent->cancelled_at && now > *sent->cancelled_at) {
        sent->client->cancelGoal();
        sent->cancelled_at.reset();
      }
      if (sent->replaced_at && now > *sent->replaced_at) {
        replaces = true;
        sent->replaced_at.reset();
      }
      ++sent;
      continue;
    }
    Goal goal{state.isDone() ? state.toString() : "hangs", {}, took_s};
    const auto result = state.isDone() ? sent->client->getResult() : nullptr;
    if (result && goal.end != "SUCCEEDED") goal.reason = result->error_string;
    std::replace(goal.reason.begin(), goal.reason.end(), ',', ';');
    result_.goals.push_back(goal);
    sent = p.sent.erase(sent);
    p.idle_since = now;
  }
  if (replaces && p.sent.size() < 2) send();
  return !p.sent.empty();
}

void GoalsTrial::resetWhatHolds(bool is_held) {
  Parts& p = *parts_;
  if (!is_held || p.simulator->now() < p.reset_next) return;
  p.reset_next = p.simulator->now() + fromSeconds(1.0);
  std_srvs::Trigger trigger;
  p.reset.call(trigger);
}

void GoalsTrial::lookForContact(const RobotSample& robot) {
  Parts& p = *parts_;
  p.arm->moveTo(robot.link_poses);
  const Vector3 palm = robot.link_poses[linkIndex(*model_, "right_palm_link")].translation();
  if (p.palm_before) p.palm_mps = (palm - *p.palm_before).norm() / 0.01;
  p.palm_before = palm;
  const Time now = robot.stamp;
  for (const SceneObject& object : p.simulator->world()) {
    const std::optional<Pose> pose = object.poseAt(now);
    if (!pose) continue;
    Body thing;
    thing.shapes.push_back(object.shape);
    thing.poses.push_back(*pose);
    if (!exactlyTouch(p.arm->body().body(), thing)) continue;
    Contact contact{object.name, p.palm_mps, 1e9, false};
    if (object.entrance) {
      contact.stood_s = toSeconds(now - object.entrance->arrives());
      if (object.departure && now >= object.departure->leaves) contact.stood_s = -1.0;
    }
    contact.avoidable = contact.stood_s > config_.seen_after_s && p.palm_mps > kStands;
    result_.contact = contact;
    return;
  }
}

GoalsTrial::Result GoalsTrial::run() {
  Parts& p = *parts_;
  const ros::WallTime give_up = ros::WallTime::now() + ros::WallDuration(kPatience_s);
  for (const auto& client : p.clients) {
    while (!client->isServerConnected() && ros::WallTime::now() < give_up) {
      config_.guardian->pause();
    }
    if (!client->isServerConnected()) {
      throw InputError("--ros: there is no action " + config_.action +
                       "; try roslaunch tccm_monitor trials.launch experiment:=goals");
    }
  }
  bool may_move = false;
  while (!result_.contact && (result_.goals.size() < config_.goals || !p.sent.empty())) {
    const StepOutput output = p.simulator->step();
    const Guardian::Word word = config_.guardian->watch(*p.simulator, output);
    p.controller->report(p.simulator->now());
    if (!output.robot) continue;
    may_move = !word.stop;
    lookForContact(*output.robot);
    if (followGoals()) continue;
    resetWhatHolds(!may_move);
    const double idle_s = toSeconds(p.simulator->now() - p.idle_since);
    const bool has_settled = toSeconds(p.simulator->now() - p.begun) > kSettles_s;
    if (!has_settled || idle_s < kBetween_s || (!may_move && idle_s < kUnpermitted_s)) continue;
    if (result_.goals.size() < config_.goals) send();
  }
  for (std::size_t i = 0; i < p.sent.size(); ++i) result_.goals.push_back({"contact", {}, 0.0});
  for (const auto& client : p.clients) client->cancelAllGoals();
  result_.simulated_s = toSeconds(p.simulator->now() - p.begun);
  return result_;
}

}  // namespace tccm::simulation
