/// What a cloud costs on its way from the message to the map that is published, stage by stage: the
/// dual-arm robot's 26 primitives in view of a depth camera of 640 x 480 pixels and of a lidar of
/// 64 x 1024. Beside it OctoMap, which is handed the points that our map takes. Prints a table.

#include <octomap/OcTree.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "cloud_message.h"
#include "latencies.h"
#include "map/mapper.h"
#include "map/place_ages.h"
#include "ros/cloud_reader.h"
#include "ros/cloud_scan.h"
#include "ros/conversions.h"
#include "support/depth_view.h"

namespace tccm {
namespace {

struct Sensor {
  const char* name;
  bool is_lidar;
  Duration period;
  [[nodiscard]] test::DepthView::Seen see(const test::DepthView& view) const {
    return is_lidar ? view.lidar(1) : view.camera(1);
  }
};

CloudStage::Config stageConfig(const Sensor& sensor) {
  CloudStage::Config config;
  if (sensor.is_lidar) config.noise = {0.01, 0.0};
  if (sensor.is_lidar) config.looks.block_rad = 0.035;
  return config;
}

Mapper::Config mapperConfig(const Sensor& sensor) {
  Mapper::Config config;
  config.window_s = sensor.is_lidar ? 0.5 : 0.3;
  return config;
}

/// All that a cloud goes through, as the nodelets do it.
class Way {
 public:
  explicit Way(const Sensor& sensor)
      : sensor_(sensor),
        message_(messageOf(sensor.see(view_).cloud)),
        stage_(stageConfig(sensor), view_.model()),
        mapper_(mapperConfig(sensor)),
        ages_(mapper_.map()),
        T_fixed_sensor_(view_.sensorPath()),
        T_fixed_roots_(view_.rootPaths()) {
    view_.tellJoints(stage_);
    mapper_.reserve(snapshot_);
  }

  void unpack() { require(reader_.read(message_, cloud_)); }
  void assemble() { require(stage_.assemble(cloud_, T_fixed_sensor_, T_fixed_roots_)); }
  /// To the message between the nodelets and back.
  void handOn() {
    toMessage(stage_.returns(), "base", scan_);
    require(fromMessage(scan_, returns_));
    now_ += sensor_.period;
    returns_.stamp = now_;
  }
  void map() { require(mapper_.add(returns_).dropped); }
  void publish() {
    mapper_.snapshot(snapshot_);
    mapper_.apply(ages_, snapshot_);
    toMessage(snapshot_, "base", published_);
  }
  void follow() { ages_.follow(mapper_.map(), mapper_.looks()); }
  void all() {
    unpack();
    assemble();
    handOn();
    map();
    publish();
  }

  [[nodiscard]] std::size_t points() const { return cloud_.points.size(); }
  [[nodiscard]] const ScanReturns& returns() const { return returns_; }
  [[nodiscard]] const CuboidMap& snapshot() const { return snapshot_; }
  [[nodiscard]] Cloud& cloud() { return cloud_; }
  [[nodiscard]] CloudStage& stage() { return stage_; }
  [[nodiscard]] const test::DepthView& view() const { return view_; }

 private:
  static void require(const std::string& defect) {
    if (defect.empty()) return;
    std::fprintf(stderr, "%s\n", defect.c_str());
    std::exit(2);
  }

  Sensor sensor_;
  test::DepthView view_;
  sensor_msgs::PointCloud2 message_;
  CloudReader reader_{CloudLimits()};
  CloudStage stage_;
  Mapper mapper_;
  PlaceAges ages_;
  PosePath T_fixed_sensor_;
  std::vector<PosePath> T_fixed_roots_;
  Cloud cloud_;
  tccm_monitor::CloudScan scan_;
  ScanReturns returns_;
  Time now_ = Time(fromSeconds(10.0));
  CuboidMap snapshot_;
  tccm_monitor::CuboidMap published_;
};

struct Row {
  std::string what;
  Latencies latencies;
  std::size_t points = 0;
};

void print(Row& row) {
  const double points = static_cast<double>(row.points);
  std::printf("  %-62s %9.0f %9.1f %9.1f\n", row.what.c_str(), row.latencies.percentileUs(0.5),
              1e3 * row.latencies.percentileUs(0.5) / points,
              1e3 * row.latencies.percentileUs(0.99) / points);
}

void measureWay(const Sensor& sensor, int frames) {
  Way way(sensor);
  for (int i = 0; i < 20; ++i) {
    way.all();
    way.follow();
  }
  std::vector<std::pair<std::string, std::function<void()>>> stages = {
      {"unpack the PointCloud2", [&] { way.unpack(); }},
      {"to points and looks: limits, filters, self filter, transform", [&] { way.assemble(); }},
      {"to the message between the nodelets and back", [&] { way.handOn(); }},
      {"map, looks and hold", [&] { way.map(); }},
      {"snapshot, and its message", [&] { way.publish(); }}};
  std::vector<Row> rows;
  rows.reserve(stages.size());
  for (const auto& [what, stage] : stages) rows.push_back({what, {}, way.points()});
  Row all{"all of it", {}, way.points()};
  Row ages{"for `dyn` alone, once the map is out: ages of places", {}, way.points()};
  for (int i = 0; i < frames; ++i) {
    all.latencies.time([&] {
      for (std::size_t k = 0; k < stages.size(); ++k) rows[k].latencies.time(stages[k].second);
    });
    ages.latencies.time([&] { way.follow(); });
  }
  for (Row& row : rows) print(row);
  print(all);
  print(ages);
}

/// What others, and parts alone, take for the same points.
void measureBeside(const Sensor& sensor, int frames) {
  Way way(sensor);
  way.all();
  CloudStage::Config without = stageConfig(sensor);
  without.self_filter = false;
  CloudStage stage(without, nullptr);
  const PosePath path = way.view().sensorPath();
  Row bare{"to points and looks, without a robot", {}, way.points()};
  for (int i = 0; i < frames; ++i) {
    bare.latencies.time([&] { static_cast<void>(stage.assemble(way.cloud(), path, {})); });
  }
  print(bare);

  const Mapper::Config config = mapperConfig(sensor);
  const std::vector<Vector3>& all = way.returns().points;
  std::vector<Vector3> inside;
  const Grid grid(config.map.grid);
  for (const Vector3& p : all) {
    if (grid.place(p)) inside.push_back(p);
  }
  IntegrationMap map(config.map);
  Row map_alone{"the map alone: add a frame, take the oldest out", {}, way.points()};
  Row a_point{"the same, for each point in its area", {}, inside.size()};
  Time now(fromSeconds(10.0));
  for (int i = 0; i < frames + 20; ++i, now += sensor.period) {
    const auto step = [&] {
      map.add(now, all);
      while (now - map.oldestStamp() > fromSeconds(config.window_s)) map.expireOldest();
    };
    if (i < 20) {
      step();
    } else {
      map_alone.latencies.time([&] { a_point.latencies.time(step); });
    }
  }
  print(map_alone);
  print(a_point);

  octomap::Pointcloud cloud;
  for (const Vector3& p : inside)
    cloud.push_back(p.cast<float>().x(), p.cast<float>().y(), p.cast<float>().z());
  const Vector3& eye = way.returns().viewpoint;
  const octomap::point3d origin(static_cast<float>(eye.x()), static_cast<float>(eye.y()),
                                static_cast<float>(eye.z()));
  octomap::OcTree hits(config.map.grid.cell_size_m), rays(config.map.grid.cell_size_m);
  Row hits_row{"OctoMap, hits alone (updateNode), for each of these", {}, inside.size()};
  Row rays_row{"OctoMap, insertPointCloud with rays, for each of these", {}, inside.size()};
  for (int i = 0; i < 7; ++i) {
    hits_row.latencies.time([&] {
      for (const octomap::point3d& p : cloud) hits.updateNode(p, true, true);
      hits.updateInnerOccupancy();
    });
    rays_row.latencies.time([&] { rays.insertPointCloud(cloud, origin); });
  }
  print(hits_row);
  print(rays_row);
  std::printf(
      "  %zu points, %zu left after the filters, %zu of them in the area, %zu looks, %zu cuboids\n",
      way.points(), all.size(), inside.size(), way.returns().looks.size(),
      way.snapshot().cuboids.size());
}

void measure(const Sensor& sensor, int frames) {
  std::printf("%s\n  %-62s %9s %9s %9s\n", sensor.name, "", "us", "ns/point", "p99");
  measureWay(sensor, frames);
  measureBeside(sensor, frames);
}

}  // namespace
}  // namespace tccm

int main(int argc, char** argv) {
  const int frames = argc > 1 ? std::atoi(argv[1]) : 200;
  if (argc > 2 || frames < 1) {
    std::fprintf(stderr, "usage: cloud_benchmark [frames]\n");
    return 2;
  }
  tccm::measure({"depth camera, 640 x 480", false, std::chrono::milliseconds(33)}, frames);
  tccm::measure({"lidar, 64 x 1024", true, std::chrono::milliseconds(100)}, frames);
  return 0;
}
