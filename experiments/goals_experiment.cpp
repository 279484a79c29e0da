#include <algorithm>
#include <map>
#include <string>

#include "experiments/csv.h"
#include "experiments/experiment.h"
#include "experiments/goals_trial.h"
#include "experiments/markdown_table.h"
#include "ros/controller_parameters.h"
#include "ros/server_config.h"
#include "simulation/robot/dual_arm.h"

namespace tccm::simulation {
namespace {

constexpr About kAbout = {
    "goals", "random goals for an arm behind the gate, while obstacles come and go",
    R"(Through the nodelets of a running ROS system, at the pace of the wall clock: roslaunch
tccm_monitor trials.launch experiment:=goals. The right arm, whose controller is as ros_controllers'
JointTrajectoryController, gets goals for random places over a cluttered table by its gate's action,
some of them in what stands there. Poles and boxes are brought in, stand for 4 to 10 s and are taken
away. Some goals are cancelled, and some replaced. A contact is judged by FCL on the true shapes;
it is avoidable where the arm moved, and what it touched had stood in its place for 2.2 s: for a
tilt of the laser, and for what a verdict and a stop take.
Limits: no avoidable contact; every goal has a result within 60 s.)"};

struct GoalsOptions {
  GoalsTrial::Config trial;
  std::size_t goals = 50;
  bool through_nodelets = false;
};

void declare(CLI::App& command, GoalsOptions& options) {
  GoalsTrial::Config& trial = options.trial;
  command.add_option("--goals", options.goals, "in all")->check(CLI::Range(1, 100000));
  command.add_option("--goals-each", trial.goals, "until all begins anew")
      ->check(CLI::Range(1, 1000));
  command.add_option("--speed-min", trial.speed_min_rps, "of the fastest joint [rad/s]");
  command.add_option("--speed-max", trial.speed_max_rps);
  command.add_option("--obstacle-every-s", trial.obstacle_every_s, "on average");
  command.add_option("--noise-m", trial.noise_m, "standard deviation of a range");
  command.add_flag("--ros", options.through_nodelets, "it cannot be done without")
      ->always_capture_default(false);
}

/// As the simulated arms have them, and the gate reads them.
CommandedArms::Config controlledArms(const std::string& controller) {
  const auto parameters =
      ControllerParameters::from(parametersOf(ros::NodeHandle(controller)), controller, *dualArm());
  CommandedArms::Config arms;
  arms.controlled.push_back({{parameters.rules, parameters.stop_duration_s}, 0.0});
  return arms;
}

Findings findingsOf(const std::vector<GoalsTrial::Result>& trials, const GoalsOptions& options) {
  Findings findings(
      {{"goals", options.goals},
       {"goals_each", options.trial.goals},
       {"speed_rps", {options.trial.speed_min_rps, options.trial.speed_max_rps}},
       {"obstacle_every_s", options.trial.obstacle_every_s},
       {"noise_m", options.trial.noise_m},
       {"stop_duration_s", options.trial.arms.controlled.front().controller.stop_duration_s}},
      "seed,goal,end,took_s,reason,contact,stood_s,hand_mps,avoidable");
  std::map<std::string, std::size_t> ends;
  std::size_t goals = 0, contacts = 0, avoidable = 0;
  for (const GoalsTrial::Result& trial : trials) {
    for (std::size_t i = 0; i < trial.goals.size(); ++i) {
      const GoalsTrial::Goal& goal = trial.goals[i];
      ++ends[goal.end];
      ++goals;
      const bool is_last = trial.contact && i + 1 == trial.goals.size();
      findings.add(csvRow(trial.seed, i, goal.end, fixed(goal.took_s, 3), goal.reason,
                          is_last ? trial.contact->object : "",
                          is_last ? fixed(trial.contact->stood_s, 3) : "",
                          is_last ? fixed(trial.contact->hand_mps, 3) : "",
                          is_last && trial.contact->avoidable),
                   0.0);
    }
    findings.simulated_s += trial.simulated_s;
    if (!trial.contact) continue;
    ++contacts;
    avoidable += trial.contact->avoidable ? 1 : 0;
  }
  findings.figures = {{"goals", goals}, {"contacts", contacts}, {"avoidable", avoidable}};
  std::string text = "goals         ";
  for (const auto& [end, count] : ends) {
    findings.figures["ends"][end] = count;
    text += " " + std::to_string(count) + " " + end + ",";
  }
  text.back() = ' ';
  findings.lines = {text, "contacts       " + std::to_string(contacts) + ", avoidable " +
                              std::to_string(avoidable)};
  if (avoidable > 0) findings.missed.push_back("avoidable contacts: " + std::to_string(avoidable));
  if (ends.count("hangs") > 0) {
    findings.missed.push_back("goals without a result: " + std::to_string(ends["hangs"]));
  }
  return findings;
}

Findings runGoals(GoalsOptions options, const TrialRun& run) {
  if (!options.through_nodelets) {
    throw InputError("--ros: the gate is a nodelet: goals cannot be sent without it");
  }
  run.requireLaserAlone();
  run.requireWhole();
  NodeletGuardian nodelets(Simulator::Config().start);
  options.trial.guardian = &nodelets;
  options.trial.arms = controlledArms(options.trial.controller);
  options.trial.validate();
  std::vector<GoalsTrial::Result> results;
  std::size_t goals = 0;
  for (std::size_t i = 0; goals < options.goals; ++i) {
    GoalsTrial::Config config = options.trial;
    config.goals = std::min(config.goals, options.goals - goals);
    results.push_back(GoalsTrial(config, run.model, run.seedOf(i)).run());
    goals += results.back().goals.size();
    if (run.progress)
      run.progress(std::min(1.0, static_cast<double>(goals) / static_cast<double>(options.goals)));
  }
  return findingsOf(results, options);
}

}  // namespace

Experiment goalsExperiment(CLI::App& app) { return experiment(app, kAbout, declare, runGoals); }

}  // namespace tccm::simulation
