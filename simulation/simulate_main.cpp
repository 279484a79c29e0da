#include <rosbag/bag.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "ros/conversions.h"
#include "simulation/messages.h"
#include "simulation/simulator.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

struct Options {
  Simulator::Config simulator;
  std::string obstacle = "none";
  std::string obstacle_for = "collision";
  std::vector<std::string> sensors = {"laser"};
  std::string camera = "chest";
  double duration_s = 20.0;
  double stop_at_s = kNever;
  double scans_stop_at_s = kNever;
  double joints_stop_at_s = kNever;
  double tf_stop_at_s = kNever;
  std::string bag;
  std::string truth;
  rosbag::compression::CompressionType compression = rosbag::compression::LZ4;
};

void declare(CLI::App& app, Options& options) {
  Simulator::Config& s = options.simulator;
  app.option_defaults()->always_capture_default();
  app.add_option("--scene", s.scene)->check(CLI::IsMember(sceneNames()));
  app.add_option("--motion", s.motion)->check(CLI::IsMember(simulatedMotions()));
  app.add_option("--obstacle", options.obstacle)
      ->check(CLI::IsMember({"none", "pole", "arm", "box"}));
  app.add_option("--obstacle-for", options.obstacle_for)
      ->check(CLI::IsMember({"collision", "occlusion"}));
  app.add_option("--appear-s", s.appear_s, "the obstacle appears as soon after this as it can");
  app.add_option("--gap-m", s.gap_m, "between the hand and an obstacle ahead of it");
  app.add_option("--obstacle-speed", s.obstacle_speed_mps, "brought in at [m/s]; 0: at once");
  app.add_option("--speed", s.controller.speed_mps, "of the hand [m/s]");
  app.add_option("--duration-s", options.duration_s)->check(CLI::Range(0.1, 36000.0));
  app.add_option("--seed", s.seed);
  app.add_option("--noise-m", s.scanner.noise_m, "standard deviation of a range");
  app.add_option("--sensors", options.sensors, "any of laser, camera, lidar")
      ->delimiter(',')
      ->check(CLI::IsMember(sensorNames()));
  app.add_option("--camera", options.camera, "where the camera is")
      ->check(CLI::IsMember(cameraPlaces()));
  app.add_option("--stop-at", options.stop_at_s, "the arm hears a stop from then on [s]");
  app.add_option("--scans-stop-at", options.scans_stop_at_s,
                 "no scans and clouds from then on [s]");
  app.add_option("--joints-stop-at", options.joints_stop_at_s, "no joint states from then on [s]");
  app.add_option("--tf-stop-at", options.tf_stop_at_s, "no transforms from then on [s]");
  app.add_option("--bag", options.bag,
                 "bag to write: /scan, /joint_states, /tf, and with a camera or "
                 "lidar its clouds and /tf_static")
      ->required();
  app.add_option("--truth", options.truth, "JSON file to write what really happened to");
  const std::map<std::string, rosbag::compression::CompressionType> compressions = {
      {"none", rosbag::compression::Uncompressed},
      {"bz2", rosbag::compression::BZ2},
      {"lz4", rosbag::compression::LZ4}};
  app.add_option("--compression", options.compression, "none, bz2 or lz4 (the default)")
      ->always_capture_default(false)
      ->transform(CLI::CheckedTransformer(compressions));
}

/// What was recorded.
struct Counts {
  std::size_t scans = 0, frames = 0, turns = 0;
};

/// Writes what a step brought, as recorded at its end.
void record(const StepOutput& output, const Simulator& simulator, const Options& options,
            rosbag::Bag& bag, Counts& counts) {
  const double elapsed_s = toSeconds(simulator.now() - options.simulator.start);
  const ros::Time now = toRos(simulator.now());
  if (output.robot && elapsed_s < options.tf_stop_at_s) {
    bag.write("/tf", now, transformMessage(simulator.model(), *output.robot));
  }
  if (output.robot && elapsed_s < options.joints_stop_at_s) {
    bag.write("/joint_states", now, jointMessage(simulator.model(), *output.robot));
  }
  if (elapsed_s >= options.scans_stop_at_s) return;
  if (output.scan) {
    bag.write("/scan", now, toMessage(output.scan->scan, options.simulator.scanner.period_s));
    ++counts.scans;
  }
  if (output.clouds.camera) {
    bag.write(std::string("/") + kCameraTopic, now, cameraMessage(output.clouds.camera->cloud));
    ++counts.frames;
  }
  if (output.clouds.lidar) {
    bag.write(std::string("/") + kLidarTopic, now, lidarMessage(output.clouds.lidar->cloud));
    ++counts.turns;
  }
}

std::string describe(const Counts& counts) {
  std::string text = std::to_string(counts.scans) + " scans";
  if (counts.frames > 0) text += ", " + std::to_string(counts.frames) + " frames";
  if (counts.turns > 0) text += ", " + std::to_string(counts.turns) + " turns";
  return text;
}

std::string describe(const Truth& truth, Time start) {
  const auto since = [&](const std::optional<Time>& stamp) {
    return stamp ? std::to_string(toSeconds(*stamp - start)) + " s" : std::string("never");
  };
  std::string text = "obstacle appeared: " + since(truth.appeared) +
                     ", first beam on it: " + since(truth.first_beam);
  if (truth.obstacle_min_m) {
    text += ", nearest to the hand: " + std::to_string(*truth.obstacle_min_m) + " m";
  }
  return text;
}

void run(const Options& options) {
  rosbag::Bag bag(options.bag, rosbag::bagmode::Write);
  bag.setCompression(options.compression);
  Simulator simulator(options.simulator);
  const Time end = options.simulator.start + fromSeconds(options.duration_s);
  const Time stop_at = options.stop_at_s < kNever
                           ? options.simulator.start + fromSeconds(options.stop_at_s)
                           : Time::max();
  const tf2_msgs::TFMessage mounts = mountMessage(options.simulator);
  if (!mounts.transforms.empty()) bag.write("/tf_static", toRos(options.simulator.start), mounts);
  Counts counts;
  while (simulator.now() < end) {
    simulator.setStop(simulator.now() >= stop_at);
    const StepOutput output = simulator.step();
    record(output, simulator, options, bag, counts);
  }
  bag.close();
  if (!options.truth.empty()) {
    std::ofstream file(options.truth);
    file << toJson(simulator.truth()).dump(1) << '\n';
    if (!file) throw std::runtime_error("cannot write " + options.truth);
  }
  std::printf("%s: %s in %.1f s; %s\n", options.bag.c_str(), describe(counts).c_str(),
              options.duration_s, describe(simulator.truth(), options.simulator.start).c_str());
}

}  // namespace
}  // namespace tccm::simulation

int main(int argc, char** argv) {
  using namespace tccm::simulation;
  CLI::App app(
      "Records a bag of a simulated dual-arm robot with a tilting laser, a depth camera, a lidar.");
  Options options;
  declare(app, options);
  try {
    app.parse(argc, argv);
    options.simulator.obstacle = obstacleKind(options.obstacle);
    options.simulator.purpose = obstaclePurpose(options.obstacle_for);
    options.simulator.sensors = sensorKinds(options.sensors);
    options.simulator.clouds.camera_mount = cameraMount(options.camera);
    run(options);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "simulate: %s\n", error.what());
    return 2;
  }
  return 0;
}
