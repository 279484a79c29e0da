/// How long a cloud takes on its way to the map: the dual-arm robot's 26 primitives in view of a
/// depth camera of 640 x 480 pixels and of a lidar of 64 x 1024.

#include <benchmark/benchmark.h>

#include <string>

#include "latencies.h"
#include "map/mapper.h"
#include "support/depth_view.h"

namespace tccm {
namespace {

/// Nanoseconds a point, of all points of the cloud.
void reportPoints(benchmark::State& state, const Cloud& cloud) {
  state.counters["p50_ns_a_point"] =
      1e3 * state.counters["p50_us"] / static_cast<double>(cloud.points.size());
}

CloudStage::Config configFor(const std::string& sensor) {
  CloudStage::Config config;
  if (sensor == "lidar") config.noise = {0.01, 0.0};
  if (sensor == "lidar") config.looks.block_rad = 0.035;
  return config;
}

void assembleCloud(benchmark::State& state, const std::string& sensor, bool self_filter) {
  const test::DepthView view;
  const Cloud cloud = sensor == "lidar" ? view.lidar(1).cloud : view.camera(1).cloud;
  CloudStage::Config config = configFor(sensor);
  config.self_filter = self_filter;
  CloudStage stage(config, view.model());
  view.tellJoints(stage);
  const PosePath T_fixed_sensor = view.sensorPath();
  const auto T_fixed_roots = view.rootPaths();
  Latencies latencies;
  for (auto _ : state) {
    latencies.time(
        [&] { benchmark::DoNotOptimize(stage.assemble(cloud, T_fixed_sensor, T_fixed_roots)); });
  }
  latencies.report(state);
  reportPoints(state, cloud);
  state.counters["kept"] = static_cast<double>(stage.returns().points.size());
  state.counters["looks"] = static_cast<double>(stage.returns().looks.size());
}
BENCHMARK_CAPTURE(assembleCloud, camera, "camera", true)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(assembleCloud, camera_without_robot, "camera", false)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(assembleCloud, lidar, "lidar", true)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(assembleCloud, lidar_without_robot, "lidar", false)
    ->Unit(benchmark::kMicrosecond);

/// As scans are filtered: each point against each shape.
void filterEachPoint(benchmark::State& state) {
  const test::DepthView view;
  const Cloud cloud = view.camera(1).cloud;
  CloudStage stage({}, view.model());
  view.tellJoints(stage);
  if (!stage.assemble(cloud, view.sensorPath(), view.rootPaths()).empty()) return;
  AssembledScan scan;
  for (const Eigen::Vector3f& p : cloud.points) {
    Beam beam;
    beam.stamp = cloud.stamp;
    beam.viewpoint = view.sensorPose().translation();
    beam.p_fixed = view.sensorPose() * p.cast<double>();
    beam.kind = isMeasured(p) ? BeamKind::kReturn : BeamKind::kUnknown;
    scan.beams.push_back(beam);
  }
  Latencies latencies;
  for (auto _ : state) {
    AssembledScan copy = scan;
    latencies.time([&] { BodyFilter().apply(stage.body()->samples(), copy); });
  }
  latencies.report(state);
  reportPoints(state, cloud);
}
BENCHMARK(filterEachPoint)->Unit(benchmark::kMicrosecond);

void mapCloud(benchmark::State& state, const std::string& sensor) {
  const test::DepthView view;
  const Cloud cloud = sensor == "lidar" ? view.lidar(1).cloud : view.camera(1).cloud;
  CloudStage stage(configFor(sensor), view.model());
  view.tellJoints(stage);
  if (!stage.assemble(cloud, view.sensorPath(), view.rootPaths()).empty()) return;
  Mapper::Config config;
  config.window_s = 0.3;
  config.looks.pass_gap_s = 0.001;
  Mapper mapper(config);
  ScanReturns returns = stage.returns();
  Latencies latencies;
  for (auto _ : state) {
    returns.stamp += std::chrono::milliseconds(33);
    latencies.time([&] { benchmark::DoNotOptimize(mapper.add(returns)); });
  }
  latencies.report(state);
  reportPoints(state, cloud);
}
BENCHMARK_CAPTURE(mapCloud, camera, "camera")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(mapCloud, lidar, "lidar")->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace tccm
