#include "experiments/stretching.h"

#include <array>
#include <optional>
#include <stdexcept>
#include <string>

#include "experiments/draw.h"
#include "simulation/posture_check.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

constexpr double kHighest = 1.1;  // [m] of the palm
constexpr double kLowest = 0.8;
constexpr double kTight = 0.004;  // [m] within which the lowest height is found

class Stretch {
 public:
  Stretch(const std::shared_ptr<const RobotModel>& model, const World& world,
          const StretchConfig& config)
      : model_(model), config_(config), check_(model, world, config.clearance_m) {}

  /// As low as can be; nothing where not even the highest one can be gone.
  [[nodiscard]] std::optional<ArmPath> lowest(const std::array<Vector3, 2>& places) {
    double high = kHighest, low = kLowest;
    std::optional<ArmPath> best = at(places, high);
    while (best && high - low > kTight) {
      const double middle = 0.5 * (high + low);
      std::optional<ArmPath> path = at(places, middle);
      (path ? high : low) = middle;
      if (path) best = std::move(path);
    }
    return best;
  }

 private:
  [[nodiscard]] std::optional<ArmPath> at(std::array<Vector3, 2> places, double height_m) {
    for (Vector3& place : places) place.z() += height_m;
    try {
      ArmPath path = reachVia(model_, {places[0], places[1]});
      if (keepsClear(path)) return path;
    } catch (const std::runtime_error&) {  // out of the arm's reach
    }
    return std::nullopt;
  }

  [[nodiscard]] bool keepsClear(const ArmPath& path) {
    constexpr double kAlong = 0.01;  // [m]
    for (double way = 0.0; way < path.length() + kAlong; way += kAlong) {
      std::vector<double> rates = path.slopes(way);
      for (double& rate : rates) rate *= config_.speed_mps;
      if (!check_.passesAround(path.positions(way), rates, config_.horizon_s)) return false;
    }
    return true;
  }

  std::shared_ptr<const RobotModel> model_;
  StretchConfig config_;
  PostureCheck check_;
};

}  // namespace

ArmPath stretchOver(const std::shared_ptr<const RobotModel>& model, const World& world,
                    const StretchConfig& config) {
  constexpr int kAttempts = 1000;
  Draw draw(config.seed);
  Stretch stretch(model, world, config);
  for (int i = 0; i < kAttempts; ++i) {
    // Heights are above that of the way's end.
    const Vector3 from(draw.between(0.24, 0.4), draw.between(-0.5, -0.1), draw.between(0.0, 0.06));
    const Vector3 to(draw.between(0.5, 0.72), draw.between(-0.4, 0.1), 0.0);
    if (auto path = stretch.lowest({from, to})) return *path;
  }
  throw ConfigError("clearance_m: no stretch over the scene keeps a clearance of " +
                    std::to_string(config.clearance_m) + " m");
}

}  // namespace tccm::simulation
