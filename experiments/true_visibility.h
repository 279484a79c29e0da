#pragma once

#include <cstdint>
#include <vector>

#include "simulation/motion.h"
#include "tccm_monitor/shape.h"

namespace tccm::simulation {

/// How much of one link the sensor really could see.
struct TrueLinkVisibility {
  std::uint32_t link = 0;         ///< as the caller numbers links
  double silhouette_sr = 0.0;     ///< solid angle where the link is the nearest of the robot
  double visible_fraction = 1.0;  ///< of it: nothing lies in front
  double in_range = 0.0;          ///< share of it where the nodding laser looks at all
};

/// Robot links before a scene, as the sensor could see them: by ray casting on the true shapes,
/// many rays a degree. A link's silhouette is where it is the nearest of the links drawn, so that a
/// link hides another from the picture, and counts for nothing there. The scene, and what else of
/// the robot is said to stand before the sensor, hide links.
class TrueVisibility {
 public:
  struct Config {
    double resolution_rad = 0.005;  ///< between rays
    double margin_m = 0.05;         ///< what is in front hides only what lies behind it by more
    TiltMotion tilt;                ///< about y; the fixed frame's x is ahead

    /// @throws ConfigError
    void validate() const;
  };

  /// @throws ConfigError
  explicit TrueVisibility(const Config& config);

  /// @param links what is drawn. @param link_of_shape the link that each of its shapes belongs to.
  /// @param things that hide links; one that contains the viewpoint does not.
  /// @return one for each link, in the order of their first shapes.
  [[nodiscard]] std::vector<TrueLinkVisibility> find(
      const Vector3& viewpoint, const Body& links, const std::vector<std::uint32_t>& link_of_shape,
      const Body& things) const;

 private:
  [[nodiscard]] bool isInRange(const Vector3& direction) const;

  Config config_;
};

}  // namespace tccm::simulation
