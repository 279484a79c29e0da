#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "experiments/true_visibility.h"
#include "experiments/visibility_scene.h"
#include "simulation/monitored_simulation.h"

namespace tccm::simulation {

/// What of one link the monitor takes for visible, and what is.
struct LinkComparison {
  std::string link;
  double silhouette_pixels = 0.0;  ///< as the monitor draws it
  double in_range = 0.0;           ///< share of the true silhouette that the laser looks at
  double true_fraction = 1.0;
  double visible_fraction = 1.0;  ///< the monitor's, as the others
  double occluded_fraction = 0.0;
  double unseen_fraction = 0.0;

  [[nodiscard]] double error() const { return visible_fraction - true_fraction; }
};

/// The robot's arms in one random pose in a scene with an obstacle, the laser nodding before it:
/// how much of each link does the monitor take for visible?
class VisibilityTrial {
 public:
  /// Where the robot is while the map fills.
  enum class Robot {
    kInPose,  ///< asked about
    kAway,    ///< its arms hang
  };
  struct Config {
    Monitor::Config monitor;
    Robot robot = Robot::kInPose;
    double noise_m = 0.01;
    double clearance_m = 0.08;      ///< between robot and everything else
    double resolution_rad = 0.005;  ///< between the true rays

    /// @throws ConfigError
    void validate() const;
  };
  struct Result {
    std::uint64_t seed = 0;
    std::string scene, obstacle;
    std::vector<LinkComparison> links;
    double simulated_s = 0.0;
  };

  /// @param model what the monitor takes the robot for. @throws ConfigError
  VisibilityTrial(const Config& config, std::shared_ptr<const RobotModel> model,
                  std::uint64_t seed);

  /// The same for the same seed.
  [[nodiscard]] Result run();

 private:
  void waitForMap();
  [[nodiscard]] std::vector<TrueLinkVisibility> truth() const;

  Config config_;
  std::shared_ptr<const RobotModel> model_;
  VisibilityScene scene_;
  Result result_;
  MonitoredSimulation simulation_;
};

/// "in_pose" or "away". @throws ConfigError
[[nodiscard]] VisibilityTrial::Robot visibilityRobot(const std::string& name);

}  // namespace tccm::simulation
