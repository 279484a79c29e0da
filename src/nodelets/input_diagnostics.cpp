#include "nodelets/input_diagnostics.h"

#include <limits>

namespace tccm {

InputDiagnostics::InputDiagnostics(diagnostic_updater::Updater& updater, const std::string& topic,
                                   double rate_min_hz, double age_max_s, double future_max_s)
    : rate_min_hz_(rate_min_hz), rate_max_hz_(std::numeric_limits<double>::infinity()) {
  topic_ = std::make_unique<diagnostic_updater::TopicDiagnostic>(
      topic, updater, diagnostic_updater::FrequencyStatusParam(&rate_min_hz_, &rate_max_hz_, 0.0),
      diagnostic_updater::TimeStampStatusParam(-future_max_s, age_max_s));
}

}  // namespace tccm
