#pragma once

#include <optional>
#include <string>

#include "check/model_agreement.h"
#include "ros/transform_history.h"

namespace tccm {

/// What a history knows, as the comparison with the model asks for it. @param history outlives it.
[[nodiscard]] inline ModelAgreement::Transforms transformsOf(const TransformHistory& history) {
  // An arm at 2 rad/s goes some millimetres off the straight way between two such transforms.
  static constexpr Duration kGapMax = std::chrono::milliseconds(150);
  using Newest = ModelAgreement::Transforms::Newest;
  return {
      [&history](const std::string& reference, const std::string& frame) -> std::optional<Newest> {
        const auto newest = history.newest(reference, frame);
        if (!newest) return std::nullopt;
        return Newest{newest->stamp, newest->pose, newest->is_static};
      },
      [&history](const std::string& reference, const std::string& frame,
                 Time stamp) -> std::optional<Pose> {
        const auto found = history.at(reference, frame, stamp, kGapMax);
        if (found.status != TransformHistory::Status::kFound) return std::nullopt;
        return found.pose;
      }};
}

}  // namespace tccm
