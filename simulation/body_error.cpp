#include "simulation/body_error.h"

#include <random>

#include "simulation/named.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

Vector3 randomDirection(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random);
  const double y = normal(random);
  return Vector3(x, y, normal(random)).normalized();
}

}  // namespace

void BodyError::validate() const { requireInRange("body_error_m", size_m, 0.0, 0.1); }

BodyError::Kind bodyErrorKind(const std::string& name) {
  return named<BodyError::Kind>("body_error", name, {"thicker", "thinner", "displaced"});
}

std::vector<PlacedShape> trueShapes(const std::vector<LinkShape>& described, const BodyError& error,
                                    std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<PlacedShape> shapes;
  for (const LinkShape& shape : described) {
    PlacedShape placed{shape.shape};
    if (error.kind == BodyError::Kind::kDisplaced) {
      placed.pose.translation() = error.size_m * randomDirection(random);
    } else {
      const double sign = error.kind == BodyError::Kind::kThicker ? 1.0 : -1.0;
      placed.shape = expanded(shape.shape, {1.0, sign * error.size_m});
      validate(placed.shape, "body_error_m");
    }
    shapes.push_back(placed);
  }
  return shapes;
}

}  // namespace tccm::simulation
