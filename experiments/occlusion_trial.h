#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "experiments/visibility_scene.h"
#include "simulation/monitored_simulation.h"

namespace tccm::simulation {

/// Something comes between the laser and the robot's arms, which stand in a random pose: is a link
/// that it hides found to be occluded within one tilt?
class OcclusionTrial {
 public:
  struct Config {
    Monitor::Config monitor;
    double noise_m = 0.01;
    double clearance_m = 0.08;        ///< between robot and everything else
    double obstacle_speed_mps = 0.0;  ///< it is brought in from aside; 0: it appears at once
    double hidden_min = 0.2;          ///< of a link's silhouette; what hides less is not asked for
    LinksThatCount counted;
    double resolution_rad = 0.01;  ///< between the true rays

    /// @throws ConfigError
    void validate() const;
  };
  /// A link that counts.
  struct Link {
    std::string name;
    double hidden = 0.0;            ///< by rays, by the occluder alone
    double occluded = 0.0;          ///< the monitor's, the most within one tilt
    std::optional<double> found_s;  ///< after the occluder was there
  };
  struct Result {
    std::uint64_t seed = 0;
    std::string scene, obstacle;
    double tilt_phase = 0.0;       ///< when the occluder was there, 0..1
    std::optional<Link> link;      ///< that the occluder hides most of, if more than hidden_min
    std::optional<double> beam_s;  ///< the first that showed the occluder, after it was there
    /// Of one that is hidden to no more than hidden_min by anything: the first found all the same.
    std::optional<Link> false_flag;
    double simulated_s = 0.0;
  };

  /// @param model what the monitor takes the robot for. @throws ConfigError
  OcclusionTrial(const Config& config, std::shared_ptr<const RobotModel> model, std::uint64_t seed);

  /// The same for the same seed.
  [[nodiscard]] Result run();

 private:
  struct Watched {
    std::size_t link;  ///< index into the model's
    double visible = 0.0, hidden = 0.0;
    Link found;
  };
  [[nodiscard]] Simulator::Config settingFor(std::uint64_t seed);
  [[nodiscard]] std::vector<Watched> watchedLinks() const;
  void noteScan(const SimulatedScan& scan);
  void noteVerdict(const Verdict& verdict);
  [[nodiscard]] bool occluderIsThere() const { return simulation_.simulator().now() >= there_; }

  Config config_;
  std::shared_ptr<const RobotModel> model_;
  VisibilityScene scene_;
  Result result_;
  Time there_;  ///< the occluder is in its place; without one, when it would be
  MonitoredSimulation simulation_;
  std::vector<Watched> watched_;
};

}  // namespace tccm::simulation
