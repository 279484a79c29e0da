#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <diagnostic_updater/publisher.h>

#include <memory>
#include <string>

namespace tccm {

/// Rate and age of one input's messages, as diagnostic_updater's frequency and stamp status
/// (REP 107).
class InputDiagnostics {
 public:
  /// @param rate_min_hz less is an error. @param age_max_s older is an error, as is a stamp that
  /// leads by more than future_max_s.
  InputDiagnostics(diagnostic_updater::Updater& updater, const std::string& topic,
                   double rate_min_hz, double age_max_s, double future_max_s);

  void tick(const ros::Time& stamp) { topic_->tick(stamp); }

 private:
  double rate_min_hz_;
  double rate_max_hz_;
  std::unique_ptr<diagnostic_updater::TopicDiagnostic> topic_;
};

}  // namespace tccm
