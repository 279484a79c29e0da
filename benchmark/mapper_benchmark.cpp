/// The mapper on a tilting laser's stream, with arms that hide a part of the table and so give it
/// something to hold: a scan from its returns to the map that is published. p50 and p99 of single
/// steps [us].

#include <benchmark/benchmark.h>

#include <array>

#include "latencies.h"
#include "map/mapper.h"
#include "map/place_ages.h"
#include "tilting_stream.h"

namespace tccm {
namespace {

constexpr int kWindow = 40;
constexpr std::size_t kWarmUp =
    std::size_t{3} * TiltingStream::kPeriods * TiltingStream::kScansInPeriod;

const TiltingStream& stream() {
  static const TiltingStream made;
  return made;
}

Mapper::Config mapperConfig(double cell_size_m = 0.02) {
  Mapper::Config config;
  config.map.grid.cell_size_m = cell_size_m;
  config.window_scans = kWindow;
  return config;
}

/// The stream through a mapper, as the nodelets and the monitor do it.
class Way {
 public:
  explicit Way(const Mapper::Config& config) : mapper_(config), ages_(mapper_.map()) {
    for (CuboidMap& map : maps_) mapper_.reserve(map);
    while (next_ < kWarmUp) {
      take();
      add();
      snapshot();
      follow();
    }
  }
  void take() { stream().get(next_++, scan_); }
  void add() { benchmark::DoNotOptimize(mapper_.add(scan_)); }
  /// Into one of two in turn.
  void snapshot() { mapper_.snapshot(map()); }
  void apply() { mapper_.apply(ages_, map()); }
  void follow() { ages_.follow(mapper_.map(), mapper_.looks()); }

  CuboidMap& map() { return maps_[next_ % maps_.size()]; }
  [[nodiscard]] std::size_t memoryBytes() const {
    return mapper_.memoryBytes() + ages_.memoryBytes();
  }

 private:
  Mapper mapper_;
  PlaceAges ages_;
  std::array<CuboidMap, 2> maps_;
  ScanReturns scan_;
  std::size_t next_ = 0;
};

/// Each of a scan's steps by itself. @param state its first argument: edge of a cell [mm].
void followScan(benchmark::State& state) {
  Way way(mapperConfig(1e-3 * static_cast<double>(state.range(0))));
  Latencies add, snapshot, apply, follow;
  double cuboids = 0.0, held = 0.0, scans = 0.0;
  for (auto _ : state) {
    state.PauseTiming();
    way.take();
    state.ResumeTiming();
    add.time([&] { way.add(); });
    snapshot.time([&] { way.snapshot(); });
    apply.time([&] { way.apply(); });
    follow.time([&] { way.follow(); });
    state.PauseTiming();
    cuboids += static_cast<double>(way.map().cuboids.size());
    held += static_cast<double>(heldIn(way.map()));
    ++scans;
    state.ResumeTiming();
  }
  const auto tell = [&state](const std::string& what, Latencies& of) {
    state.counters[what + "_p50"] = of.percentileUs(0.5);
    state.counters[what + "_p99"] = of.percentileUs(0.99);
  };
  tell("add", add);
  tell("snapshot", snapshot);
  tell("apply_ages", apply);
  tell("follow_ages", follow);
  state.counters["cuboids"] = cuboids / scans;
  state.counters["held"] = held / scans;
  state.counters["memory"] = static_cast<double>(way.memoryBytes());
}

/// The map alone. @param state window; beams that fall into the area: 0 those that do, 1 all.
void updateMap(benchmark::State& state) {
  IntegrationMap map{IntegrationMap::Config()};
  std::vector<std::vector<Vector3>> scans;
  ScanReturns scan;
  double inside = 0.0;
  for (std::size_t i = 0; i < stream().scans(); ++i) {
    stream().get(i, scan);
    if (state.range(1) != 0) {
      for (Vector3& p : scan.points)
        p.head<2>() = Vector3(0.75 + 0.2 * p.x(), 0.3 * p.y(), 0.0).head<2>();
    }
    for (const Vector3& p : scan.points) inside += map.grid().place(p) ? 1.0 : 0.0;
    scans.push_back(scan.points);
  }
  const auto window = static_cast<std::size_t>(state.range(0));
  std::size_t next = 0;
  const auto step = [&] {
    map.add(Time(static_cast<int>(next) * TiltingStream::kScan), scans[next % scans.size()]);
    while (map.scans() > window) map.expireOldest();
    ++next;
  };
  while (next < window + scans.size()) step();
  Latencies latencies;
  for (auto _ : state) latencies.time(step);
  latencies.report(state);
  state.counters["returns"] = inside / static_cast<double>(scans.size());
}

/// Returns at so many places that none of the scans that follow sees.
void holdEverywhere(Mapper& mapper, std::size_t places, std::size_t& next) {
  const Grid& grid = mapper.map().grid();
  ScanReturns scan;
  std::size_t place = 0;
  for (int i = 0; i < 2 * kWindow; ++i) {
    scan.points.clear();
    for (std::size_t k = 0; i < kWindow && k < places / kWindow; ++k, ++place) {
      // Cells far from each other follow one another.
      const auto cell = static_cast<CellIndex>(place * 2503U % grid.cells());
      const Eigen::Vector2d centre = grid.centre(cell);
      const std::size_t layer = place / grid.cells();
      scan.points.emplace_back(centre.x(), centre.y(), 0.2 + 0.3 * static_cast<double>(layer));
    }
    scan.stamp = Time(fromSeconds(1.0)) + static_cast<int>(next++) * TiltingStream::kScan;
    mapper.add(scan);
  }
}

/// So many held places, of which the sensor sees nothing but the robot before them.
void addBeforeHeld(benchmark::State& state) {
  Mapper::Config config = mapperConfig();
  config.hold.longest_s = 600.0;
  Mapper mapper(config);
  std::size_t next = 0;
  ScanReturns scan;
  Latencies latencies;
  holdEverywhere(mapper, static_cast<std::size_t>(state.range(0)), next);
  const std::size_t end = next + 20000;
  for (auto _ : state) {
    state.PauseTiming();
    if (next > end) {
      mapper.clear();
      next = 0;
      holdEverywhere(mapper, static_cast<std::size_t>(state.range(0)), next);
    }
    stream().get(next++, scan);
    scan.points.clear();
    for (Look& look : scan.looks) {
      look.end = look.viewpoint + 0.1 * (look.end - look.viewpoint);
      look.what = Seen::kRobot;
    }
    state.ResumeTiming();
    latencies.time([&] { mapper.add(scan); });
  }
  latencies.report(state);
  state.counters["held"] = static_cast<double>(mapper.held());
}

/// So many held places, which the sensor sees again in the period of its tilt that is measured.
void seeHeldAgain(benchmark::State& state) {
  Mapper::Config config = mapperConfig();
  config.hold.longest_s = 600.0;
  Mapper mapper(config);
  std::size_t next = 0, seen = TiltingStream::kScansInPeriod;
  ScanReturns scan;
  Latencies latencies;
  for (auto _ : state) {
    state.PauseTiming();
    if (seen == TiltingStream::kScansInPeriod) {
      mapper.clear();
      next = seen = 0;
      holdEverywhere(mapper, static_cast<std::size_t>(state.range(0)), next);
    }
    stream().get(next++, scan);
    ++seen;
    state.ResumeTiming();
    latencies.time([&] { mapper.add(scan); });
  }
  latencies.report(state);
}

BENCHMARK(followScan)->Unit(benchmark::kMicrosecond)->ArgName("cell_mm")->Arg(20)->Arg(5);
BENCHMARK(updateMap)
    ->Unit(benchmark::kMicrosecond)
    ->ArgNames({"window", "all_inside"})
    ->Args({kWindow, 0})
    ->Args({kWindow, 1})
    ->Args({5, 0})
    ->Args({200, 0});
BENCHMARK(addBeforeHeld)->Unit(benchmark::kMicrosecond)->ArgName("held")->Arg(0)->Arg(15000);
BENCHMARK(seeHeldAgain)->Unit(benchmark::kMicrosecond)->ArgName("held")->Arg(15000);

}  // namespace
}  // namespace tccm

BENCHMARK_MAIN();
