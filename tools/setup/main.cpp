/// Writes a configuration for a robot from what it publishes, and says what would stop it.

#include <ros/init.h>
#include <ros/master.h>
#include <ros/param.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "draft.h"
#include "findings.h"
#include "lessons.h"
#include "listener.h"
#include "survey.h"
#include "tccm_monitor/config_error.h"
#include "tools/evaluation.h"
#include "tools/program.h"

namespace tccm {
namespace {

struct Options {
  std::string bag;
  std::string urdf;
  std::string config;
  std::string package_path;
  std::string out = "my_robot.yaml";
  double seconds = 20.0;
  bool check = false;
  bool gate = false;
  bool patient = false;
};

void describe(CLI::App& app, Options& options) {
  app.footer(
      "Listens to a running robot, or reads a bag. The robot's description is robot_description, "
      "or\n"
      "--urdf. Let the laser tilt for three periods, keep people away, and let the arms stand.\n"
      "Exit status: 0 done and nothing wrong; 1 something is wrong, a line each; 2 bad input.\n"
      "Example: setup --bag run.bag --urdf robot.urdf --out my_robot.yaml");
  app.add_option("--bag", options.bag, "reads this recording in place of a running robot");
  app.add_option("--urdf", options.urdf, "the robot, where robot_description is not there");
  app.add_option("--config", options.config,
                 "checks this configuration; without it the one that it would write");
  app.add_option("--package-path", options.package_path,
                 "folder with a robot's packages: package://P/x is DIR/P/x where P is there, and "
                 "is looked for among the ROS packages elsewhere");
  app.add_option("--out", options.out, "YAML file to write")->capture_default_str();
  app.add_option("--seconds", options.seconds, "to listen for")
      ->check(CLI::Range(1.0, 600.0))
      ->capture_default_str();
  app.add_flag("--gate", options.gate,
               "puts the TrajectoryGate before the arms' controllers that run");
  app.add_flag("--patient", options.patient,
               "limits of time for a computer that pauses now and then, as one that simulates the "
               "robot: silence is noticed later");
  app.add_flag("--check", options.check, "writes nothing, says only what is wrong");
}

/// What comes next; a progress bar follows.
void tellStep(const std::string& what) { std::cout << what << std::endl; }

/// How a run ends.
int tell(const std::vector<std::string>& findings) {
  for (const std::string& line : findings) std::cout << "wrong: " << line << '\n';
  if (findings.empty()) std::cout << "nothing wrong\n";
  std::cout.flush();
  return findings.empty() ? kDone : kLimitMissed;
}

/// Why none that was heard can be used.
std::string whyNoSensor(const Survey& survey) {
  for (const Survey::Sensor& sensor : survey.sensors) {
    if (sensor.frames.size() < 2) continue;
    return formatted("%s: its messages are in '%s' and in '%s': give each sensor a topic",
                     sensor.topic.c_str(), sensor.frames.begin()->c_str(),
                     sensor.frames.rbegin()->c_str());
  }
  return "no laser tilts, and no clouds came: what lies in one plane makes no map; see whether tf "
         "has the tilt, or use a camera or lidar";
}

class Setup {
 public:
  explicit Setup(const Options& options) : options_(options) {}

  int run() {
    if (options_.gate && !options_.bag.empty()) {
      throw InputError("--gate: a recording does not tell which controllers run");
    }
    std::string urdf = options_.urdf.empty() ? "" : readText(options_.urdf, "the URDF");
    std::string bag = options_.bag;
    const ScratchFile heard("bag");
    const bool is_alone = bag.empty() && !urdf.empty() && !ros::master::check();
    if (bag.empty() && !is_alone) {
      listen(heard.path(), urdf);
      bag = heard.path();
    }
    try {
      if (!options_.config.empty()) given_ = readMonitorConfig(options_.config);
      if (!urdf.empty()) readModel(urdf);
      if (is_alone) return tell({});
      return look(bag);
    } catch (const ConfigError& error) {
      return tell({error.what()});
    }
  }

 private:
  void listen(const std::string& bag, std::string& urdf) const {
    if (!ros::master::check()) {
      throw InputError("no ROS master at " + ros::master::getURI() +
                       ": start the robot, or name a recording by --bag");
    }
    if (urdf.empty() && !ros::param::get("robot_description", urdf)) {
      throw InputError("the parameter robot_description is not there: name the robot by --urdf");
    }
    tellStep(formatted("listening for %.0f s", options_.seconds));
    recordRobot(options_.seconds, bag, progressBar());
  }

  void readModel(const std::string& urdf) {
    RobotModel::Config config;
    if (given_) config = given_->robot;
    model_ = std::make_shared<const RobotModel>(urdf, config, resourcesIn(options_.package_path));
    for (const std::string& warning : model_->warnings()) std::cout << "note: " << warning << '\n';
  }

  int look(const std::string& bag) {
    tellStep("which sensors, joints and frames there are");
    const Survey survey = surveyOf(bag, progressBar());
    if (survey.sensors.empty()) return tell({"no scans and no clouds came"});
    if (!model_) std::cout << "note: no robot is named, so that nothing is checked\n";
    SetupDraft draft(survey, model_);
    const HeardRobot robot{bag, model_};
    std::string joint_states = draft.jointTopic();
    MonitorConfig settings;
    if (given_) {
      settings = *given_;
      joint_states = settings.topics.joint_states;
    } else {
      if (draft.sensors().empty()) return tell({whyNoSensor(survey)});
      tellStep("how late inputs come, where the floor is, and what is seen of the arms");
      draft.learn(learn(robot, draft), options_.patient);
      if (model_) compareWithModel(robot, draft);
      if (options_.gate) draft.setGate(controllersBehindGate());
      for (const std::string& note : draft.notes()) std::cout << "note: " << note << '\n';
      settings = draft.settings();
      if (!options_.check) writeText(options_.out, draft.yaml());
    }
    settings.checker.checker.permission.hold_until_reset = false;  // each fault is to be seen
    tellStep("what would stop the robot with this configuration");
    Evaluation evaluation(settings, model_, {});
    robot.play(settings, joint_states, evaluation);
    if (!options_.check && !given_) std::cout << "written  " << options_.out << '\n';
    const std::vector<std::string> findings = findingsOf(evaluation, settings);
    return tell(findings.empty() ? draft.defects() : findings);  // which may follow from those
  }

  void compareWithModel(const HeardRobot& robot, SetupDraft& draft) const {
    tellStep("whether the arms are where their model has them");
    const OwnReturns own = measureOwnReturns(robot, draft);
    if (draft.learnModel(own) || options_.check) return;
    const std::string picture =
        std::filesystem::path(options_.out).replace_extension(".model.png").string();
    drawOwnReturns(*model_, own, picture);
    std::cout << "picture  " << picture << '\n';
  }

  static std::vector<ArmController> controllersBehindGate() {
    std::vector<ArmController> controllers = runningControllers();
    if (!controllers.empty()) return controllers;
    throw InputError(
        "--gate: no controller runs that has the action follow_joint_trajectory and its joints on "
        "the parameter server");
  }

  const Options& options_;
  std::optional<MonitorConfig> given_;
  std::shared_ptr<const RobotModel> model_;
};

int setUp(Options& options) { return Setup(options).run(); }

}  // namespace
}  // namespace tccm

// Its arguments may not fit into memory; then it ends.
// NOLINTNEXTLINE(bugprone-exception-escape)
int main(int argc, char** argv) {
  ros::init(argc, argv, "tccm_monitor_setup", ros::init_options::AnonymousName);
  return tccm::runProgram("setup",
                          "Writes a configuration for a robot from what it publishes, and says "
                          "what would stop it.",
                          {argv, argv + argc}, tccm::describe, tccm::setUp);
}
