#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "bag_stream.h"
#include "evaluation.h"
#include "program.h"
#include "report.h"

namespace tccm {
namespace {

struct Options {
  std::string bag;
  std::string urdf;
  std::string config;
  std::string out;
  std::string package_path;
  std::string dump_points;
  std::string dump_cuboids;
  std::string dump_verdicts;
  std::string dump_visibility;
};

void describe(CLI::App& app, Options& options) {
  app.footer(
      "Without --urdf the surroundings are mapped and nothing is checked.\n"
      "Exit status: 0 done, 1 no scan was mapped, 2 bad input; 1 and 2 with a line that says why.\n"
      "Example: evaluate --bag run.bag --urdf robot.urdf --config config/pr2.yaml --out result");
  app.add_option("--bag", options.bag, "recording with scans, /tf, /tf_static and joint states")
      ->required();
  app.add_option("--urdf", options.urdf, "the robot that is filtered out of scans and checked");
  app.add_option("--config", options.config,
                 "YAML with topics and the nodelets' parameters; defaults where it says nothing");
  app.add_option("--out", options.out, "folder for summary.json; made where it is not there")
      ->required();
  app.add_option("--package-path", options.package_path,
                 "folder with a robot's packages: package://P/x is DIR/P/x where P is there, and "
                 "is looked for among the ROS packages elsewhere");
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

/// Nothing where no robot is asked for.
std::shared_ptr<const RobotModel> readModel(const Options& options, const MonitorConfig& settings) {
  const RobotResources resources = resourcesIn(options.package_path);
  if (options.urdf.empty()) return nullptr;
  const auto model = std::make_shared<const RobotModel>(readText(options.urdf, "the URDF"),
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

void play(const BagStream& bag, Evaluation& evaluation) {
  BagStream::Sink sink;
  const auto add = [&](const auto& message, std::size_t sensor, const auto& from) {
    evaluation.add(message, sensor, from);
  };
  sink.scan = add;
  sink.cloud = add;
  sink.joint_states = [&](const auto& message, const auto& from) { evaluation.add(message, from); };
  sink.transforms = [&](const auto& message, bool fixed) { evaluation.add(message, fixed); };
  sink.progress = progressBar();
  bag.play(sink);
  evaluation.finish();
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

int evaluate(Options& options) {
  const MonitorConfig settings = readMonitorConfig(options.config);
  const auto model = readModel(options, settings);
  BagStream::Topics topics{{}, settings.topics.joint_states, model != nullptr};
  for (const SensorConfig& sensor : settings.sensors()) {
    topics.sensors.push_back({sensor.topic, sensor.cloud_assembler.has_value()});
  }
  const BagStream bag(options.bag, topics);
  makeFolder(options.out);
  const Dumps dumps(options, settings.sensors());
  Evaluation::Observer observer;
  observer.mapped = [&dumps](const Monitor& monitor, std::size_t sensor) {
    if (dumps.points[sensor]) dumpPoints(monitor, sensor, *dumps.points[sensor]);
  };
  if (dumps.verdicts || dumps.visibility) {
    observer.checked = [&dumps](const Verdict& verdict, const Checker& checker) {
      if (dumps.verdicts) dumpVerdict(verdict, *dumps.verdicts);
      if (dumps.visibility) dumpVisibility(verdict, checker, *dumps.visibility);
    };
  }
  Evaluation evaluation(settings, model, observer);
  play(bag, evaluation);
  requireFixedFrame(evaluation);
  for (std::size_t i = 0; i < dumps.cuboids.size(); ++i) {
    const CuboidMap* map = evaluation.monitor().map(i);
    if (dumps.cuboids[i] && map != nullptr) dumpCuboids(*map, *dumps.cuboids[i]);
  }
  dumps.close();

  const auto summary = summaryOf(evaluation, settings);
  const std::string path = (std::filesystem::path(options.out) / "summary.json").string();
  writeText(path, summary.dump(2) + '\n');
  printSummary(summary, std::cout);
  printStops(evaluation.totals(), std::cout);
  std::cout << "written  " << path << std::endl;
  if (evaluation.totals().scans_mapped > 0) return kDone;
  std::cerr << "evaluate: " << whyNothingMapped(evaluation, settings) << '\n';
  return kLimitMissed;
}

}  // namespace
}  // namespace tccm

int main(int argc, char** argv) {
  return tccm::runProgram("evaluate",
                          "Replays a bag through the monitor's core as fast as it can, without a "
                          "roscore.",
                          {argv, argv + argc}, tccm::describe, tccm::evaluate);
}
