#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "tccm_monitor/time.h"

namespace tccm {

struct JointSample {
  Time stamp;
  double position = 0.0;       ///< [rad] or [m]
  double velocity = 0.0;       ///< as reported; NaN where it was not
  std::uint8_t publisher = 0;  ///< as JointStates numbers them
};

/// The last samples of one joint, in a ring that is allocated once.
class JointTrack {
 public:
  /// @param turns_freely it is the same after a whole turn.
  JointTrack(std::size_t samples_max, bool turns_freely)
      : ring_(samples_max), turns_freely_(turns_freely) {}

  /// A step that no permitted speed explains.
  struct Jump {
    JointSample from;
    JointSample to;
    int in_turn = 1;  ///< which one of those to and fro
  };
  /// The last such step, for whoever looks for the step back.
  std::optional<Jump> jump = {};
  /// Since when its positions change faster than is believed.
  std::optional<Time> fast_since = {};
  bool fast_upwards = false;

  void clear();
  /// @pre its stamp is later than that of the newest
  void add(const JointSample& sample);

  [[nodiscard]] std::size_t size() const { return count_; }
  /// The k-th newest. @pre k < size()
  [[nodiscard]] const JointSample& newest(std::size_t k) const {
    return ring_[(next_ + ring_.size() - 1 - k) % ring_.size()];
  }
  /// The newest that is no later than the instant; nothing where all are later.
  [[nodiscard]] const JointSample* before(Time stamp) const;

  /// From one position to another; of a joint that turns freely the short way.
  [[nodiscard]] double moved(double from, double to) const;
  struct Slope {
    double speed = 0.0;   ///< [1/s], with its sign
    double over_s = 0.0;  ///< between the samples it was taken from; 0 where there is but one
  };
  /// Over the baseline, unless there is a gap.
  [[nodiscard]] Slope differentiate(double baseline_s, double gap_max_s) const;
  /// How fast the joint goes from sample to sample, where two that are interleaved publish it: of
  /// the steps over one and over two samples the lower quartile. 0 where there are too few.
  [[nodiscard]] double usualSpeed() const;
  /// Between the samples around an instant. @return nothing where they are too far apart, or there
  /// are none.
  [[nodiscard]] std::optional<double> at(Time stamp, double gap_max_s) const;

 private:
  [[nodiscard]] double quartileOfSpeeds(std::size_t apart) const;

  std::vector<JointSample> ring_;
  std::size_t count_ = 0;
  std::size_t next_ = 0;
  bool turns_freely_;
};

}  // namespace tccm
