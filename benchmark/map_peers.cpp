/// What a scan costs in this package's map, and in others that could stand in its place, on the
/// same streams: a flat array of counters, a hash table of voxels, OctoMap, and the paper's lists.
/// Prints JSON: for each stream, size of cells and window, each map's time for a scan [us].

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "latencies.h"
#include "map/integration_map.h"
#include "peers.h"
#include "streams.h"

namespace tccm {
namespace {

using Json = nlohmann::ordered_json;
using streams::Points;
using streams::Stream;

struct Setting {
  double cell_m = 0.02;
  std::size_t window = 40;
};

class Ours {
 public:
  explicit Ours(const IntegrationMap::Config& config) : map_(config) {}
  void add(const Points& points) {
    static_cast<void>(map_.add(Time(Duration(map_.serial())), points));
  }
  void expireOldest() { map_.expireOldest(); }
  [[nodiscard]] std::size_t scans() const { return map_.scans(); }
  [[nodiscard]] std::size_t memoryBytes() const { return map_.memoryBytes(); }
  [[nodiscard]] std::size_t cuboids() {
    CuboidMap snapshot;
    map_.snapshot(snapshot);
    return snapshot.cuboids.size();
  }

 private:
  IntegrationMap map_;
};

/// One of the maps that are compared, over a window.
class Contestant {
 public:
  template <typename Map>
  Contestant(std::string name, std::shared_ptr<Map> map, std::size_t window)
      : name_(std::move(name)), step_([map, window](const Points& points) {
          map->add(points);
          while (map->scans() > window) map->expireOldest();
        }) {}

  void step(const Points& points) { step_(points); }
  void timeStep(const Points& points) {
    latencies_.time([&] { step_(points); });
  }
  [[nodiscard]] Json result() {
    return {{"map", name_},
            {"p50_us", latencies_.percentileUs(0.5)},
            {"p99_us", latencies_.percentileUs(0.99)}};
  }

 private:
  std::string name_;
  std::function<void(const Points&)> step_;
  Latencies latencies_;
};

double returnsInside(const Stream& stream, const Grid& grid) {
  std::size_t inside = 0;
  for (const Points& points : stream.scans) {
    for (const Vector3& p : points) inside += grid.place(p) ? 1 : 0;
  }
  return static_cast<double>(inside) / static_cast<double>(stream.scans.size());
}

/// @param rounds in which each map takes all scans of the stream, in turn.
Json compare(const Stream& stream, const Setting& setting, std::size_t rounds, bool with_slow) {
  IntegrationMap::Config config;
  config.grid.cell_size_m = setting.cell_m;
  config.scans_max = std::max<std::size_t>(setting.window, 512);
  const Grid grid(config.grid);
  const auto ours = std::make_shared<Ours>(config);
  const std::size_t window = setting.window;
  std::vector<Contestant> contestants;
  contestants.emplace_back("this package", ours, window);
  contestants.emplace_back("flat counters",
                           std::make_shared<peers::FlatCounters>(grid, config.thickness_m), window);
  contestants.emplace_back("hash table of voxels",
                           std::make_shared<peers::VoxelTable>(grid, config.thickness_m), window);
  if (with_slow) {
    for (const bool rays : {false, true}) {
      contestants.emplace_back(
          rays ? "OctoMap" : "OctoMap, hits alone",
          std::make_shared<peers::OctoMap>(grid, setting.cell_m, rays, stream.viewpoint), window);
    }
    if (stream.scans.front().size() < 1000) {
      contestants.emplace_back("the paper's lists", std::make_shared<peers::PaperLists>(grid),
                               window);
    }
  }
  const std::size_t period = stream.scans.size();
  for (Contestant& contestant : contestants) {
    for (std::size_t i = 0; i < window + period; ++i) contestant.step(stream.scans[i % period]);
  }
  for (std::size_t round = 0; round < rounds; ++round) {
    for (Contestant& contestant : contestants) {
      for (const Points& points : stream.scans) contestant.timeStep(points);
    }
  }
  Json maps = Json::array();
  for (Contestant& contestant : contestants) maps.push_back(contestant.result());
  return {{"stream", stream.name},
          {"cell_mm", 1e3 * setting.cell_m},
          {"window", window},
          {"returns", returnsInside(stream, grid)},
          {"cuboids", ours->cuboids()},
          {"memory_bytes", ours->memoryBytes()},
          {"maps", maps}};
}

void run(bool quick) {
  const std::size_t rounds = quick ? 4 : 20;
  Json all = Json::array();
  const auto add = [&](const Stream& stream, const Setting& setting, std::size_t times,
                       bool with_slow) {
    all.push_back(compare(stream, setting, times, with_slow));
    std::fprintf(stderr, "\r%zu of 11 comparisons", all.size());
  };
  const Stream sparse = streams::tilting("tilting laser, a fan of 240 degrees", 240.0);
  const Stream dense = streams::tilting("tilting laser, a fan of 70 degrees", 70.0);
  add(sparse, {0.02, 40}, rounds, true);
  add(dense, {0.02, 40}, rounds, true);
  for (const std::size_t window : {5, 200}) add(dense, {0.02, window}, rounds, false);
  for (const double cell_m : {0.005, 0.01}) {
    add(sparse, {cell_m, 40}, rounds, true);
    add(dense, {cell_m, 40}, rounds, true);
  }
  const Stream lidar = streams::lidar();
  add(lidar, {0.02, 5}, 4 * rounds, !quick);
  const Stream camera = streams::camera();
  add(camera, {0.02, 9}, rounds, !quick);
  add(camera, {0.01, 9}, rounds, false);
  std::fprintf(stderr, "\n");
  std::printf("%s\n", all.dump(1).c_str());
}

}  // namespace
}  // namespace tccm

int main(int argc, char** argv) {
  const bool quick = argc == 2 && std::strcmp(argv[1], "--quick") == 0;
  if (argc > 2 || (argc == 2 && !quick)) {
    std::fprintf(stderr, "usage: map_peers [--quick]\n");
    return 2;
  }
  try {
    tccm::run(quick);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "map_peers: %s\n", error.what());
    return 1;
  }
}
