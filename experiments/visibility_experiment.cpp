#include <algorithm>
#include <cmath>
#include <map>

#include "experiments/csv.h"
#include "experiments/experiment.h"
#include "experiments/options.h"
#include "experiments/result_members.h"
#include "experiments/statistics.h"
#include "experiments/visibility_trial.h"

namespace tccm::simulation {
namespace {

constexpr About kAbout = {
    "visibility", "how much of each link the sensor can see",
    R"(Random poses of both arms, in every scene, with a pole, a human arm, a box or nothing
between them and the laser. The monitor's visible fraction of each occlusion link is
compared with what rays from the laser onto the true shapes say. Links whose silhouette
leaves the tilt's range, or shows less than some pixels, are left out.
Limits: the mean absolute difference is below 5 percentage points, over all and for each
link, and so is the difference of all but a few.)"};

constexpr double kAgrees = 0.05;  // of a silhouette

struct VisibilityOptions {
  VisibilityTrial::Config trial;
  std::string robot = "in_pose";
  std::size_t poses = 1000;
  LinksThatCount counted;
  double agree_min = 0.95;
};

void declare(CLI::App& command, VisibilityOptions& options) {
  command.add_option("--poses", options.poses)->check(CLI::Range(1, 1000000));
  command.add_option("--robot", options.robot, "where it is while the map fills")
      ->check(CLI::IsMember({"in_pose", "away"}));
  addNoise(command, options.trial.noise_m);
  command.add_option("--clearance-m", options.trial.clearance_m,
                     "between the robot and everything else");
  addLinksThatCount(command, options.counted);
  addShare(command, "--agree-min", options.agree_min,
           "share of cases that must agree within 5 percentage points");
  command.add_option("--ray-rad", options.trial.resolution_rad, "between the true rays");
}

Json settingsOf(const VisibilityOptions& options) {
  return {{"poses", options.poses},
          {"robot", options.robot},
          {"noise_m", options.trial.noise_m},
          {"clearance_m", options.trial.clearance_m},
          {"in_range_min", options.counted.in_range_min},
          {"silhouette_min_pixels", options.counted.silhouette_min_pixels},
          {"margin_m", options.trial.monitor.checker.pose.occlusion.margin_m}};
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
    std::vector<double> absolute;
    for (const double error : errors_) absolute.push_back(std::abs(error));
    std::sort(absolute.begin(), absolute.end());
    return quantile(absolute, share);
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

constexpr char kColumns[] =
    "seed,scene,obstacle,link,silhouette_pixels,in_range,counted,true_visible,visible,occluded,"
    "unseen,difference";

std::string rowOf(const VisibilityTrial::Result& trial, const LinkComparison& link, bool counts) {
  return csvRow(trial.seed, trial.scene, trial.obstacle, link.link,
                fixed(link.silhouette_pixels, 1), fixed(link.in_range, 3), counts,
                fixed(link.true_fraction, 4), fixed(link.visible_fraction, 4),
                fixed(link.occluded_fraction, 4), fixed(link.unseen_fraction, 4),
                fixed(link.error(), 4));
}

std::string lineOf(const std::string& what, const Errors& errors) {
  return formatted(
      "%-22s %5zu cases, off by %+.3f on average, |%.3f|, 95 %% within %.3f, at most "
      "%.3f; %.1f %% within 0.05",
      what.c_str(), errors.count(), errors.mean(), errors.meanAbsolute(), errors.percentile(0.95),
      errors.percentile(1.0), 100.0 * errors.agreeing());
}

Findings findingsOf(const std::vector<VisibilityTrial::Result>& trials,
                    const VisibilityOptions& options) {
  Findings findings(settingsOf(options), kColumns);
  Errors all, hidden;
  std::map<std::string, Errors> by_link;
  for (const VisibilityTrial::Result& trial : trials) {
    findings.simulated_s += trial.simulated_s;
    for (const LinkComparison& link : trial.links) {
      const bool counts = options.counted.has(link.in_range, link.silhouette_pixels);
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
  return findings;
}

Findings runVisibility(VisibilityOptions options, const TrialRun& run) {
  options.trial.robot = visibilityRobot(options.robot);
  run.prepare(options.trial);
  options.counted.validate();
  return findingsOf(run.resultsOf<VisibilityTrial>(options.poses, options.trial), options);
}

}  // namespace

Experiment visibilityExperiment(CLI::App& app) {
  return experiment(app, kAbout, declare, runVisibility, VisibilityOptions());
}

}  // namespace tccm::simulation
