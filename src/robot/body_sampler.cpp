#include "tccm_monitor/robot/body_sampler.h"

#include <algorithm>
#include <cmath>

#include "tccm_monitor/config_error.h"

namespace tccm {

void BodySampler::Config::validate() const {
  joints.validate();
  requireInRange("body_sample_s", sample_s, 1e-4, 1.0);
}

BodySampler::BodySampler(std::shared_ptr<const RobotModel> model, const Config& config)
    : model_(std::move(model)),
      config_((config.validate(), config)),
      joints_(*model_, config.joints),
      kinematics_(model_) {
  for (const LinkShape& shape : model_->shapes()) shapes_.push_back(shape.shape);
}

std::string BodySampler::sample(Time first, Time last, const PosePath& T_fixed_root) {
  const double steps = std::ceil(toSeconds(last - first) / config_.sample_s);
  const auto intervals = static_cast<Duration::rep>(std::max(1.0, steps));
  samples_.resize(last > first ? static_cast<std::size_t>(intervals) + 1 : 1);
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    BodySample& sample = samples_[i];
    sample.stamp = first + (last - first) * static_cast<Duration::rep>(i) / intervals;
    const auto root = T_fixed_root.at(sample.stamp);
    if (!root) return "no_transform";
    if (!joints_.at(sample.stamp, positions_)) return "no_joint_states";
    kinematics_.update(positions_, *root);
    sample.body.shapes = shapes_;
    sample.body.poses = kinematics_.shapePoses();
  }
  return {};
}

}  // namespace tccm
