#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "experiments/options.h"
#include "experiments/self_filter_trial.h"
#include "experiments/sensor_options.h"
#include "experiments/simulated_settings.h"
#include "simulation/robot/dual_arm.h"
#include "tools/program.h"

namespace tccm::simulation {
namespace {

struct Options {
  SelfFilterTrial::Config trial;
  SensorOptions sensors;
  SelfFilterLimits limits;
  double minutes = 10.0;
  std::string body_error = "thicker";
  std::string config;
  std::string out;
};

void declare(CLI::App& app, Options& options) {
  Simulator::Config& simulator = options.trial.simulator;
  app.footer(
      "The arms keep clear of everything, so that every contact is false. Limits: no point of the\n"
      "robot's body in the map; no contact that the body's points or pixels mixed with it lie in\n"
      "or around; fewer of the scene's points in the map's area removed than --scene-removed-max.\n"
      "Exit status: 0 done, 1 a limit was missed, 2 bad input.\n"
      "Example: self_filter_trial --minutes 10 --noise-m 0.01 --body-error-m 0.005 --out result");
  app.option_defaults()->always_capture_default();
  app.add_option("--minutes", options.minutes, "simulated time")->check(CLI::Range(0.02, 600.0));
  app.add_option("--scene", simulator.scene)->check(CLI::IsMember(sceneNames()));
  app.add_option("--motion", simulator.motion, "wander: random postures, both arms")
      ->check(CLI::IsMember(simulatedMotions()));
  app.add_option("--speed", simulator.controller.speed_mps, "of the faster palm [m/s]");
  app.add_option("--clearance-m", simulator.wander_clearance_m,
                 "that wander keeps from the scene, now and where it would be 0.5 s later");
  app.add_option("--pause-every-s", options.trial.pause_every_s,
                 "the arms pause this often, for a quarter of it; 0: never");
  addNoise(app, simulator.scanner.noise_m);
  addMixedPixels(app, simulator.scanner);
  app.add_option("--spot-deg", simulator.scanner.spot_deg, "full width of a beam's spot");
  app.add_option("--body-error-m", simulator.body_error.size_m,
                 "how far the true body differs from what the monitor takes it for");
  app.add_option("--body-error", options.body_error, "how the true body differs")
      ->check(CLI::IsMember({"thicker", "thinner", "displaced"}));
  options.sensors.declare(app);
  app.add_option("--seed", simulator.seed);
  app.add_option("--config", options.config,
                 "YAML with the nodelets' parameters, as config/simulation.yaml; without it the "
                 "defaults, and what the simulated robot needs")
      ->always_capture_default(false);
  app.add_flag("--no-contacts", options.limits.any_contact,
               "a contact with pixels mixed off the scene alone misses a limit too")
      ->always_capture_default(false);
  addShare(app, "--scene-removed-max", options.limits.scene_share_removed);
  app.add_option("--out", options.out, "folder for summary.json; made where it is not there")
      ->required()
      ->always_capture_default(false);
}

nlohmann::ordered_json settingsToJson(const Options& options) {
  const Simulator::Config& simulator = options.trial.simulator;
  const ScanAssembler& assembler = options.trial.monitor.sensors.front().scan.assembler;
  return {
      {"minutes", options.minutes},
      {"seed", simulator.seed},
      {"scene", simulator.scene},
      {"motion", simulator.motion},
      {"speed_mps", simulator.controller.speed_mps},
      {"clearance_m", simulator.wander_clearance_m},
      {"pause_every_s", options.trial.pause_every_s},
      {"noise_m", simulator.scanner.noise_m},
      {"mixed_share", simulator.scanner.mixed_share},
      {"mixed_persistence", simulator.scanner.mixed_persistence},
      {"spot_deg", simulator.scanner.spot_deg},
      {"body_error_m", simulator.body_error.size_m},
      {"body_error", options.body_error},
      {"self_filter", options.trial.monitor.sensors.front().scan.self_filter},
      {"self_filter_padding_m",
       options.trial.monitor.sensors.front().scan.body.filtered.expansion.padding_m},
      {"self_filter_range_tolerance_m", assembler.body.range_tolerance_m},
      {"self_filter_grazing_m", assembler.body.grazing_m},
      {"self_filter_shadow_depth_m", assembler.body.shadow_depth_m},
      {"mixed_pixel_separation_m", assembler.mixed_pixel.separation_m},
      {"collision_padding_m", options.trial.monitor.checker.pose.collision_use.expansion.padding_m},
      {"support_points", options.trial.monitor.checker.pose.collision.support_points}};
}

void print(const SelfFilterTally& tally, const std::vector<std::string>& missed) {
  const BeamFates& own = tally.of(BeamSource::kOwn);
  const BeamFates& own_mixed = tally.of(BeamSource::kOwnMixed);
  const BeamFates& scene = tally.of(BeamSource::kScene);
  std::printf("%zu scans, %zu checks\n", tally.scans, tally.checks);
  std::printf("own points        %zu in the map, of %zu measured in its area\n", own.mapped(),
              own.measuredInArea());
  std::printf("mixed with own    %zu in the map, of %zu measured in its area\n", own_mixed.mapped(),
              own_mixed.measuredInArea());
  std::printf("false contacts    %zu checks, %zu of them with points of the body\n",
              tally.checks_with_contact, tally.contacts_with_body);
  std::printf("scene's points    %.3f %% removed of %zu measured in the area\n",
              100.0 * tally.sceneShareRemoved(), scene.measuredInArea());
  for (const std::string& limit : missed) std::printf("limit missed      %s\n", limit.c_str());
}

int run(Options& options) {
  MonitorConfig settings = simulatedSettings(options.config);
  const SensorChoice sensors = options.sensors.choice();
  sensors.applyTo(settings);
  sensors.applyTo(options.trial.simulator);
  options.trial.monitor = settings.monitor();
  options.trial.duration_s = 60.0 * options.minutes;
  options.trial.simulator.body_error.kind = bodyErrorKind(options.body_error);
  makeFolder(options.out);
  SelfFilterTrial trial(options.trial,
                        std::make_shared<const RobotModel>(dualArmUrdf(), settings.robot));
  const SelfFilterTally& tally = trial.run(progressBar());
  const std::vector<std::string> missed = options.limits.missed(tally);

  nlohmann::ordered_json summary = {{"settings", settingsToJson(options)}};
  summary.update(toJson(tally));
  summary["limits_missed"] = missed;
  const std::string path = (std::filesystem::path(options.out) / "summary.json").string();
  writeText(path, summary.dump(2) + '\n');
  print(tally, missed);
  std::printf("written           %s\n", path.c_str());
  return missed.empty() ? kDone : kLimitMissed;
}

}  // namespace
}  // namespace tccm::simulation

// Its arguments may not fit into memory; then it ends.
// NOLINTNEXTLINE(bugprone-exception-escape)
int main(int argc, char** argv) {
  using namespace tccm::simulation;
  Options options;
  options.trial.simulator.motion = "wander";
  options.trial.simulator.scanner.noise_m = 0.01;
  options.trial.simulator.body_error.size_m = 0.005;
  return tccm::runProgram("self_filter_trial",
                          "Moves the arms of a simulated robot before its tilting laser, and "
                          "counts what the self filter lets through and what it takes away.",
                          {argv, argv + argc}, declare, run, options);
}
