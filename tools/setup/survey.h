#pragma once

#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tccm_monitor/pose.h"
#include "tools/program.h"

namespace tccm {

/// What a robot publishes, as a bag has it.
struct Survey {
  /// One stream of messages.
  struct Stream {
    std::size_t messages = 0;
    std::set<std::string> publishers;
    Time first, last;            ///< stamps
    std::vector<double> gaps_s;  ///< between stamps that follow one another

    void add(Time stamp, const std::string& publisher);
    /// The longest gap that is not longer than that; 0 where there is none.
    [[nodiscard]] double longestGap(double at_most_s) const;
    /// Messages a second; 0 of fewer than two.
    [[nodiscard]] double rate() const;
  };
  struct Sensor : Stream {
    std::string topic;
    bool is_cloud = false;
    std::size_t rows_max = 0;                                    ///< of a cloud
    std::set<std::string> frames;                                ///< without slashes
    std::size_t points_max = 0;                                  ///< or beams
    double range_max_m = 0.0;                                    ///< as a scan states it
    double nearest_m = std::numeric_limits<double>::infinity();  ///< that was measured
    double furthest_m = 0.0;
    std::vector<float> last_ranges_m;  ///< of some pixels of a cloud with rows
    struct Change {
      float range_m, by_m;
    };
    std::vector<Change> changes;  ///< of those from cloud to cloud

    struct Noise {
      double deviation_m;  ///< standard deviation of a range
      double range_m;      ///< at this, the median
    };
    /// Of a camera or lidar that stands still; nothing where that cannot be told.
    [[nodiscard]] std::optional<Noise> noise() const;
  };
  struct Joint : Stream {
    double lowest = std::numeric_limits<double>::infinity();
    double highest = -std::numeric_limits<double>::infinity();
  };
  /// A frame in its parent, as transforms have it.
  struct Frame : Stream {
    std::string parent;
    bool is_static = true;  ///< on /tf_static alone
    Pose begin = Pose::Identity();
    double travel_m = 0.0;  ///< from there, at most
    double turn_rad = 0.0;

    [[nodiscard]] bool moves() const { return travel_m > 0.02 || turn_rad > 0.02; }
  };

  std::vector<Sensor> sensors;                                 ///< by topic
  std::map<std::string, std::map<std::string, Joint>> joints;  ///< by topic and name
  std::map<std::string, Frame> frames;                         ///< by name, without slashes

  /// The frame, and all above it.
  [[nodiscard]] std::vector<std::string> upFrom(const std::string& frame) const;
  /// Those of the frame and what is above it, below `top`, that move. @param top may be empty.
  [[nodiscard]] std::vector<std::string> movingBelow(const std::string& frame,
                                                     const std::string& top) const;
  /// The topic that has most of the joints. Empty where none has any.
  [[nodiscard]] std::string topicOfJoints(const std::set<std::string>& joints) const;
};

/// @throws InputError where the bag cannot be read.
[[nodiscard]] Survey surveyOf(const std::string& bag, const Progress& progress);

}  // namespace tccm
