#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bag_stream.h"
#include "cloud_folder.h"
#include "evaluation.h"
#include "program.h"
#include "replayed_stop.h"
#include "report.h"
#include "stop_scenes.h"
#include "timeline.h"
#include "what_if.h"

namespace tccm {
namespace {

struct Options {
  std::string bag;
  std::string stop;
  std::string clouds;
  double cloud_rate_hz = 30.0;
  std::vector<double> sensor_pose;
  std::string urdf;
  std::string config;
  std::string out;
  std::string package_path;
  std::string dump_points;
  std::string dump_cuboids;
  std::string dump_verdicts;
  std::string dump_visibility;
  bool report = false;
  bool no_times = false;
  std::vector<std::string> compare;
  std::string sweep;
  std::string reference;
};

void describeDumps(CLI::App& app, Options& options) {
  app.add_option("--dump-points", options.dump_points,
                 "CSV of the points that reached the map: scan,x,y,z; of sensors with names one "
                 "each, FILE.NAME.csv");
  app.add_option("--dump-cuboids", options.dump_cuboids,
                 "CSV of the map after the last scan: x,y,bottom,top,age_scans,dyn,held; likewise");
  app.add_option("--dump-verdicts", options.dump_verdicts,
                 "CSV of all checks: stamp,scan,collision,occlusion,stop,reason,link; the stamp is "
                 "the joint state's, the scan the newest in the map");
  app.add_option("--dump-visibility", options.dump_visibility,
                 "CSV of what was seen of each watched link in each check: "
                 "stamp,scan,link,ahead,visible,occluded,unseen,way_unseen,evidence_age_s,"
                 "next_look_s; the stamp is the check's");
}

void describe(CLI::App& app, Options& options) {
  app.footer(
      "Without --urdf the surroundings are mapped and nothing is checked.\n"
      "Exit status: 0 done, 1 no scan was mapped, 2 bad input, each but 0 with a line that says "
      "why; 130 after Ctrl-C, with what was evaluated until then.\n"
      "Example: evaluate --bag run.bag --urdf robot.urdf --config config/pr2.yaml --out result");
  auto* bag = app.add_option("--bag", options.bag,
                             "recording with scans or clouds, /tf, /tf_static and joint states");
  auto* clouds = app.add_option("--clouds", options.clouds,
                                "folder of PCD files, a cloud each, of one sensor that stood "
                                "still; the config names it");
  app.add_option("--cloud-rate", options.cloud_rate_hz, "of the PCD files [Hz]")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str()
      ->needs(clouds);
  app.add_option("--sensor-pose", options.sensor_pose,
                 "of the PCD files' sensor in the fixed frame: x y z [m] and roll pitch yaw [rad]; "
                 "without it each file's VIEWPOINT counts")
      ->expected(6)
      ->needs(clouds);
  auto* stop = app.add_option("--stop", options.stop,
                              "bag of a stop, as the checker writes it: says whether it stops "
                              "again, for the same reason");
  auto* urdf =
      app.add_option("--urdf", options.urdf, "the robot that is filtered out of scans and checked");
  auto* source = app.add_option_group("recording");
  source->add_options(bag, clouds, stop);
  source->require_option(1);
  clouds->excludes(urdf);
  app.add_option("--config", options.config,
                 "YAML with topics and the nodelets' parameters; defaults where it says nothing");
  app.add_option("--out", options.out,
                 "folder for summary.json and timing.json; made where it is not there");
  app.add_option("--package-path", options.package_path,
                 "folder with a robot's packages: package://P/x is DIR/P/x where P is there, and "
                 "is looked for among the ROS packages elsewhere");
  app.add_flag("--report", options.report,
               "for people: report.html, with pictures of each stop beside it, and what they are "
               "drawn from");
  auto* no_times = app.add_flag("--no-times", options.no_times,
                                "no computing times: all that is written is the same in each run");
  auto* compare = app.add_option("--compare", options.compare,
                                 "two configurations: which stops come, go and move from the first "
                                 "to the second");
  compare->expected(2)->needs(app.get_option("--urdf"));
  auto* sweep = app.add_option("--sweep", options.sweep,
                               "key=from:to:step: the stops, clearance and cost at each value of "
                               "one parameter, and against those of --reference");
  sweep->needs(app.get_option("--urdf"));
  app.add_option("--reference", options.reference,
                 "configuration whose stops are right; without it that of --config")
      ->needs(sweep);
  compare->excludes(sweep);
  sweep->excludes(no_times);  // it measures them
  describeDumps(app, options);
}

/// Nothing where no robot is asked for.
std::shared_ptr<const RobotModel> readModel(const Options& options, const MonitorConfig& settings) {
  const RobotResources resources = resourcesIn(options.package_path);
  if (options.urdf.empty()) return nullptr;
  auto model = std::make_shared<const RobotModel>(readText(options.urdf, "the URDF"),
                                                  settings.robot, resources);
  tellWarnings(*model, "evaluate");
  return model;
}

/// Of a named sensor: points.csv becomes points.laser.csv.
std::string pathFor(const std::string& path, const std::string& sensor) {
  if (path.empty() || sensor.empty()) return path;
  std::filesystem::path file(path);
  return file.replace_extension("." + sensor + file.extension().string()).string();
}

/// The dumps that were asked for; null where not.
struct Dumps {
  using File = std::unique_ptr<CsvFile>;
  std::vector<File> points, cuboids;  ///< by sensor
  File verdicts;
  File visibility;

  Dumps(const Options& options, const std::vector<SensorConfig>& sensors) {
    const auto open = [](const std::string& path, const char* header) {
      return path.empty() ? nullptr : std::make_unique<CsvFile>(path, header);
    };
    for (const SensorConfig& sensor : sensors) {
      points.push_back(open(pathFor(options.dump_points, sensor.name), "scan,x,y,z"));
      cuboids.push_back(
          open(pathFor(options.dump_cuboids, sensor.name), "x,y,bottom,top,age_scans,dyn,held"));
    }
    verdicts = open(options.dump_verdicts, "stamp,scan,collision,occlusion,stop,reason,link");
    visibility = open(options.dump_visibility,
                      "stamp,scan,link,ahead,visible,occluded,unseen,way_unseen,evidence_age_s,"
                      "next_look_s");
  }
  void close() const {
    for (const auto* files : {&points, &cuboids}) {
      for (const File& file : *files) {
        if (file) file->close();
      }
    }
    for (const File* file : {&verdicts, &visibility}) {
      if (*file) (*file)->close();
    }
  }
};

/// What is drawn.
struct Report {
  Timeline timeline;
  StopScenes scenes;

  explicit Report(const std::filesystem::path& folder) : timeline(folder / "timeline.csv") {}
  void add(const Verdict& verdict, const Checker& checker, Time start) {
    timeline.add(verdict, checker, start);
    scenes.add(verdict, checker, start);
  }
};

/// From x y z [m] and roll pitch yaw [rad], as a URDF's origin has it.
Pose poseOf(const std::vector<double>& numbers) {
  Pose pose = Pose::Identity();
  pose.translation() = Vector3(numbers[0], numbers[1], numbers[2]);
  pose.linear() = (Eigen::AngleAxisd(numbers[5], Vector3::UnitZ()) *
                   Eigen::AngleAxisd(numbers[4], Vector3::UnitY()) *
                   Eigen::AngleAxisd(numbers[3], Vector3::UnitX()))
                      .toRotationMatrix();
  return pose;
}

/// A frame that no transform names is a slip in the configuration, not a bad recording.
/// @throws InputError
void requireFixedFrame(const Evaluation& evaluation) {
  const auto& frames = evaluation.frames();
  if (frames.count(evaluation.fixedFrame()) > 0) return;
  std::string names;
  for (const std::string& frame : frames) names += (names.empty() ? "" : ", ") + frame;
  throw InputError(
      "fixed_frame '" + evaluation.fixedFrame() +
      "' is in no transform of the bag, which has: " + (names.empty() ? "none" : names));
}

/// @throws InputError
std::unique_ptr<Recording> openRecording(const Options& options, const MonitorConfig& settings) {
  const std::vector<SensorConfig> sensors = settings.sensors();
  if (!options.clouds.empty()) {
    if (sensors.size() != 1 || !sensors.front().cloud_assembler) {
      throw InputError("--clouds: the config has to name one sensor, with a cloud_assembler");
    }
    std::optional<Pose> pose;
    if (!options.sensor_pose.empty()) pose = poseOf(options.sensor_pose);
    return std::make_unique<CloudFolder>(CloudFolder::Config{options.clouds, options.cloud_rate_hz,
                                                             settings.checker.fixed_frame, pose});
  }
  BagStream::Topics topics{{}, settings.topics.joint_states, !options.urdf.empty()};
  for (const SensorConfig& sensor : sensors) {
    topics.sensors.push_back({sensor.topic, sensor.cloud_assembler.has_value()});
  }
  return std::make_unique<BagStream>(options.bag, topics);
}

struct Interruption {};

/// @return whether it was played to its end; Ctrl-C ends it earlier, and finishes the evaluation.
bool playAll(const Recording& recording, Evaluation& evaluation) {
  const Progress bar = progressBar();
  deferInterrupt();
  try {
    play(recording, evaluation, [&bar](double fraction_done) {
      if (isInterrupted()) throw Interruption();
      if (bar) bar(fraction_done);
    });
  } catch (const Interruption&) {
    evaluation.finish();
    return false;
  }
  return true;
}

/// Where they are asked for. Those of an earlier run would be drawn.
void writeTimes(const Options& options, const Totals& totals) {
  const std::filesystem::path path = std::filesystem::path(options.out) / "timing.json";
  if (options.no_times) {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    return;
  }
  const auto timing = timesOf(totals, options.report);
  writeText(path.string(), timing.dump(2) + '\n');
  printTimes(timing, std::cout);
}

/// @return the exit status.
int conclude(const Options& options, const MonitorConfig& settings, const Evaluation& evaluation,
             Report* report, bool interrupted) {
  const std::filesystem::path folder(options.out);
  auto summary = summaryOf(evaluation, settings);
  if (interrupted) summary["interrupted"] = true;
  const std::string path = (folder / "summary.json").string();
  writeText(path, summary.dump(2) + '\n');
  printSummary(summary, std::cout);
  writeTimes(options, evaluation.totals());
  printStops(evaluation.totals(), std::cout);
  std::cout << "written  " << path << std::endl;
  if (report != nullptr) {
    report->timeline.close();
    const auto scenes = report->scenes.json(evaluation, settings, interrupted);
    writeText((folder / "scenes.json").string(), scenes.dump() + '\n');
    const int status = runScript("draw_evaluation", {options.out});
    if (status == kInterrupted) return status;
    if (status != kDone) throw InputError("the report was not drawn");
  }
  if (interrupted) std::cerr << "evaluate: interrupted; what was played until then is written\n";
  if (interrupted) return kInterrupted;
  if (evaluation.totals().scans_mapped > 0) return kDone;
  std::cerr << "evaluate: " << whyNothingMapped(evaluation, settings) << '\n';
  return kLimitMissed;
}

/// What other configurations would have made of it. @return the exit status.
int askWhatIf(const Options& options) {
  makeFolder(options.out);
  const WhatIf what_if{
      [&options](const MonitorConfig& settings) { return openRecording(options, settings); },
      [&options](const MonitorConfig& settings) { return readModel(options, settings); },
      options.out};
  const auto trialOf = [](const std::string& config) {
    return Trial{config.empty() ? "the defaults" : config, readMonitorConfig(config)};
  };
  if (!options.compare.empty()) {
    return compareTrials(what_if, {trialOf(options.compare[0]), trialOf(options.compare[1])});
  }
  return sweepTrials(what_if,
                     trialOf(options.reference.empty() ? options.config : options.reference),
                     sweptTrials(options.config, options.sweep));
}

int evaluate(Options& options) {
  if (!options.stop.empty()) return replayStopIn(options.stop, std::cout);
  if (options.out.empty()) throw InputError("--out is required");
  if (!options.compare.empty() || !options.sweep.empty()) return askWhatIf(options);
  const MonitorConfig settings = readMonitorConfig(options.config);
  const auto model = readModel(options, settings);
  const auto recording = openRecording(options, settings);
  makeFolder(options.out);
  const Dumps dumps(options, settings.sensors());
  const auto report = options.report ? std::make_unique<Report>(options.out) : nullptr;
  std::optional<Evaluation> evaluation;
  Evaluation::Observer observer;
  observer.mapped = [&dumps](const Monitor& monitor, std::size_t sensor) {
    if (dumps.points[sensor]) dumpPoints(monitor, sensor, *dumps.points[sensor]);
  };
  if (dumps.verdicts || dumps.visibility || report) {
    observer.checked = [&](const Verdict& verdict, const Checker& checker) {
      if (dumps.verdicts) dumpVerdict(verdict, *dumps.verdicts);
      if (dumps.visibility) dumpVisibility(verdict, checker, *dumps.visibility);
      if (report) report->add(verdict, checker, *evaluation->totals().first_stamp);
    };
  }
  evaluation.emplace(settings, model, observer);
  const bool interrupted = !playAll(*recording, *evaluation);
  if (!interrupted) requireFixedFrame(*evaluation);
  for (std::size_t i = 0; i < dumps.cuboids.size(); ++i) {
    const CuboidMap* map = evaluation->monitor().map(i);
    if (dumps.cuboids[i] && map != nullptr) dumpCuboids(*map, *dumps.cuboids[i]);
  }
  dumps.close();
  return conclude(options, settings, *evaluation, report.get(), interrupted);
}

}  // namespace
}  // namespace tccm

// Its arguments may not fit into memory; then it ends.
// NOLINTNEXTLINE(bugprone-exception-escape)
int main(int argc, char** argv) {
  return tccm::runProgram("evaluate",
                          "Replays a bag through the monitor's core as fast as it can, without a "
                          "roscore.",
                          {argv, argv + argc}, tccm::describe, tccm::evaluate);
}
