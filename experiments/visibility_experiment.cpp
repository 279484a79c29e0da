#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "experiments/csv.h"
#include "experiments/experiment.h"
#include "experiments/parallel.h"
#include "experiments/visibility_trial.h"
#include "simulation/robot/dual_arm.h"

namespace tccm::simulation {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kAgrees = 0.05;  // of a silhouette

struct VisibilityOptions {
  VisibilityTrial::Config trial;
  std::string robot = "in_pose";
  std::size_t poses = 1000;
  double in_range_min = 0.98;
  double silhouette_min_pixels = 2.0;
  double agree_min = 0.95;
};

void declare(CLI::App& command, VisibilityOptions& options) {
  command.footer(
      "Random poses of both arms, in every scene, with a pole, a human arm, a box or nothing\n"
      "between them and the laser. The monitor's visible fraction of each occlusion link is\n"
      "compared with what rays from the laser onto the true shapes say. Links whose silhouette\n"
      "leaves the tilt's range, or shows less than some pixels, are left out.\n"
      "Limits: the mean absolute difference is below 5 percentage points, over all and for each\n"
      "link, and so is the difference of all but a few.");
  command.option_defaults()->always_capture_default();
  command.add_option("--poses", options.poses)->check(CLI::Range(1, 1000000));
  command.add_option("--robot", options.robot, "where it is while the map fills")
      ->check(CLI::IsMember({"in_pose", "away"}));
  command.add_option("--noise-m", options.trial.noise_m, "standard deviation of a range");
  command.add_option("--clearance-m", options.trial.clearance_m,
                     "between the robot and everything else");
  command
      .add_option("--in-range-min", options.in_range_min,
                  "share of a link's silhouette that the laser must look at")
      ->check(CLI::Range(0.0, 1.0));
  command.add_option("--silhouette-min-pixels", options.silhouette_min_pixels)
      ->check(CLI::Range(0.0, 1e4));
  command
      .add_option("--agree-min", options.agree_min,
                  "share of cases that must agree within 5 percentage points")
      ->check(CLI::Range(0.0, 1.0));
  command.add_option("--ray-rad", options.trial.resolution_rad, "between the true rays");
}

/// How far the monitor is off, over many cases.
class Errors {
 public:
  void add(double error) { errors_.push_back(error); }

  [[nodiscard]] std::size_t count() const { return errors_.size(); }
  [[nodiscard]] double mean() const {
    double sum = 0.0;
    for (const double error : errors_) sum += error;
    return sum / cases();
  }
  [[nodiscard]] double meanAbsolute() const {
    double sum = 0.0;
    for (const double error : errors_) sum += std::abs(error);
    return sum / cases();
  }
  [[nodiscard]] double agreeing() const {
    const auto agree = std::count_if(errors_.begin(), errors_.end(),
                                     [](double error) { return std::abs(error) <= kAgrees; });
    return static_cast<double>(agree) / cases();
  }
  /// Of the absolute ones. @param share 1: the greatest.
  [[nodiscard]] double percentile(double share) const {
    if (errors_.empty()) return 0.0;
    std::vector<double> absolute;
    for (const double error : errors_) absolute.push_back(std::abs(error));
    std::sort(absolute.begin(), absolute.end());
    return absolute[static_cast<std::size_t>(share * static_cast<double>(absolute.size() - 1))];
  }
  [[nodiscard]] Json toJson() const {
    return {{"cases", count()},
            {"mean_difference", mean()},
            {"mean_absolute_difference", meanAbsolute()},
            {"percentile_95", percentile(0.95)},
            {"greatest", percentile(1.0)},
            {"share_within_5_points", agreeing()}};
  }

 private:
  [[nodiscard]] double cases() const {
    return static_cast<double>(std::max<std::size_t>(errors_.size(), 1));
  }
  std::vector<double> errors_;
};

std::string rowOf(const VisibilityTrial::Result& trial, const LinkComparison& link, bool counts) {
  return std::to_string(trial.seed) + ',' + trial.scene + ',' + trial.obstacle + ',' + link.link +
         ',' + fixed(link.silhouette_pixels, 1) + ',' + fixed(link.in_range, 3) + ',' +
         (counts ? "1," : "0,") + fixed(link.true_fraction, 4) + ',' +
         fixed(link.visible_fraction, 4) + ',' + fixed(link.occluded_fraction, 4) + ',' +
         fixed(link.unseen_fraction, 4) + ',' + fixed(link.error(), 4) + '\n';
}

std::string lineOf(const std::string& what, const Errors& errors) {
  char text[200];
  std::snprintf(text, sizeof text,
                "%-22s %5zu cases, off by %+.3f on average, |%.3f|, 95 %% within %.3f, at most "
                "%.3f; %.1f %% within 0.05",
                what.c_str(), errors.count(), errors.mean(), errors.meanAbsolute(),
                errors.percentile(0.95), errors.percentile(1.0), 100.0 * errors.agreeing());
  return text;
}

void add(const std::vector<VisibilityTrial::Result>& trials, const VisibilityOptions& options,
         Findings& findings) {
  Errors all, hidden;
  std::map<std::string, Errors> by_link;
  for (const VisibilityTrial::Result& trial : trials) {
    findings.simulated_s += trial.simulated_s;
    for (const LinkComparison& link : trial.links) {
      const bool counts = link.in_range >= options.in_range_min &&
                          link.silhouette_pixels >= options.silhouette_min_pixels;
      findings.rows += rowOf(trial, link, counts);
      if (!counts) continue;
      all.add(link.error());
      by_link[link.link].add(link.error());
      if (link.true_fraction < 1.0 - kAgrees) hidden.add(link.error());
    }
  }
  bool link_missed = false;
  for (const auto& [link, errors] : by_link) {
    findings.figures["links"][link] = errors.toJson();
    findings.lines.push_back(lineOf(link, errors));
    link_missed = link_missed || errors.meanAbsolute() >= kAgrees;
  }
  findings.figures["all"] = all.toJson();
  findings.figures["partly_hidden"] = hidden.toJson();
  findings.lines.push_back(lineOf("partly hidden ones", hidden));
  findings.lines.push_back(lineOf("all", all));
  if (link_missed) findings.missed.emplace_back("mean_absolute_difference");
  if (all.agreeing() < options.agree_min) findings.missed.emplace_back("share_within_5_points");
}

Findings runVisibility(VisibilityOptions options, const TrialOptions& common,
                       const Progress& progress) {
  const MonitorConfig settings = trialSettings(common);
  options.trial.monitor = settings.monitor();
  options.trial.robot = visibilityRobot(options.robot);
  options.trial.validate();
  const auto model = std::make_shared<const RobotModel>(dualArmUrdf(), settings.robot);
  std::vector<VisibilityTrial::Result> trials(options.poses);
  inParallel(
      trials.size(), common.jobs,
      [&](std::size_t i) {
        trials[i] = VisibilityTrial(options.trial, model, seedOf(common, i)).run();
      },
      progress);
  Findings findings;
  findings.settings = {{"poses", options.poses},
                       {"robot", options.robot},
                       {"noise_m", options.trial.noise_m},
                       {"clearance_m", options.trial.clearance_m},
                       {"in_range_min", options.in_range_min},
                       {"silhouette_min_pixels", options.silhouette_min_pixels},
                       {"margin_m", options.trial.monitor.checker.pose.occlusion.margin_m}};
  findings.rows =
      "seed,scene,obstacle,link,silhouette_pixels,in_range,counted,true_visible,visible,occluded,"
      "unseen,difference\n";
  add(trials, options, findings);
  return findings;
}

}  // namespace

Experiment visibilityExperiment(CLI::App& app) {
  auto options = std::make_shared<VisibilityOptions>();
  CLI::App* command = app.add_subcommand("visibility", "how much of each link the sensor can see");
  declare(*command, *options);
  return {command, [options](const TrialOptions& common, const Progress& progress) {
            return runVisibility(*options, common, progress);
          }};
}

}  // namespace tccm::simulation
