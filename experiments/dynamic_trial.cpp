#include "experiments/dynamic_trial.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "experiments/draw.h"
#include "experiments/statistics.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

const Eigen::Vector3f kWhite(0.92F, 0.92F, 0.92F);
constexpr double kSheetThickness = 0.001;  // [m]

Pose turned(double x, double y, double z, double yaw) {
  Pose pose = at(x, y, z);
  pose.rotate(Eigen::AngleAxisd(yaw, Vector3::UnitZ()));
  return pose;
}

/// Moved from side to side between the laser and the table.
void addPaper(DynamicScene& scene, Time starts, Draw& draw) {
  scene.height_m = draw.between(0.05, 0.25);
  scene.speed_mps = draw.between(0.2, 0.5);
  const Vector3 half = 0.5 * Vector3(0.21, 0.297, kSheetThickness);
  const double z = kTableTop + scene.height_m + half.z();
  const double way = draw.between(0.35, 0.6);
  const double heading = draw.between(0.25, 0.75) * M_PI;  // from side to side, or askew
  const Vector3 offset = way * Vector3(std::cos(heading), std::sin(heading), 0.0);
  const Eigen::Vector2d middle(draw.between(0.58, 0.72), draw.between(-0.15, 0.15));
  const Pose place = turned(middle.x() - 0.5 * offset.x(), middle.y() - 0.5 * offset.y(), z,
                            draw.between(-M_PI, M_PI));
  scene.mover = {"paper", Box{half}, place, kWhite};
  scene.mover.entrance = Entrance{starts};
  scene.mover.shuttle = Shuttle{starts, offset, scene.speed_mps};
}

/// Slid over the part of the table that nothing stands on.
void addBox(DynamicScene& scene, Time starts, Draw& draw) {
  scene.speed_mps = draw.between(0.1, 0.3);
  const Vector3 half(draw.between(0.03, 0.06), draw.between(0.03, 0.06), draw.between(0.03, 0.1));
  const double way = draw.between(0.25, 0.32);
  const double heading = draw.between(0.4, 0.6) * M_PI;
  const Vector3 offset = way * Vector3(std::cos(heading), std::sin(heading), 0.0);
  const Pose place = turned(draw.between(0.56, 0.66), draw.between(-0.42, -0.36),
                            kTableTop + half.z(), draw.between(-M_PI, M_PI));
  scene.mover = {"box", Box{half}, place, kWhite};
  scene.mover.shuttle = Shuttle{starts, offset, scene.speed_mps};
}

Simulator::Config settingOf(const DynamicTrial::Config& config, const DynamicScene& scene,
                            std::uint64_t seed) {
  config.validate();
  Simulator::Config setting;
  setting.motion = kCommanded;
  setting.scanner = config.scanner;
  setting.head.tilt.period_s = scene.period_s;
  setting.head.tilt.phase_rad = scene.phase_rad;
  setting.seed = seed;
  setting.objects = {scene.mover};
  return setting;
}

}  // namespace

DynamicScene dynamicScene(const std::string& name, std::uint64_t seed) {
  Draw draw(seed);
  DynamicScene scene;
  scene.name = name;
  scene.period_s = draw.between(1.5, 1.65);
  scene.phase_rad = draw.between(0.0, 2.0 * M_PI);
  scene.starts_s = draw.between(9.0, 10.65);
  const Time starts = Simulator::Config().start + fromSeconds(scene.starts_s);
  if (name == "paper") {
    addPaper(scene, starts, draw);
  } else if (name == "box") {
    addBox(scene, starts, draw);
  } else {
    throw ConfigError("scene: " + name + " is none of paper, box");
  }
  return scene;
}

CuboidSource sourceOf(const ReturnSources& returns) {
  if (returns.standing + returns.moving == 0) return CuboidSource::kMixed;
  if (returns.moving == 0) return CuboidSource::kStanding;
  return returns.moving > returns.standing ? CuboidSource::kMoving : CuboidSource::kBoth;
}

void DynamicTally::add(CuboidSource source, bool called_static) {
  const std::size_t one = called_static ? 1 : 0;
  if (source == CuboidSource::kStanding) {
    ++standing;
    standing_static += one;
  } else if (source == CuboidSource::kMoving) {
    ++moving;
    moving_static += one;
  } else if (source == CuboidSource::kBoth) {
    ++both;
    both_static += one;
  }
}

void DynamicTally::add(const DynamicTally& other) {
  standing += other.standing;
  standing_static += other.standing_static;
  moving += other.moving;
  moving_static += other.moving_static;
  both += other.both;
  both_static += other.both_static;
}

double DynamicTally::staticRecall() const { return share(standing_static, standing, 1.0); }

double DynamicTally::staticPrecision() const {
  return share(standing_static, standing_static + moving_static, 1.0);
}

double DynamicTally::movingStatic() const { return share(moving_static, moving); }

void DynamicTrial::Config::validate() const {
  scanner.validate();
  requireInRange("static_windows", static_windows, 1, 1000);
  requireInRange("settle_s", settle_s, 0.0, 100.0);
  requireInRange("judge_s", judge_s, 0.0, 1000.0);
  requireInRange("every", static_cast<double>(every), 1.0, 1e6);
}

DynamicTrial::DynamicTrial(const Config& config, const std::string& scene,
                           std::shared_ptr<const RobotModel> model, std::uint64_t seed)
    : config_(config),
      scene_(dynamicScene(scene, seed)),
      setting_(settingOf(config, scene_, seed)),
      simulation_(setting_, config.monitor, std::move(model)) {
  result_.seed = seed;
  result_.scene = scene_.name;
  result_.period_s = scene_.period_s;
  result_.height_m = scene_.height_m;
  result_.speed_mps = scene_.speed_mps;
  simulation_.onScan([this](const SimulatedScan& scan) { addScan(scan); });
}

DynamicTrial::Result DynamicTrial::run() {
  const double length_s = scene_.starts_s + config_.settle_s + config_.judge_s;
  while (simulation_.simulator().now() < setting_.start + fromSeconds(length_s)) {
    simulation_.step();
  }
  const double turns = scene_.phase_rad / (2.0 * M_PI) + scene_.starts_s / scene_.period_s;
  result_.phase = turns - std::floor(turns);
  result_.simulated_s = length_s;
  return std::move(result_);
}

void DynamicTrial::addScan(const SimulatedScan& scan) {
  const Monitor& monitor = simulation_.monitor();
  const Grid& grid = monitor.map()->grid;
  // The scene's own objects stand before what is added to them.
  const std::size_t mover = Simulator::kFirstObject + simulation_.simulator().world().size() - 1;
  std::vector<Entry> entries;
  for (std::size_t i = 0; i < scan.truth.size(); ++i) {
    const Beam& beam = monitor.assembled().beams[i];
    if (beam.kind != BeamKind::kReturn) continue;
    const std::optional<Grid::Place> place = grid.place(beam.p_fixed);
    if (!place) continue;
    const BeamTruth& truth = scan.truth[i];
    entries.push_back({place->cell, place->height, truth.label == mover, truth.mixed});
  }
  window_.push_back(std::move(entries));
  while (window_.size() > monitor.map()->window_scans) window_.pop_front();
  const double first_s = scene_.starts_s + config_.settle_s;
  if (scan.scan.stamp < setting_.start + fromSeconds(first_s)) return;
  if (scans_++ % config_.every == 0) judge();
}

std::vector<ReturnSources> DynamicTrial::sources(const CuboidMap& map) const {
  std::vector<ReturnSources> sources(map.cuboids.size());
  for (const std::vector<Entry>& entries : window_) {
    for (const Entry& entry : entries) {
      for (std::uint32_t i = map.cell_begin[entry.cell]; i < map.cell_begin[entry.cell + 1]; ++i) {
        const Cuboid& cuboid = map.cuboids[i];
        if (cuboid.held || entry.height <= cuboid.bottom || entry.height > cuboid.top) continue;
        ++(entry.mixed ? sources[i].mixed : entry.moving ? sources[i].moving : sources[i].standing);
      }
    }
  }
  return sources;
}

void DynamicTrial::judge() {
  const CuboidMap& map = *simulation_.monitor().map();
  const std::vector<ReturnSources> returns = sources(map);
  ++result_.maps;
  result_.cuboids.clear();
  for (std::size_t i = 0; i < map.cuboids.size(); ++i) {
    const Cuboid& cuboid = map.cuboids[i];
    if (cuboid.held) continue;
    const CuboidSource source = sourceOf(returns[i]);
    const bool called_static = cuboid.dyn >= static_cast<std::uint32_t>(config_.static_windows);
    result_.tally.add(source, called_static);
    if (!config_.keep_cuboids) continue;
    const Eigen::Vector2d centre = map.grid.centre(cuboid.cell);
    result_.cuboids.push_back({centre.x(), centre.y(), map.grid.metres(cuboid.bottom),
                               map.grid.metres(cuboid.top), source, called_static});
  }
}

}  // namespace tccm::simulation
