#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "check/situation.h"
#include "config/parameter_table.h"

namespace tccm {

/// What scale of its commanded speed a robot moves at: it obeys a permission only after a while,
/// and then brakes; so that there is a range. Allocates nothing.
class ObeyedScale {
 public:
  /// @param scale of the permission as of now, 0..1. @param braking of the scale, when the robot
  /// brakes [1/s]. @param lag after which the robot is seen to obey: the controller's and the joint
  /// states' delay. @pre now does not go back.
  void add(Time now, double scale, double braking, Duration lag);

  [[nodiscard]] double least() const { return std::min(before_.least, present_.least); }
  [[nodiscard]] double most() const { return most_; }

 private:
  /// Of permissions.
  struct Range {
    double least = 1.0, most = 1.0;
  };
  std::optional<Time> last_;
  Time begun_;     ///< the present part, of at least one lag
  Range present_;  ///< in it
  Range before_;   ///< in the part before
  double most_ = 1.0;
};

/// How fast the robot may go so that whatever appears a distance d ahead of a link, at any moment,
/// is seen and braked for: the way from then to the verdict on the next look at the place, and the
/// braking way, stay under d.
///
/// While a point of the robot moves, the place that is d ahead of it is noted again and again.
/// Until a scan has seen a place since it was noted, the point may be travelled s + v (t + L) + v^2
/// / 2a from there at most, where s is what it has travelled since, t the time to the next look at
/// the place, which the tilt's period tells, L the delay of a verdict. Where no look is due, what
/// is left of the way has to last for a long time, so that the speed goes to nothing.
class GovernedSpeed {
 public:
  struct Config {
    double appear_distance_m = 0.0;  ///< d
    double look_margin_m = 0.05;
    double speed_max_mps = 1.0;
    double place_step_m = 0.01;

    void describe(ParameterTable& table);
  };

  /// What limits the robot.
  struct Limit {
    double scale = 1.0;        ///< of the commanded speed
    std::size_t link = 0;      ///< that is limited most; meaningless where scale is 1
    double allowed_mps = 0.0;  ///< its speed then
    /// Until the place ahead of it is looked at; nothing: no look is due.
    std::optional<double> next_look_s;
  };

  /// @param shapes indices of the model's shapes whose points are watched. @throws ConfigError
  GovernedSpeed(std::shared_ptr<const RobotModel> model, const Config& config,
                const std::vector<std::size_t>& shapes);

  [[nodiscard]] bool active() const { return config_.appear_distance_m > 0.0; }
  /// @pre stamps do not fall.
  void judge(const Situation& situation, Causes& causes);
  /// What the last judge() found.
  [[nodiscard]] const Limit& limit() const { return limit_; }
  /// Forgets where the robot was.
  void startAnew();
  /// Goes on with what another knows of the same points; of another distance nothing is of use.
  void takeOver(const GovernedSpeed& before);

 private:
  /// A place that something may have appeared at.
  struct Place {
    Vector3 p_fixed;
    double travelled_m;  ///< of the point when it was noted
    Time since;
  };
  /// A point of a primitive.
  struct Track {
    std::size_t shape;
    Vector3 p_shape;
    double radius_m;  ///< of the primitive around it
    Vector3 p_fixed = Vector3::Zero();
    Vector3 velocity = Vector3::Zero();
    double travelled_m = 0.0;
    double commanded_mps = 0.0;  ///< by estimate, at full scale
    std::vector<Place> places = {};
  };
  /// How late what a sensor sees is checked.
  struct Feed {
    std::uint32_t serial = 0;  ///< of its last map
    double delay_s = 0.0;      ///< from a scan's first beam to the check on it, the longest lately
  };
  struct NextLook {
    double until_s;
    double delay_s;  ///< and until the verdict on it
    bool is_due;
  };
  void addTracks(std::size_t shape);
  void noteDelays(const Situation& situation);
  [[nodiscard]] NextLook nextLook(const Place& place, const Situation& situation) const;
  void move(const Situation& situation);
  void estimateCommand(Track& track, double seconds) const;
  void notePlace(Track& track, const Situation& situation) const;
  [[nodiscard]] bool isBehindAnother(const Track& track, const Vector3& p_fixed,
                                     const Posture& posture) const;
  [[nodiscard]] double marginAt(const LookImage& looks, const Vector3& p_fixed) const;
  void forgetSeen(const Surroundings& around, Track& track) const;
  void limitBy(const Track& track, const Situation& situation);

  std::shared_ptr<const RobotModel> model_;
  Config config_;
  Kinematics kinematics_soon_;
  std::vector<double> positions_soon_;
  std::vector<Track> tracks_;
  std::optional<Time> last_;
  std::vector<Feed> feeds_;  ///< by sensor
  ObeyedScale obeyed_;
  Limit limit_;
};

}  // namespace tccm
