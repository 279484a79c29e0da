#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "check/situation.h"
#include "config/parameter_table.h"

namespace tccm {

/// Whether something that was not there a moment ago is near the robot: a hand that reaches for an
/// arm moves further from frame to frame than the padding for contacts is wide, and what is as near
/// as that may be taken for the arm itself.
class ApproachCheck {
 public:
  struct Config {
    double distance_m = 0.15;

    void describe(ParameterTable& table);
  };

  ApproachCheck(std::shared_ptr<const CheckedRobot> robot, const Config& config);

  /// Adds APPROACHED where a cuboid that has appeared, and would count as a contact, is within the
  /// distance of a link that is checked for collision.
  /// @return the first such, of the model's shapes.
  std::optional<Contact> judge(const Situation& situation, Causes& causes) const;

 private:
  std::shared_ptr<const CheckedRobot> robot_;
  double distance_m_;
  std::vector<Shape> reach_;  ///< the collision body's shapes, grown by the distance
};

}  // namespace tccm
