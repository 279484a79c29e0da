#include "robot/body_sampler.h"

#include <algorithm>
#include <cmath>

#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

/// [m] that a padding grows by at most for its primitive's speed: joint states that jump must not
/// make the filter take the surroundings for the robot.
constexpr double kGrowthMax = 0.05;

}  // namespace

void BodySampler::Config::describe(ParameterTable& table) {
  filtered.describe(table, kSelfFilterKeys);
  table.add("self_filter_attached_padding_m", &attached_padding_m, "m", {0.0, 1.0},
            "at least this for objects in the hand, whose shape and place are known less well");
  table.add("self_filter_lateness_s", &lateness_s, "s", {0.0, 1.0},
            "joint states may be so late: a primitive's padding grows by this times its speed, by "
            "50 mm at most");
  table.add("body_sample_s", &sample_s, "s", {1e-4, 1.0},
            "how often the body is placed anew within a scan");
  joints.describe(table);
}

BodySampler::BodySampler(std::shared_ptr<const RobotModel> model, const Config& config)
    : model_(std::move(model)),
      config_(validated(config)),
      joints_(*model_, config.joints),
      kinematics_(model_) {
  setModel(model_);
}

void BodySampler::setModel(std::shared_ptr<const RobotModel> model) {
  UsedShapes used = model->shapesFor(config_.filtered, kSelfFilterKeys);
  model_ = std::move(model);
  used_ = std::move(used);
  kinematics_ = Kinematics(model_);
  body_ = Body();
  radii_m_.clear();
  for (std::size_t i = 0; i < used_.shapes.size(); ++i) {
    const Expansion& expansion = used_.expansions[i];
    body_.shapes.push_back(
        expanded(model_->shapes()[used_.shapes[i]].shape, Expansion{expansion.scale, 0.0}));
    const bool is_held = !model_->shapes()[used_.shapes[i]].object.empty();
    body_.paddings_m.push_back(
        std::max(expansion.padding_m, is_held ? config_.attached_padding_m : 0.0));
    radii_m_.push_back(boundingRadius(body_.shapes.back()));
  }
  body_.poses.resize(body_.shapes.size(), Pose::Identity());
}

bool BodySampler::placeRoots(Time stamp, const std::vector<PosePath>& T_fixed_roots) {
  if (T_fixed_roots.size() != model_->roots().size()) return false;
  roots_.resize(T_fixed_roots.size());
  for (std::size_t i = 0; i < roots_.size(); ++i) {
    const auto root = T_fixed_roots[i].at(stamp);
    if (!root) return false;
    roots_[i] = *root;
  }
  return true;
}

std::string BodySampler::sample(Time first, Time last, const std::vector<PosePath>& T_fixed_roots) {
  const double steps = std::ceil(toSeconds(last - first) / config_.sample_s);
  const auto intervals = static_cast<Duration::rep>(std::max(1.0, steps));
  samples_.resize(last > first ? static_cast<std::size_t>(intervals) + 1 : 1);
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    BodySample& sample = samples_[i];
    sample.stamp = first + (last - first) * static_cast<Duration::rep>(i) / intervals;
    if (!placeRoots(sample.stamp, T_fixed_roots)) return "no_transform";
    if (!joints_.at(sample.stamp, positions_)) return "no_joint_states";
    kinematics_.update(positions_, roots_);
    sample.body = body_;
    for (std::size_t k = 0; k < used_.shapes.size(); ++k) {
      sample.body.poses[k] = kinematics_.shapePoses()[used_.shapes[k]];
    }
  }
  growBySpeed();
  return {};
}

/// By that on the way to each sample, and to the second at the first.
void BodySampler::growBySpeed() {
  for (std::size_t i = 1; i < samples_.size(); ++i) {
    const BodySample& before = samples_[i - 1];
    BodySample& sample = samples_[i];
    const double late = config_.lateness_s / toSeconds(sample.stamp - before.stamp);
    for (std::size_t k = 0; k < radii_m_.size(); ++k) {
      const double moved = displacement(before.body.poses[k], sample.body.poses[k], radii_m_[k]);
      sample.body.paddings_m[k] = body_.paddings_m[k] + std::min(late * moved, kGrowthMax);
    }
  }
  if (samples_.size() > 1) samples_.front().body.paddings_m = samples_[1].body.paddings_m;
}

}  // namespace tccm
