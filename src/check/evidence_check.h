#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "check/situation.h"
#include "config/parameter_table.h"

namespace tccm {

/// What is known of the space that one link is in and goes through.
struct LinkEvidence {
  std::size_t link = 0;        ///< index into the model's links
  double new_volume_m3 = 0.0;  ///< that it goes through and is not in now
  /// Of that: never seen, hidden when it was looked at last, or outside the map's area.
  double unseen_fraction = 0.0;
  double old_fraction = 0.0;   ///< of its way, now included: not looked at for slow_periods
  double lost_fraction = 0.0;  ///< the same for stop_periods
  /// Of the oldest evidence for what was seen of its way; nothing where nothing of it was.
  std::optional<double> age_s;
  /// Until its way's end is looked at next; nothing: none is due.
  std::optional<double> next_look_s;
};

/// What is known of the way ahead, by place: a scan may be fresh and say nothing of the space that
/// a link is about to enter. Where the map does not reach, whatever stands there is in no map,
/// however well the sensor sees it: that is unseen, too. Looked at are points in every primitive,
/// at the present pose, at the way's end and halfway.
class EvidenceCheck {
 public:
  struct Config {
    std::vector<std::string> links;
    double margin_m = 0.05;
    double slow_periods = 1.5;
    double stop_periods = 2.5;
    double old_fraction_max = 0.3;
    double unseen_fraction_max = 0.2;
    double unseen_volume_min_m3 = 2e-4;
    double slow_scale = 0.3;
    bool unseen_stops = false;

    void describe(ParameterTable& table);
  };

  struct Findings {
    std::vector<LinkEvidence> links;  ///< in the order of the links' first shapes
    double unseen_fraction = 0.0;     ///< of all that the links go through; 0 where that is little
    double outside_fraction = 0.0;    ///< the part of it that the map does not reach
  };

  /// @throws ConfigError, also where a pattern matches no link.
  EvidenceCheck(std::shared_ptr<const CheckedRobot> robot, const Config& config);

  /// Where too much is unseen, or what is known is too old.
  void judge(const Situation& situation, Causes& causes);

  /// @param now_body, end_body the same primitives at the present pose and at the way's end.
  /// The reference is valid until the next call.
  const Findings& find(const Surroundings& around, Time now, const Body& now_body,
                       const Body& end_body);
  [[nodiscard]] const Findings& findings() const { return findings_; }
  /// The model's shapes whose way should have been seen.
  [[nodiscard]] const std::vector<std::size_t>& shapes() const { return shapes_; }

  /// Places of the last find() that the links go through and that were not seen [m, fixed frame].
  [[nodiscard]] const std::vector<Vector3>& unseenPlaces() const { return unseen_; }

 private:
  /// What is summed up for a link: numbers of places, and volumes [m^3].
  struct Tally {
    double looked_at = 0.0, old = 0.0, lost = 0.0;
    double new_volume = 0.0, unseen_volume = 0.0, outside_volume = 0.0;
    std::optional<Time> oldest;  ///< evidence
  };
  /// What one sensor looked at, and from which age on its evidence is old, and lost.
  struct Sensor {
    const CuboidMap* map;
    Duration old, lost;
    bool is_out;
  };
  struct Question {
    const Grid& grid;
    Time now;
  };
  /// What is known of a place.
  struct Evidence {
    bool looked = false, old = true, lost = true;  ///< old and lost: of all that looked there
    std::optional<Time> known;                     ///< seen lately
    std::optional<Time> seen;  ///< seen, in a direction in which was looked since
  };
  struct Place {
    Vector3 p_fixed;
    double new_volume;  ///< that it stands for; 0 where the robot is there now
    Evidence evidence;
  };
  [[nodiscard]] Evidence evidenceOf(const Sensor& sensor, const Vector3& p_fixed, Time now) const;
  [[nodiscard]] Evidence evidenceOf(const Vector3& p_fixed, Time now) const;
  [[nodiscard]] std::optional<double> nextLook(const Vector3& p_fixed, Time now) const;
  void lookAlong(const Question& question, const Body& now_body, std::size_t i,
                 const Pose& T_fixed_end);
  /// @param first of the body's shapes that is asked.
  [[nodiscard]] bool contains(const Body& body, std::size_t first, const Vector3& p_fixed) const;
  void count(const Question& question, const Place& place, Tally& tally);
  void sumUp(const Question& question, const Body& end_body);

  static constexpr std::size_t kPassedOver = static_cast<std::size_t>(-1);
  std::shared_ptr<const CheckedRobot> robot_;
  Config config_;
  std::vector<std::size_t> shapes_;
  std::vector<std::size_t> slot_of_shape_;      ///< index into the findings' links, or kPassedOver
  std::vector<std::size_t> end_shape_of_slot_;  ///< the last of its shapes
  Findings findings_;
  std::vector<Sensor> sensors_;
  std::vector<double> radii_;  ///< of spheres around the body's shapes
  std::vector<Pose> T_shapes_fixed_;
  std::vector<Tally> tallies_;  ///< by slot
  std::vector<Vector3> unseen_;
};

}  // namespace tccm
