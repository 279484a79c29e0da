/// The map at the paper's setting (Figs. 8 and 9): 20 mm cells, 1.5 x 2.0 m, about 600 returns a
/// scan of a tilting laser over a table with objects, windows of 5 to 200 part maps. Beside the
/// mean that the library prints, p50 and p99 of single steps [us].

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <random>

#include "map/integration_map.h"
#include "map/place_ages.h"
#include "sight/look_map.h"
#include "streams.h"
#include "support/literal_map.h"
#include "support/part_union.h"

namespace tccm {
namespace {

using Points = std::vector<Vector3>;

constexpr std::size_t kPaperWindow = 40;
const Vector3 kSensor(0.0, 0.0, 1.515);
constexpr int kScansInPeriod = 56;  // of 28 ms in a tilt of 1.575 s

/// A period of scans: the sensor 1.515 m high looks 45 degrees down, +-30, with 1 cm of noise. Its
/// 600 beams lie within +-35 degrees, so that they fall into the area
/// until they pass over the panel.
std::vector<Points> period(const Grid& grid) {
  const std::vector<streams::Thing> things = streams::scene();
  std::mt19937 engine(2);
  std::normal_distribution<double> noise(0.0, 0.01);
  std::vector<Points> scans(kScansInPeriod);
  for (std::size_t k = 0; k < scans.size(); ++k) {
    const double phase = 2.0 * M_PI * static_cast<double>(k) / kScansInPeriod;
    const double tilt = M_PI / 180.0 * (45.0 + 30.0 * std::sin(phase));
    const Eigen::AngleAxisd down(tilt, Vector3::UnitY());
    for (int i = 0; i < 600; ++i) {
      const double angle = M_PI / 180.0 * (-35.0 + 70.0 / 599.0 * i);
      const Ray ray{kSensor, down * Vector3(std::cos(angle), std::sin(angle), 0.0)};
      const Vector3 p = ray.at(streams::rangeTo(things, ray) + noise(engine));
      if (grid.cellOf(p)) scans[k].push_back(p);
    }
  }
  return scans;
}

double microseconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double, std::micro>(duration).count();
}

void report(std::vector<double>& times, benchmark::State& state) {
  std::sort(times.begin(), times.end());
  state.counters["p50_us"] = times[times.size() / 2];
  state.counters["p99_us"] = times[times.size() * 99 / 100];
}

/// Times each step by itself and reports the distribution.
template <typename Step>
void measure(benchmark::State& state, Step&& step) {
  std::vector<double> times;
  times.reserve(1U << 20U);
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    step();
    times.push_back(microseconds(std::chrono::steady_clock::now() - start));
  }
  report(times, state);
}

/// The period of scans again and again through one map.
class Loop {
 public:
  explicit Loop(std::size_t window) : window_(window), scans_(period(map_.grid())) {
    map_.reserve(snapshot_);
    for (std::size_t i = 0; i < window + kScansInPeriod; ++i) step();
  }
  void step() {
    map_.add(Time(Duration(map_.serial())), scans_[map_.serial() % scans_.size()]);
    while (map_.scans() > window_) map_.expireOldest();
  }
  const CuboidMap& snapshot() {
    map_.snapshot(snapshot_);
    return snapshot_;
  }
  [[nodiscard]] CuboidMap& lastSnapshot() { return snapshot_; }
  [[nodiscard]] IntegrationMap& map() { return map_; }
  [[nodiscard]] double returnsInScan() const {
    std::size_t returns = 0;
    for (const Points& points : scans_) returns += points.size();
    return static_cast<double>(returns) / static_cast<double>(scans_.size());
  }

 private:
  IntegrationMap map_{IntegrationMap::Config()};
  std::size_t window_;
  std::vector<Points> scans_;
  CuboidMap snapshot_;
};

void updateByOwnership(benchmark::State& state) {
  Loop loop(static_cast<std::size_t>(state.range(0)));
  measure(state, [&] { loop.step(); });
  state.counters["returns"] = loop.returnsInScan();
  state.counters["cuboids"] = static_cast<double>(loop.snapshot().cuboids.size());
}

void snapshot(benchmark::State& state) {
  Loop loop(static_cast<std::size_t>(state.range(0)));
  measure(state, [&] { benchmark::DoNotOptimize(loop.snapshot().cuboids.data()); });
  state.counters["cuboids"] = static_cast<double>(loop.snapshot().cuboids.size());
}

/// The map with what else the mapper keeps of the same scans.
class LookingLoop {
 public:
  explicit LookingLoop(std::size_t window) : loop_(window) {
    // Until all that stands there is known.
    for (std::size_t i = 0; i < std::size_t{10} * kScansInPeriod; ++i) step();
  }
  void step() {
    see();
    follow();
  }
  /// All but the ages.
  void see() {
    loop_.step();
    looking_.clear();
    loop_.map().visitNewest([this](const MappedReturn& entry) {
      const Grid& grid = loop_.map().grid();
      const Eigen::Vector2d centre = grid.centre(entry.cell);
      looking_.push_back({kSensor, {centre.x(), centre.y(), grid.metres(entry.height)}});
    });
    looks_.add(now_, looking_);
    now_ += std::chrono::milliseconds(28);
  }
  void follow() { ages_.follow(loop_.map(), looks_.image()); }
  void apply() { ages_.apply(loop_.map(), loop_.lastSnapshot()); }
  const CuboidMap& snapshot() { return loop_.snapshot(); }

 private:
  Loop loop_;
  LookMap looks_{LookMap::Config()};
  PlaceAges ages_{loop_.map()};
  std::vector<Look> looking_;
  Time now_;
};

void followPlaceAges(benchmark::State& state) {
  LookingLoop loop(static_cast<std::size_t>(state.range(0)));
  std::vector<double> times;
  times.reserve(1U << 20U);
  for (auto _ : state) {
    state.PauseTiming();
    loop.see();
    state.ResumeTiming();
    const auto start = std::chrono::steady_clock::now();
    loop.follow();
    times.push_back(microseconds(std::chrono::steady_clock::now() - start));
  }
  report(times, state);
}

void applyPlaceAges(benchmark::State& state) {
  LookingLoop loop(static_cast<std::size_t>(state.range(0)));
  std::vector<double> times;
  times.reserve(1U << 20U);
  for (auto _ : state) {
    state.PauseTiming();
    loop.step();
    loop.snapshot();
    state.ResumeTiming();
    const auto start = std::chrono::steady_clock::now();
    loop.apply();
    times.push_back(microseconds(std::chrono::steady_clock::now() - start));
  }
  report(times, state);
  state.counters["cuboids"] = static_cast<double>(loop.snapshot().cuboids.size());
}

std::vector<std::vector<MappedReturn>> mappedPeriod(const Grid& grid) {
  std::vector<std::vector<MappedReturn>> returns;
  for (const Points& points : period(grid)) returns.push_back(test::mappedReturns(grid, points));
  return returns;
}

/// Section III.C.2 with lists, as the paper has it; finding cells and heights is not counted.
void updateByLiteralReplacement(benchmark::State& state) {
  const Grid grid;
  const auto scans = mappedPeriod(grid);
  test::LiteralMap map(grid.cells(), 20);
  const auto window = static_cast<std::size_t>(state.range(0));
  std::size_t next = 0;
  const auto step = [&] {
    map.add(scans[next % scans.size()]);
    if (++next > window) map.expireOldest();
  };
  while (next < window + kScansInPeriod) step();
  measure(state, step);
}

/// Section III.C.1: all part maps added anew.
void updateByAddingAllPartMaps(benchmark::State& state) {
  const Grid grid;
  const auto scans = mappedPeriod(grid);
  std::deque<test::LiteralPartMap> part_maps;
  std::uint32_t next = 0;
  const auto step = [&] {
    part_maps.push_back(test::literalPartMap(scans[next % scans.size()], 20, next));
    ++next;
    if (part_maps.size() > static_cast<std::size_t>(state.range(0))) part_maps.pop_front();
    benchmark::DoNotOptimize(test::additionOfAll(part_maps, grid.cells()));
  };
  while (part_maps.size() < static_cast<std::size_t>(state.range(0))) step();
  measure(state, step);
}

void windows(benchmark::internal::Benchmark* benchmark) {
  benchmark->Unit(benchmark::kMicrosecond)->ArgName("window");
  for (const int window : {5, 10, 20, static_cast<int>(kPaperWindow), 80, 200}) {
    benchmark->Arg(window);
  }
}

BENCHMARK(updateByOwnership)->Apply(windows);
BENCHMARK(snapshot)->Apply(windows);
BENCHMARK(followPlaceAges)->Apply(windows);
BENCHMARK(applyPlaceAges)->Apply(windows);
BENCHMARK(updateByLiteralReplacement)->Apply(windows);
BENCHMARK(updateByAddingAllPartMaps)->Apply(windows);

}  // namespace
}  // namespace tccm

BENCHMARK_MAIN();
