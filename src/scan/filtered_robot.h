#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "robot/body_sampler.h"

namespace tccm {

/// The robot that is filtered out of what a sensor measured, with what it holds; may be nobody.
class FilteredRobot {
 public:
  /// @param model may be nothing. @throws ConfigError
  FilteredRobot(const BodySampler::Config& config, std::shared_ptr<const RobotModel> model);

  /// Nothing where no robot is filtered out.
  [[nodiscard]] BodySampler* body() const { return body_.get(); }
  [[nodiscard]] const JointStates* joints() const { return body_ ? &body_->joints() : nullptr; }
  /// What the robot holds from now on; objects that are no good are left out.
  /// @return why, a line for each of those.
  std::vector<std::string> hold(const std::vector<AttachedObject>& objects);
  void reset();

  /// Samples from first to last. @return empty, or why the body is unknown then.
  [[nodiscard]] std::string sample(Time first, Time last,
                                   const std::vector<PosePath>& T_fixed_roots);
  /// None where no robot is filtered out.
  [[nodiscard]] const std::vector<BodySample>& samples() const;

  /// @param counts how many points of a scan were taken for each of a sample's shapes.
  void count(const std::vector<std::size_t>& counts);
  /// The link that most points of the last hundred scans or so were taken for; empty where none.
  [[nodiscard]] const std::string& mostCounted() const { return most_counted_; }

 private:
  std::shared_ptr<const RobotModel> bare_model_;  ///< with empty hands
  std::unique_ptr<BodySampler> body_;
  std::vector<double> counts_;  ///< by link, forgotten slowly
  std::string most_counted_;
};

}  // namespace tccm
