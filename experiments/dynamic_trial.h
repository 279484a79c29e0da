#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "simulation/monitored_simulation.h"

namespace tccm::simulation {

/// What moves over the table while the laser nods before it, and how.
struct DynamicScene {
  std::string name;         ///< "paper" or "box"
  SceneObject mover;        ///< with its shuttle
  double height_m = 0.0;    ///< of its lower side over the table
  double speed_mps = 0.0;   ///< while it moves
  double starts_s = 0.0;    ///< to move, after the start of the trial; the paper appears then
  double period_s = 1.575;  ///< of the tilt
  double phase_rad = 0.0;   ///< of the tilt at the start of the trial
};

/// "paper": an A4 sheet, as in the paper's Fig. 7, appears over the table and is moved to and fro;
/// "box": a box that stood on the table is slid to and fro. @throws ConfigError for another name.
/// The same for the same seed.
[[nodiscard]] DynamicScene dynamicScene(const std::string& name, std::uint64_t seed);

/// What a cuboid of the map comes from, by the returns of the window that it holds. Mixed pixels,
/// which lie on no surface, are evidence for neither.
enum class CuboidSource : std::uint8_t {
  kStanding,  ///< all from what stands
  kMoving,    ///< most from what moves
  kBoth,      ///< from what stands, and no more from what moves
  kMixed,     ///< mixed pixels alone
};
struct ReturnSources {
  std::size_t standing = 0, moving = 0, mixed = 0;
};
[[nodiscard]] CuboidSource sourceOf(const ReturnSources& returns);

/// Cuboids, by what they come from and what the map takes them for, over many maps.
struct DynamicTally {
  std::size_t standing = 0;
  std::size_t standing_static = 0;  ///< of these called static
  std::size_t moving = 0;
  std::size_t moving_static = 0;  ///< of these called static: wrongly
  std::size_t both = 0;           ///< not judged
  std::size_t both_static = 0;

  void add(CuboidSource source, bool called_static);
  void add(const DynamicTally& other);
  /// Of what stands, the share that is called static; 1 where nothing stands.
  [[nodiscard]] double staticRecall() const;
  /// Of what is called static and was judged, the share that stands.
  [[nodiscard]] double staticPrecision() const;
  /// Of what moves, the share that is called static; 0 where nothing moves.
  [[nodiscard]] double movingStatic() const;
};

/// Something moves over a table, the robot's arms are at rest: which cuboids become dynamic?
class DynamicTrial {
 public:
  struct Config {
    Monitor::Config monitor;
    Scanner::Config scanner;
    int static_windows = 3;     ///< from this dyn on a cuboid is called static
    double settle_s = 15.0;     ///< from when it begins to move to the first map judged
    double judge_s = 6.0;       ///< from then on so long
    std::size_t every = 7;      ///< scans between maps that are judged
    bool keep_cuboids = false;  ///< of the last map judged

    /// @throws ConfigError
    void validate() const;
  };
  struct JudgedCuboid {
    double x_m = 0.0, y_m = 0.0;  ///< of its cell's centre
    double bottom_m = 0.0, top_m = 0.0;
    CuboidSource source = CuboidSource::kMixed;
    bool called_static = false;
  };
  struct Result {
    std::uint64_t seed = 0;
    std::string scene;                                       ///< its name
    double period_s = 0.0, height_m = 0.0, speed_mps = 0.0;  ///< of the scene
    DynamicTally tally;
    double phase = 0.0;  ///< of the tilt, 0 to 1, when the thing began to move
    std::size_t maps = 0;
    double simulated_s = 0.0;
    std::vector<JudgedCuboid> cuboids;  ///< where they are kept
  };

  /// @param model what the monitor takes the robot for. @throws ConfigError
  DynamicTrial(const Config& config, const std::string& scene,
               std::shared_ptr<const RobotModel> model, std::uint64_t seed);

  /// The same for the same seed.
  [[nodiscard]] Result run();

 private:
  struct Entry {
    CellIndex cell;
    Height height;
    bool moving, mixed;
  };
  void addScan(const SimulatedScan& scan);
  [[nodiscard]] std::vector<ReturnSources> sources(const CuboidMap& map) const;
  void judge();

  Config config_;
  DynamicScene scene_;
  Result result_;
  Simulator::Config setting_;
  MonitoredSimulation simulation_;
  std::deque<std::vector<Entry>> window_;  ///< the returns of the map's scans
  std::size_t scans_ = 0;
};

}  // namespace tccm::simulation
