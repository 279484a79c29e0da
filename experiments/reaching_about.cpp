#include "experiments/reaching_about.h"

#include <optional>
#include <stdexcept>
#include <vector>

#include "experiments/draw.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

std::optional<ArmPath> pathAlong(const std::shared_ptr<const RobotModel>& model,
                                 const std::vector<Vector3>& places) {
  try {
    return reachVia(model, places);
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
}

}  // namespace

ArmPath reachingAbout(const std::shared_ptr<const RobotModel>& model, double length_m,
                      std::uint64_t seed) {
  constexpr int kAttempts = 10000;
  constexpr double kFar = 0.1;  // [m] that places are apart at least
  Draw draw(seed);
  std::vector<Vector3> places = {Vector3(0.5, -0.25, 0.95)};
  std::optional<ArmPath> path;
  for (int i = 0; i < kAttempts; ++i) {
    const Vector3 next(draw.between(0.42, 0.7), draw.between(-0.45, 0.05), draw.between(0.85, 1.1));
    if ((next - places.back()).norm() < kFar) continue;
    places.push_back(next);
    std::optional<ArmPath> longer = pathAlong(model, places);
    if (longer) {
      path = std::move(longer);
    } else {
      places.pop_back();
    }
    if (path && path->length() >= length_m) return *path;
  }
  throw ConfigError("duration_s: no path of " + std::to_string(length_m) + " m is found");
}

}  // namespace tccm::simulation
