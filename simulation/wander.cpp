#include "simulation/wander.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>

#include "simulation/posture_check.h"
#include "simulation/robot/dual_arm.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

using Joints = std::vector<double>;
using Model = std::shared_ptr<const RobotModel>;

struct JointRange {
  const char* joint;
  double lower;  ///< of the left arm [rad]
  double upper;
  double mirror;  ///< what the right arm's position is multiplied by
};
constexpr std::array<JointRange, 7> kRanges = {{{"shoulder_pitch", -1.3, 0.5, 1.0},
                                                {"shoulder_roll", -0.1, 1.0, -1.0},
                                                {"shoulder_yaw", -1.0, 1.0, -1.0},
                                                {"elbow", -2.0, -0.1, 1.0},
                                                {"wrist_yaw", -1.5, 1.5, -1.0},
                                                {"wrist_pitch", -1.0, 1.0, 1.0},
                                                {"wrist_roll", -1.0, 1.0, -1.0}}};

bool startsWith(const std::string& text, const std::string& start) {
  return text.compare(0, start.size(), start) == 0;
}

Joints randomPosture(const RobotModel& model, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform;
  Joints joints(model.variables().size(), 0.0);
  for (const JointRange& range : kRanges) {
    for (const bool left : {true, false}) {
      const std::string name = (left ? "left_" : "right_") + std::string(range.joint) + "_joint";
      const double position = range.lower + uniform(random) * (range.upper - range.lower);
      joints[variableIndex(model, name)] = left ? position : range.mirror * position;
    }
  }
  return joints;
}

/// Weights of four control points of a uniform cubic B-spline at u in 0..1.
std::array<double, 4> splineWeights(double u) {
  const double v = 1.0 - u;
  return {v * v * v / 6.0, (3.0 * u * u * u - 6.0 * u * u + 4.0) / 6.0,
          (3.0 * v * v * v - 6.0 * v * v + 4.0) / 6.0, u * u * u / 6.0};
}

/// Strings together B-spline segments that pass the check, and goes back where it is stuck.
class Wanderer {
 public:
  Wanderer(const Model& model, const World& world, const WanderConfig& config)
      : model_(model),
        config_(config),
        check_(model, world, config.clearance_m),
        kinematics_(model),
        palms_{linkIndex(*model, "left_palm_link"), linkIndex(*model, "right_palm_link")},
        random_(config.seed) {}

  /// @throws ConfigError
  [[nodiscard]] std::vector<Joints> knots() {
    constexpr int kAttempts = 1000000;
    constexpr int kPatience = 100;
    int failures = 0;
    for (int i = 0; i < kAttempts && length() < config_.length_m; ++i) {
      failures = tryNext() ? 0 : failures + 1;
      if (failures < kPatience) continue;
      goBack();
      failures = 0;
    }
    if (length() < config_.length_m) {
      throw ConfigError("wander_clearance_m: no way through the scene keeps a clearance of " +
                        std::to_string(config_.clearance_m) + " m");
    }
    std::vector<Joints> result;
    for (const Segment& segment : segments_) {
      result.insert(result.end(), segment.postures.begin(), segment.postures.end());
    }
    return result;
  }

 private:
  struct Segment {
    std::vector<Joints> postures;
    double length;  ///< [m]
  };

  [[nodiscard]] double length() const {
    double sum = 0.0;
    for (const Segment& segment : segments_) sum += segment.length;
    return sum;
  }

  [[nodiscard]] bool tryNext() {
    const Joints candidate = nextControl();
    if (!check_.passes(candidate)) return false;
    controls_.push_back(candidate);
    if (controls_.size() < 4) return true;
    const std::optional<Segment> segment = lastSegment();
    if (segment) {
      segments_.push_back(*segment);
    } else {
      controls_.pop_back();
    }
    return segment.has_value();
  }

  /// Some regions have no way out: where it does not get further for long, it starts anew.
  void goBack() {
    constexpr std::size_t kBack = 3;
    constexpr int kPatience = 40;
    steps_back_ = segments_.size() > most_segments_ ? 0 : steps_back_ + 1;
    most_segments_ = std::max(most_segments_, segments_.size());
    if (steps_back_ == kPatience) {
      controls_.clear();
      most_segments_ = 0;
      steps_back_ = 0;
    }
    controls_.resize(controls_.size() - std::min(kBack, controls_.size()));
    segments_.resize(controls_.size() - std::min(kBack, controls_.size()));
  }

  /// Part of the way from the last control to a random posture; now and then an arm stays.
  [[nodiscard]] Joints nextControl() {
    const Joints goal = randomPosture(*model_, random_);
    if (controls_.empty()) return goal;
    const double share = 0.3 + 0.5 * uniform_(random_);
    const double stays = uniform_(random_);
    Joints joints = controls_.back();
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const bool left = startsWith(model_->variables()[j].name, "left_");
      const bool stay = left ? stays < 0.15 : stays > 0.85;
      if (!stay) joints[j] += share * (goal[j] - joints[j]);
    }
    return joints;
  }

  [[nodiscard]] Joints splineAt(double u) const {
    const std::array<double, 4> weights = splineWeights(u);
    Joints joints(model_->variables().size(), 0.0);
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const Joints& control = controls_[controls_.size() - weights.size() + i];
      for (std::size_t j = 0; j < joints.size(); ++j) joints[j] += weights[i] * control[j];
    }
    return joints;
  }

  /// Of the newest four controls; nothing where it fails the check.
  [[nodiscard]] std::optional<Segment> lastSegment() {
    constexpr int kSteps = 16;
    Segment segment{{}, 0.0};
    for (int i = 0; i < kSteps; ++i) {
      const Joints here = splineAt(static_cast<double>(i) / kSteps);
      const Joints next = splineAt(static_cast<double>(i + 1) / kSteps);
      const double travel = palmTravel(here, next);
      if (!passes(here, next, travel)) return std::nullopt;
      segment.postures.push_back(here);
      segment.length += travel;
    }
    return segment;
  }

  [[nodiscard]] double palmTravel(const Joints& from, const Joints& to) {
    kinematics_.update(from, {Pose::Identity()});
    const std::array<Vector3, 2> before = palms();
    kinematics_.update(to, {Pose::Identity()});
    const std::array<Vector3, 2> after = palms();
    return std::max((after[0] - before[0]).norm(), (after[1] - before[1]).norm());
  }

  [[nodiscard]] std::array<Vector3, 2> palms() const {
    return {kinematics_.linkPoses()[palms_[0]].translation(),
            kinematics_.linkPoses()[palms_[1]].translation()};
  }

  [[nodiscard]] bool passes(const Joints& here, const Joints& next, double travel) {
    constexpr double kRateMax = 2.5;     // [rad/s]
    constexpr double kTravelMin = 1e-3;  // [m]; slower palms would let the other joints race
    if (travel < kTravelMin) return false;
    Joints rates(here.size());
    for (std::size_t j = 0; j < here.size(); ++j) {
      rates[j] = (next[j] - here[j]) / travel * config_.speed_mps;
      if (std::abs(rates[j]) > kRateMax) return false;
    }
    return check_.passesAround(here, rates, config_.horizon_s);
  }

  Model model_;
  WanderConfig config_;
  PostureCheck check_;
  Kinematics kinematics_;
  std::array<std::size_t, 2> palms_;
  std::mt19937_64 random_;
  std::uniform_real_distribution<double> uniform_;
  std::vector<Joints> controls_;
  std::vector<Segment> segments_;  ///< three fewer than controls
  std::size_t most_segments_ = 0;  ///< since the start, or since it started anew
  int steps_back_ = 0;             ///< without more segments
};

}  // namespace

std::vector<double> freePosture(const Model& model, const World& world, double clearance_m,
                                std::mt19937_64& random) {
  constexpr int kAttempts = 100000;
  PostureCheck check(model, world, clearance_m);
  for (int i = 0; i < kAttempts; ++i) {
    const Joints joints = randomPosture(*model, random);
    if (check.passes(joints)) return joints;
  }
  throw ConfigError("clearance_m: no posture keeps a clearance of " + std::to_string(clearance_m) +
                    " m");
}

ArmPath wanderPath(const Model& model, const World& world, const WanderConfig& config) {
  return ArmPath(model, Wanderer(model, world, config).knots());
}

}  // namespace tccm::simulation
