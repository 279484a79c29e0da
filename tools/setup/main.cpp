/// Writes a configuration for a robot from what it publishes, and says what would stop it.

#include <ros/init.h>
#include <ros/master.h>
#include <ros/param.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "draft.h"
#include "findings.h"
#include "listener.h"
#include "survey.h"
#include "tccm_monitor/config_error.h"
#include "tools/bag_stream.h"
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

/// Of those that are no fault.
void noteLargest(double age_s, double at_most_s, double& largest_s) {
  if (age_s <= at_most_s) largest_s = std::max(largest_s, age_s);
}

/// Of all sensors that the settings name.
std::unique_ptr<BagStream> streamOf(const std::string& bag, const MonitorConfig& settings,
                                    const std::string& joint_states) {
  BagStream::Topics topics{{}, joint_states, false};
  for (const SensorConfig& sensor : settings.sensors()) {
    topics.sensors.push_back({sensor.topic, sensor.cloud_assembler.has_value()});
  }
  return std::make_unique<BagStream>(bag, topics);
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
    std::cout << formatted("listening for %.0f s", options_.seconds) << std::endl;
    recordRobot(options_.seconds, bag, progressBar());
  }

  void readModel(const std::string& urdf) {
    RobotModel::Config config;
    if (given_) config = given_->robot;
    model_ = std::make_shared<const RobotModel>(urdf, config, resourcesIn(options_.package_path));
    for (const std::string& warning : model_->warnings()) std::cout << "note: " << warning << '\n';
  }

  int look(const std::string& bag) {
    const Survey survey = surveyOf(bag, progressBar());
    if (survey.sensors.empty()) return tell({"no scans and no clouds came"});
    if (!model_) std::cout << "note: no robot is named, so that nothing is checked\n";
    SetupDraft draft(survey, model_);
    std::string joint_states = draft.jointTopic();
    MonitorConfig settings;
    if (given_) {
      settings = *given_;
      joint_states = settings.topics.joint_states;
    } else {
      if (draft.sensors().empty()) return tell({whyNoSensor(survey)});
      draft.learn(learn(bag, draft), options_.patient);
      if (options_.gate) draft.setGate(controllersBehindGate());
      for (const std::string& note : draft.notes()) std::cout << "note: " << note << '\n';
      settings = draft.settings();
      if (!options_.check) writeText(options_.out, draft.yaml());
    }
    settings.checker.checker.permission.hold_until_reset = false;  // each fault is to be seen
    Evaluation evaluation(settings, model_, {});
    play(*streamOf(bag, settings, joint_states), evaluation, progressBar());
    if (!options_.check && !given_) std::cout << "written  " << options_.out << '\n';
    const std::vector<std::string> findings = findingsOf(evaluation, settings);
    return tell(findings.empty() ? draft.defects() : findings);  // which may follow from those
  }

  static std::vector<ArmController> controllersBehindGate() {
    std::vector<ArmController> controllers = runningControllers();
    if (!controllers.empty()) return controllers;
    throw InputError(
        "--gate: no controller runs that has the action follow_joint_trajectory and its joints on "
        "the parameter server");
  }

  Lessons learn(const std::string& bag, const SetupDraft& draft) const {
    constexpr std::size_t kPointsMax = 400000;
    constexpr std::size_t kEvery = 7;  // that a cloud's points are thinned to
    const MonitorConfig settings = draft.trialSettings();
    Lessons lessons;
    std::map<std::string, std::pair<double, std::size_t>> visible;
    Evaluation::Observer observer;
    std::size_t count = 0;
    const std::size_t sensors = draft.sensors().size();
    lessons.map_ages_s.resize(sensors, 0.0);
    std::vector<std::optional<Time>> newest(sensors);
    observer.mapped = [&](const Monitor& monitor, std::size_t sensor) {
      newest[sensor] = monitor.map(sensor)->stamp;
      for (const Vector3& p : monitor.returns(sensor).points) {
        if (++count % kEvery == 0 && lessons.points.size() < kPointsMax)
          lessons.points.push_back(p);
      }
    };
    observer.checked = [&](const Verdict& verdict, const Checker& checker) {
      noteLargest(toSeconds(verdict.stamp - verdict.joints_stamp), SetupDraft::kGapMax,
                  lessons.joint_age_s);
      for (std::size_t i = 0; i < sensors; ++i) {
        if (!newest[i]) continue;
        const double rate = std::max(1.0, draft.sensors()[i].heard->rate());
        noteLargest(toSeconds(verdict.stamp - *newest[i]), SetupDraft::kPeriodsMax / rate,
                    lessons.map_ages_s[i]);
      }
      if (!verdict.placed || !verdict.known) return;
      for (const LinkVisibility& link : verdict.now.links) {
        if (link.silhouette < settings.checker.checker.pose.occlusion.silhouette_min_pixels)
          continue;
        auto& [sum, times] = visible[checker.model()->links()[link.link]];
        sum += link.visible_fraction;
        ++times;
      }
    };
    Evaluation evaluation(settings, model_, observer);
    play(*streamOf(bag, settings, draft.jointTopic()), evaluation, progressBar());
    for (const auto& [link, of_link] : visible) {
      lessons.visible[link] = of_link.first / static_cast<double>(of_link.second);
    }
    for (std::size_t i = 0; i < draft.sensors().size(); ++i) {
      lessons.points_in_area.push_back(evaluation.totals().sensors[i].points_mapped);
      const auto period = evaluation.monitor().mapper(i).tiltPeriod();
      lessons.tilt_periods_s.push_back(period ? std::optional<double>(toSeconds(*period))
                                              : std::nullopt);
    }
    return lessons;
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
