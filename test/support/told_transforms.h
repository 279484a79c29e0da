#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "check/model_agreement.h"
#include "robot/kinematics.h"
#include "support/random.h"

namespace tccm::test {

/// How a robot tells where it is: rates, delays, and what it gets wrong.
struct Telling {
  double joints_hz = 100.0;
  double tf_hz = 50.0;
  double joints_late_s = 0.0;  ///< from the instant to when it is heard
  double tf_late_s = 0.0;
  double tf_dated_s = 0.0;  ///< stamps of transforms lead the instant by this
  double jitter_s = 0.0;    ///< of stamps, of either
  double rounding = 0.0;    ///< [rad or m] of joint states, and of transforms' numbers
  double speed = 0.3;       ///< [rad/s] at most, of each joint that moves
  /// What transforms say instead of the truth, of T_root_link.
  std::function<Pose(const std::string& link, const Posture&, const Pose&)> lie = {};
  /// Joint positions that transforms follow from, where these are not those that are published.
  std::function<void(std::vector<double>&)> other_joints = {};
};

/// A robot whose joints swing, heard of through a ModelAgreement. Its root is its first link.
class ToldRobot {
 public:
  ToldRobot(std::shared_ptr<const RobotModel> model, Telling telling, unsigned seed)
      : model_(std::move(model)), telling_(std::move(telling)), random_(seed), kinematics_(model_) {
    const std::vector<JointVariable>& variables = model_->variables();
    for (const JointVariable& variable : variables) {
      names_.push_back(variable.name);
      const double lower = std::max(-1.0, variable.lower.value_or(-1.0));
      const double upper = std::min(1.0, variable.upper.value_or(1.0));
      middle_.push_back(random_.uniform(0.7 * lower + 0.3 * upper, 0.3 * lower + 0.7 * upper));
      swing_.push_back(random_.chance(0.3) ? 0.25 * (upper - lower) : 0.0);
      phase_.push_back(random_.uniform(-3.0, 3.0));
    }
  }

  /// Until the agreement has heard of it for so long, and was asked 50 times a second.
  void tell(ModelAgreement& agreement, double seconds) {
    const double end = now_ + seconds;
    for (; now_ < end; now_ += 0.002) {
      if (now_ >= next_joints_) tellJoints(agreement);
      if (now_ >= next_transforms_) tellTransforms();
      if (now_ < next_comparison_) continue;
      next_comparison_ = now_ + 0.02;
      agreement.compare(at(now_), transforms());
    }
  }

  [[nodiscard]] static Time at(double seconds) { return Time(fromSeconds(seconds)); }
  [[nodiscard]] double now() const { return now_; }
  [[nodiscard]] Telling& telling() { return telling_; }

  [[nodiscard]] std::vector<double> positionsAt(double seconds) const {
    std::vector<double> positions;
    for (std::size_t v = 0; v < names_.size(); ++v) {
      const double rate = swing_[v] > 0.0 ? telling_.speed / swing_[v] : 0.0;
      positions.push_back(middle_[v] + swing_[v] * std::sin(rate * seconds + phase_[v]));
    }
    return positions;
  }

  [[nodiscard]] ModelAgreement::Transforms transforms() {
    using Newest = ModelAgreement::Transforms::Newest;
    return {
        [this](const std::string& reference, const std::string& frame) -> std::optional<Newest> {
          const Heard* newest = nullptr;
          for (const Heard& heard : heard_) {
            if (heard.when <= now_) newest = &heard;
          }
          if (!newest || !has(*newest, reference) || !has(*newest, frame)) return std::nullopt;
          return Newest{newest->stamp, between(*newest, reference, frame), false};
        },
        [this](const std::string& reference, const std::string& frame,
               Time stamp) -> std::optional<Pose> {
          const Heard* before = nullptr;
          for (const Heard& heard : heard_) {
            if (heard.when > now_) continue;
            if (heard.stamp == stamp) return between(heard, reference, frame);
            if (heard.stamp < stamp) {
              before = &heard;
              continue;
            }
            if (!before) return std::nullopt;
            const double u =
                toSeconds(stamp - before->stamp) / toSeconds(heard.stamp - before->stamp);
            return Interpolation(between(*before, reference, frame),
                                 between(heard, reference, frame))
                .at(u);
          }
          return std::nullopt;
        }};
  }

 private:
  /// A message with the transforms of all links.
  struct Heard {
    double when;
    Time stamp;
    std::map<std::string, Pose> T_root_frames;
  };
  struct Joints {
    double when;
    Time stamp;
    std::vector<double> positions;
  };

  static bool has(const Heard& heard, const std::string& frame) {
    return heard.T_root_frames.count(frame) > 0;
  }
  static Pose between(const Heard& heard, const std::string& reference, const std::string& frame) {
    return heard.T_root_frames.at(reference).inverse() * heard.T_root_frames.at(frame);
  }
  double rounded(double value) const {
    return telling_.rounding > 0.0 ? telling_.rounding * std::round(value / telling_.rounding)
                                   : value;
  }
  Time stampOf(double seconds) {
    return at(seconds + random_.uniform(-telling_.jitter_s, telling_.jitter_s));
  }

  void tellJoints(ModelAgreement& agreement) {
    next_joints_ = now_ + 1.0 / telling_.joints_hz;
    Joints joints{now_ + telling_.joints_late_s, stampOf(now_), positionsAt(now_)};
    for (double& position : joints.positions) position = rounded(position);
    joints_.push_back(joints);
    while (!joints_.empty() && joints_.front().when <= now_) {
      agreement.addJoints(joints_.front().stamp, names_, joints_.front().positions);
      joints_.erase(joints_.begin());
    }
  }

  void tellTransforms() {
    next_transforms_ = now_ + 1.0 / telling_.tf_hz;
    std::vector<double> positions = positionsAt(now_);
    if (telling_.other_joints) telling_.other_joints(positions);
    const Posture& posture = kinematics_.update(positions, {Pose::Identity()});
    Heard heard{now_ + telling_.tf_late_s, stampOf(now_ + telling_.tf_dated_s), {}};
    for (std::size_t i = 0; i < model_->links().size(); ++i) {
      const std::string& link = model_->links()[i];
      Pose pose = posture.T_fixed_links[i];
      if (telling_.lie) pose = telling_.lie(link, posture, pose);
      Vector3 place = pose.translation();
      Eigen::Quaterniond q(pose.linear());
      for (int axis = 0; axis < 3; ++axis) place[axis] = rounded(place[axis]);
      for (int part = 0; part < 4; ++part) q.coeffs()[part] = rounded(q.coeffs()[part]);
      pose.linear() = q.normalized().toRotationMatrix();
      pose.translation() = place;
      heard.T_root_frames[model_->frameOf(link)] = pose;
    }
    const bool rises = heard_.empty() || heard.stamp > heard_.back().stamp;
    if (rises) heard_.push_back(std::move(heard));
    while (heard_.size() > 300) heard_.erase(heard_.begin());
  }

  std::shared_ptr<const RobotModel> model_;
  Telling telling_;
  Random random_;
  Kinematics kinematics_;
  std::vector<std::string> names_;
  std::vector<double> middle_, swing_, phase_;
  std::vector<Joints> joints_;
  std::vector<Heard> heard_;
  double now_ = 100.0, next_joints_ = 0.0, next_transforms_ = 0.0, next_comparison_ = 0.0;
};

}  // namespace tccm::test
