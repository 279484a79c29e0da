#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <random>
#include <string>
#include <vector>

#include "experiments/point_ledger.h"
#include "simulation/monitored_simulation.h"

namespace tccm::simulation {

/// What became of the beams of one source that measured a range, indexed by BeamKind.
struct BeamFates {
  BeamCounts anywhere{};
  BeamCounts in_area{};  ///< whose measured point lies in the map's area

  [[nodiscard]] std::size_t keptAnywhere() const { return anywhere[index(BeamKind::kReturn)]; }
  [[nodiscard]] std::size_t mapped() const { return in_area[index(BeamKind::kReturn)]; }
  [[nodiscard]] std::size_t measuredInArea() const;
  [[nodiscard]] static std::size_t index(BeamKind kind) { return static_cast<std::size_t>(kind); }
};

/// A check that found a contact.
struct FalseContact {
  Time stamp;
  bool ahead = false;         ///< at the pose ahead alone
  std::string link;           ///< of the first contact
  SourceCounts supporters{};  ///< returns in and around the cuboids touched, by source
};

/// All that a trial counts.
struct SelfFilterTally {
  std::size_t scans = 0;
  std::size_t checks = 0;
  std::array<BeamFates, kBeamSources> fates{};
  std::size_t checks_with_contact = 0;
  std::size_t contacts_now = 0;  ///< checks with a contact at the present pose
  /// Checks in which any point of a source lies in or around a cuboid that is touched.
  SourceCounts contacts_with{};
  std::size_t contacts_with_body = 0;        ///< checks with kOwn or kOwnMixed among them
  std::vector<FalseContact> first_contacts;  ///< of each run of such checks, at most 100
  /// Where a permission went for a contact, at most 100.
  std::vector<FalseContact> stops;
  double permitted_s = 0.0;  ///< of checks, a robot sample each
  double slowed_s = 0.0;     ///< of that, for a contact ahead

  [[nodiscard]] const BeamFates& of(BeamSource source) const {
    return fates[static_cast<std::size_t>(source)];
  }
  /// Of the scene's points in the area; 0 where there are none.
  [[nodiscard]] double sceneShareRemoved() const;
};

/// The limits that a self filter has to keep.
struct SelfFilterLimits {
  double scene_share_removed = 0.02;
  bool any_contact = false;  ///< a contact of the scene's own mixed pixels misses a limit too

  /// Names of those missed: own_points, contacts_with_body, contacts, scene_removed.
  [[nodiscard]] std::vector<std::string> missed(const SelfFilterTally& tally) const;
};

/// Drives a monitor with the simulated robot, whose arms move clear of everything: any contact that
/// the monitor reports is false. What each beam really met comes from the simulator.
class SelfFilterTrial {
 public:
  struct Config {
    Simulator::Config simulator;
    Monitor::Config monitor;
    double duration_s = 600.0;
    /// Every so often on average the arms pause, for a quarter of that; 0: they never do.
    double pause_every_s = 8.0;
    bool obeys = false;          ///< the arms stop and slow down as they are told; they never pause
    double joints_late_s = 0.0;  ///< as MonitoredSimulation::stampJointsLate()

    /// @throws ConfigError
    void validate() const;
  };

  /// @param model what the monitor takes the robot for. @throws ConfigError
  SelfFilterTrial(const Config& config, std::shared_ptr<const RobotModel> model);

  /// @param progress called with 0..1; may be empty.
  const SelfFilterTally& run(const std::function<void(double)>& progress);

 private:
  void decidePause();
  void countBeams(const SimulatedScan& scan);
  void countPoints(const MappedCloud& cloud);
  void count(BeamSource source, BeamKind kind, const Vector3& p_fixed,
             std::vector<PointLedger::Entry>& entries);
  void countCheck(const Verdict& verdict);
  void noteContacts(const Verdict& verdict);
  void notePermission(const Verdict& verdict);
  [[nodiscard]] FalseContact contactOf(const Verdict& verdict);
  [[nodiscard]] SourceCounts supportersOf(const Verdict& verdict);
  [[nodiscard]] Time now() const { return simulation_.simulator().now(); }

  Config config_;
  MonitoredSimulation simulation_;
  Grid grid_;
  std::vector<PointLedger> ledgers_;  ///< of each sensor
  std::mt19937_64 random_;
  Time next_pause_change_;
  bool paused_ = false;
  bool in_contact_ = false;
  bool permitted_ = false;
  Time last_check_;
  SelfFilterTally tally_;
};

/// All figures with their denominators.
[[nodiscard]] nlohmann::ordered_json toJson(const SelfFilterTally& tally);

}  // namespace tccm::simulation
