/// What a scan costs in this package's map, and in others that could stand in its place, on the
/// same streams: a flat array of counters, a hash table of voxels, OctoMap, and the paper's lists.
/// Beside the map alone all that the mapper does with a scan: looks, hold and the snapshot too.
/// Prints JSON: for each stream, size of cells and window, each map's time for a scan [us].

#include <algorithm>
#include <array>
#include <cstdio>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "latencies.h"
#include "map/integration_map.h"
#include "map/mapper.h"
#include "peers.h"
#include "peers_main.h"
#include "scan/cloud_looks.h"
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

/// All that the mapper does with a scan, until its map can be published.
class OurMapper {
 public:
  OurMapper(const IntegrationMap::Config& map, std::size_t window, const Stream& stream)
      : mapper_(configOf(map, window)), period_(fromSeconds(stream.period_s)) {
    for (const Points& points : stream.scans) scans_.push_back(scanOf(stream, points));
    for (std::size_t i = 0; i < stream.tilts.size(); ++i) scans_[i].tilt = stream.tilts[i];
    mapper_.reserve(snapshot_);
  }
  /// @param i of the stream's scans.
  void add(std::size_t i) {
    ScanReturns& scan = scans_[i];
    now_ += period_;
    scan.stamp = now_;
    if (!mapper_.add(scan).dropped.empty()) throw std::runtime_error("the mapper drops a scan");
    mapper_.snapshot(snapshot_);
  }

 private:
  static Mapper::Config configOf(const IntegrationMap::Config& map, std::size_t window) {
    Mapper::Config config;
    config.map = map;
    config.window_scans = static_cast<int>(window);
    return config;
  }
  /// With a look for each beam, or of a cloud for each block of directions, as the assembler has
  /// it.
  static ScanReturns scanOf(const Stream& stream, const Points& points) {
    ScanReturns scan;
    scan.viewpoint = stream.viewpoint;
    scan.is_whole = stream.tilts.empty();
    scan.points = points;
    const DirectionGrid blocks(CloudLooks::Config().block_rad);
    std::vector<bool> looked(blocks.pixels(), false);
    for (const Vector3& p : points) {
      const std::size_t block = blocks.pixelOf(p - stream.viewpoint);
      if (scan.is_whole && looked[block]) continue;
      looked[block] = true;
      scan.looks.push_back({stream.viewpoint, p, Seen::kSurface});
    }
    return scan;
  }

  Mapper mapper_;
  Duration period_;
  Time now_;
  std::vector<ScanReturns> scans_;
  CuboidMap snapshot_;
};

/// One of those that are compared; it is handed a stream's scans by their index.
class Contestant {
 public:
  Contestant(std::string name, std::function<void(std::size_t)> take)
      : name_(std::move(name)), take_(std::move(take)) {}

  void take(std::size_t i) { take_(i); }
  void timeTake(std::size_t i) {
    latencies_.time([&] { take_(i); });
  }
  [[nodiscard]] Json result() {
    return {{"name", name_},
            {"p50_us", latencies_.percentileUs(0.5)},
            {"p99_us", latencies_.percentileUs(0.99)}};
  }

 private:
  std::string name_;
  std::function<void(std::size_t)> take_;
  Latencies latencies_;
};

/// A map over a window.
template <typename Map>
Contestant overWindow(const std::string& name, const std::shared_ptr<Map>& map,
                      const Stream& stream, std::size_t window) {
  return {name, [map, &stream, window](std::size_t i) {
            map->add(stream.scans[i]);
            while (map->scans() > window) map->expireOldest();
          }};
}

double returnsInside(const Stream& stream, const Grid& grid) {
  std::size_t inside = 0;
  for (const Points& points : stream.scans) {
    for (const Vector3& p : points) inside += grid.place(p) ? 1 : 0;
  }
  return static_cast<double>(inside) / static_cast<double>(stream.scans.size());
}

std::vector<Contestant> contestantsFor(const Stream& stream, const Setting& setting,
                                       const IntegrationMap::Config& config,
                                       const std::shared_ptr<Ours>& ours, bool with_slow) {
  const Grid grid(config.grid);
  const std::size_t window = setting.window;
  std::vector<Contestant> contestants;
  const auto add = [&](const std::string& name, const auto& map) {
    contestants.push_back(overWindow(name, map, stream, window));
  };
  add("this package", ours);
  const auto mapper = std::make_shared<OurMapper>(config, window, stream);
  contestants.emplace_back("its looks, hold, snapshot too",
                           [mapper](std::size_t i) { mapper->add(i); });
  add("transform and cells alone", std::make_shared<peers::CellsAlone>(grid));
  add("flat counters", std::make_shared<peers::FlatCounters>(grid, config.thickness_m));
  add("hash table of voxels", std::make_shared<peers::VoxelTable>(grid, config.thickness_m));
  if (!with_slow) return contestants;
  for (const bool rays : {false, true}) {
    add(rays ? "OctoMap" : "OctoMap, hits alone",
        std::make_shared<peers::OctoMap>(grid, setting.cell_m, rays, stream.viewpoint));
  }
  if (!stream.tilts.empty()) add("the paper's lists", std::make_shared<peers::PaperLists>(grid));
  return contestants;
}

/// "a laser, 20 mm, window 40, 145 returns a scan"
std::string textOf(const Stream& stream, const Setting& setting, const Grid& grid) {
  std::array<char, 64> numbers{};
  std::snprintf(numbers.data(), numbers.size(), ", %.0f mm, window %zu, %.0f returns a scan",
                1e3 * setting.cell_m, setting.window, returnsInside(stream, grid));
  return stream.name + numbers.data();
}

/// @param rounds in which each map takes all scans of the stream, in turn.
Json compare(const Stream& stream, const Setting& setting, std::size_t rounds, bool with_slow) {
  IntegrationMap::Config config;
  config.grid.cell_size_m = setting.cell_m;
  config.scans_max = std::max<std::size_t>(setting.window, 512);
  const auto ours = std::make_shared<Ours>(config);
  auto contestants = contestantsFor(stream, setting, config, ours, with_slow);
  const std::size_t period = stream.scans.size();
  for (Contestant& contestant : contestants) {
    for (std::size_t i = 0; i < setting.window + period; ++i) contestant.take(i % period);
  }
  for (std::size_t round = 0; round < rounds; ++round) {
    for (Contestant& contestant : contestants) {
      for (std::size_t i = 0; i < period; ++i) contestant.timeTake(i);
    }
  }
  Json rows = Json::array();
  for (Contestant& contestant : contestants) rows.push_back(contestant.result());
  return {{"what", textOf(stream, setting, Grid(config.grid))},
          {"unit", "flat counters"},
          {"rows", rows},
          {"cuboids", ours->cuboids()},
          {"memory_bytes", ours->memoryBytes()}};
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

int main(int argc, char** argv) { return tccm::peers::main(argc, argv, "map_peers", tccm::run); }
