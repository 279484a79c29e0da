#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "experiments/sensor_choice.h"
#include "simulation/monitored_simulation.h"

namespace tccm::simulation {

/// A small box appears at a place in the air while the arms stand: after how long would a link of
/// its size, there, stop?
class SmallObjectTrial {
 public:
  struct Config {
    Monitor::Config monitor;
    SensorChoice sensors;  ///< the laser alone, or a camera alone
    Scanner::Config scanner;
    TiltMotion tilt;        ///< its phase is drawn
    double size_m = 0.05;   ///< edge of the box
    double settle_s = 5.0;  ///< until the map is whole

    /// @throws ConfigError
    void validate() const;
    [[nodiscard]] bool ofCamera() const { return !sensors.isLaserAlone(); }
    /// Within which it has to be found: one tilt, and the scan that ends it, or one frame, and the
    /// millisecond that it may begin late [s].
    [[nodiscard]] double limit() const;
  };
  struct Result {
    std::uint64_t seed = 0;
    Vector3 place = Vector3::Zero();  ///< of the box's middle [m]
    double yaw_rad = 0.0;
    double tilt_phase = 0.0;       ///< when it appears, 0..1
    std::optional<double> beam_s;  ///< after it appeared: the first beam that ended on it
    /// And the last beam of the scan, or the frame, with which it is in contact.
    std::optional<double> found_s;
    double simulated_s = 0.0;
  };

  /// @param model what the monitor takes the robot for. @throws ConfigError
  SmallObjectTrial(const Config& config, std::shared_ptr<const RobotModel> model,
                   const Vector3& place, std::uint64_t seed);

  /// For one tilt, and the scan that ends it, or some frames. The same for the same seed.
  [[nodiscard]] Result run();

 private:
  [[nodiscard]] Simulator::Config settingFor(const Vector3& place, std::uint64_t seed);
  void noteScan(const SimulatedScan& scan);
  void noteFrame(const MappedCloud& frame);
  [[nodiscard]] std::size_t label() const;
  void lookForContact(Time seen);

  Config config_;
  Result result_;
  Time there_;  ///< from when on the box is there
  SceneObject object_;
  CollisionCheck check_;
  MonitoredSimulation simulation_;
};

/// The places of an even grid where such a box can be seen: not further from the laser, or the
/// camera, than within_m, in the map's area, in the tilt's range or the picture with all of it,
/// before nothing of the robot, and clear of it. By rays on the described shapes, apart from the
/// map and its looks.
[[nodiscard]] std::vector<Vector3> smallObjectPlaces(const SmallObjectTrial::Config& config,
                                                     const std::shared_ptr<const RobotModel>& model,
                                                     double within_m, double step_m);

}  // namespace tccm::simulation
