#include "scan/filtered_robot.h"

#include <algorithm>

#include "tccm_monitor/config_error.h"

namespace tccm {

FilteredRobot::FilteredRobot(const BodySampler::Config& config,
                             std::shared_ptr<const RobotModel> model)
    : bare_model_(std::move(model)) {
  if (bare_model_) body_ = std::make_unique<BodySampler>(bare_model_, config);
}

std::vector<std::string> FilteredRobot::hold(const std::vector<AttachedObject>& objects) {
  std::vector<std::string> defects;
  if (!body_) return defects;
  std::vector<AttachedObject> held;
  for (const AttachedObject& object : objects) {
    held.push_back(object);
    try {
      static_cast<void>(bare_model_->holding(held));
    } catch (const ConfigError& error) {
      // The others are taken all the same: what was detached must not be filtered out any longer.
      held.pop_back();
      defects.emplace_back(error.what());
    }
  }
  body_->setModel(std::make_shared<const RobotModel>(bare_model_->holding(held)));
  return defects;
}

void FilteredRobot::reset() {
  if (body_) body_->joints().reset();
}

std::string FilteredRobot::sample(Time first, Time last,
                                  const std::vector<PosePath>& T_fixed_roots) {
  return body_ ? body_->sample(first, last, T_fixed_roots) : std::string();
}

const std::vector<BodySample>& FilteredRobot::samples() const {
  static const std::vector<BodySample> kNobody;
  return body_ ? body_->samples() : kNobody;
}

void FilteredRobot::count(const std::vector<std::size_t>& counts) {
  constexpr double kKept = 0.99;  // of a scan's counts at the next
  if (!body_) return;
  counts_.resize(bare_model_->links().size());
  for (double& count : counts_) count *= kKept;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    counts_[body_->linkOf(i)] += static_cast<double>(counts[i]);
  }
  const auto most = std::max_element(counts_.begin(), counts_.end());
  const auto link = static_cast<std::size_t>(most - counts_.begin());
  if (*most > 0.0) most_counted_ = bare_model_->links()[link];
}

}  // namespace tccm
