#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <diagnostic_updater/publisher.h>

#include <limits>
#include <string>

namespace tccm {

/// Rate and age of one input's messages, as diagnostic_updater's frequency and stamp status
/// (REP 107).
class InputDiagnostics {
 public:
  /// @param rate_min_hz less is an error. @param age_max_s older is an error, as is a stamp that
  /// leads by more than future_max_s.
  InputDiagnostics(diagnostic_updater::Updater& updater, const std::string& topic,
                   double rate_min_hz, double age_max_s, double future_max_s)
      : rate_min_hz_(rate_min_hz),
        topic_(topic, updater,
               diagnostic_updater::FrequencyStatusParam(&rate_min_hz_, &rate_max_hz_, 0.0),
               diagnostic_updater::TimeStampStatusParam(-future_max_s, age_max_s)) {}

  void tick(const ros::Time& stamp) { topic_.tick(stamp); }

 private:
  double rate_min_hz_;
  double rate_max_hz_ = std::numeric_limits<double>::infinity();
  diagnostic_updater::TopicDiagnostic topic_;
};

}  // namespace tccm
