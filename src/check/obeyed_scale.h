#pragma once

#include <optional>

#include "tccm_monitor/time.h"

namespace tccm {

/// What scale of its commanded speed a robot moves at: it obeys a permission only after a while,
/// and then brakes; so that there is a range. Allocates nothing.
class ObeyedScale {
 public:
  /// @param scale of the permission as of now, 0..1. @param braking of the scale, when the robot
  /// brakes [1/s]. @param lag after which the robot is seen to obey: the controller's and the joint
  /// states' delay. @pre now does not go back.
  void add(Time now, double scale, double braking, Duration lag);

  [[nodiscard]] double least() const { return least_; }
  [[nodiscard]] double most() const { return most_; }

 private:
  struct Range {
    double least;
    double most;
    void widenBy(double scale);
  };
  std::optional<Time> last_;
  Time begun_ = {};             ///< the present part, of at least one lag
  Range present_ = {1.0, 1.0};  ///< of permissions in it
  Range before_ = {1.0, 1.0};   ///< in the part before
  double least_ = 1.0;
  double most_ = 1.0;
};

}  // namespace tccm
