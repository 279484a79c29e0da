#pragma once

#include <memory>
#include <string>
#include <vector>

#include "simulation/clearance.h"
#include "tccm_monitor/robot_model.h"

namespace tccm::simulation {

/// Some links of a robot as it is described, and their exact distance from others' shapes.
class RobotPart {
 public:
  /// @param links names or patterns, as LinkUse has them. @param spacing of surface points [m].
  /// @throws ConfigError where one matches nothing.
  RobotPart(std::shared_ptr<const RobotModel> model, const std::vector<std::string>& links,
            double spacing);

  /// @param link_poses T_fixed_link of all of the model's links.
  void moveTo(const std::vector<Pose>& link_poses);
  [[nodiscard]] const SampledBody& body() const { return body_; }
  [[nodiscard]] SampledBody& body() { return body_; }

 private:
  std::shared_ptr<const RobotModel> model_;
  std::vector<std::size_t> shapes_;  ///< indices into the model's
  std::vector<Pose> poses_;          ///< reused
  SampledBody body_;
};

}  // namespace tccm::simulation
