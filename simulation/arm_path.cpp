#include "simulation/arm_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>

#include "simulation/robot/dual_arm.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

using Joints = std::vector<double>;
using Twist = Eigen::Matrix<double, 6, 1>;
using Model = std::shared_ptr<const RobotModel>;

/// Translation [m] and rotation [rad] that lead from one pose to another, in the root's frame.
Twist difference(const Pose& from, const Pose& to) {
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(to.linear() * from.linear().transpose()));
  Twist twist;
  twist << to.translation() - from.translation(), turn.angle() * turn.axis();
  return twist;
}

class Solver {
 public:
  Solver(const Model& model, const InverseProblem& problem)
      : model_(model), problem_(problem), kinematics_(model) {}

  [[nodiscard]] Twist error(const Joints& joints) {
    return difference(poseOf(joints), problem_.T_root_link);
  }

  void improve(Joints& joints) {
    constexpr double kDamping = 1e-3;
    const Twist residual = error(joints);
    const Eigen::MatrixXd jacobian = jacobianAt(joints);
    const Eigen::MatrixXd normal =
        jacobian * jacobian.transpose() + kDamping * Eigen::MatrixXd::Identity(6, 6);
    const Eigen::VectorXd step = jacobian.transpose() * normal.ldlt().solve(residual);
    for (std::size_t i = 0; i < problem_.variables.size(); ++i) {
      const JointVariable& variable = model_->variables()[problem_.variables[i]];
      double& joint = joints[problem_.variables[i]];
      joint = std::clamp(joint + step[static_cast<Eigen::Index>(i)], variable.lower.value_or(-1e9),
                         variable.upper.value_or(1e9));
    }
  }

 private:
  [[nodiscard]] Pose poseOf(const Joints& joints) {
    kinematics_.update(joints, {Pose::Identity()});
    return kinematics_.linkPoses()[problem_.link];
  }

  [[nodiscard]] Eigen::MatrixXd jacobianAt(Joints joints) {
    constexpr double kStep = 1e-6;
    const Pose here = poseOf(joints);
    Eigen::MatrixXd jacobian(6, static_cast<Eigen::Index>(problem_.variables.size()));
    for (std::size_t i = 0; i < problem_.variables.size(); ++i) {
      const double before = joints[problem_.variables[i]];
      joints[problem_.variables[i]] = before + kStep;
      jacobian.col(static_cast<Eigen::Index>(i)) = difference(here, poseOf(joints)) / kStep;
      joints[problem_.variables[i]] = before;
    }
    return jacobian;
  }

  Model model_;
  InverseProblem problem_;
  Kinematics kinematics_;
};

const std::array<const char*, 7> kArmJoints = {"shoulder_pitch", "shoulder_roll", "shoulder_yaw",
                                               "elbow",          "wrist_yaw",     "wrist_pitch",
                                               "wrist_roll"};

std::vector<std::size_t> armVariables(const RobotModel& model, const std::string& side) {
  std::vector<std::size_t> variables;
  for (const char* joint : kArmJoints) {
    variables.push_back(variableIndex(model, side + "_" + joint + "_joint"));
  }
  return variables;
}

void setArm(const RobotModel& model, const std::string& side, const std::array<double, 7>& arm,
            Joints& joints) {
  const std::vector<std::size_t> variables = armVariables(model, side);
  for (std::size_t i = 0; i < arm.size(); ++i) joints[variables[i]] = arm[i];
}

/// The left arm hangs beside the body, the right one is bent to begin a reach.
Joints restingJoints(const RobotModel& model) {
  Joints joints(model.variables().size(), 0.0);
  setArm(model, "left", {0.15, 0.15, 0.0, -0.4, 0.0, 0.0, 0.0}, joints);
  setArm(model, "right", {0.6, -0.15, 0.0, -2.2, 0.0, 0.0, 0.0}, joints);
  return joints;
}

ArmPath reachPath(const Model& model) {
  return reachVia(model, {Vector3(0.24, -0.27, 0.95), Vector3(0.70, -0.22, 0.92)});
}

ArmPath wavePath(const Model& model) {
  constexpr int kSteps = 20;
  const std::array<double, 7> out = {-0.5, 0.35, 0.45, -1.65, 0.0, 0.0, 0.0};
  const std::array<double, 7> in = {-0.6, 0.25, -0.35, -1.60, 0.0, 0.2, 0.0};
  const std::array<double, 7> mirror = {1.0, -1.0, -1.0, 1.0, -1.0, 1.0, -1.0};
  std::vector<Joints> knots;
  for (int i = 0; i <= kSteps; ++i) {
    const double u = static_cast<double>(i) / kSteps;
    std::array<double, 7> left;
    std::array<double, 7> right;
    for (std::size_t j = 0; j < left.size(); ++j) {
      left[j] = (1.0 - u) * out[j] + u * in[j];
      right[j] = mirror[j] * left[j];
    }
    Joints joints = restingJoints(*model);
    setArm(*model, "left", left, joints);
    setArm(*model, "right", right, joints);
    knots.push_back(joints);
  }
  return ArmPath(model, knots);
}

const std::map<std::string, ArmPath (*)(const Model&)>& motions() {
  static const std::map<std::string, ArmPath (*)(const Model&)> known = {{"reach", reachPath},
                                                                         {"wave", wavePath}};
  return known;
}

std::array<Vector3, 2> palms(const RobotModel& model, Kinematics& kinematics,
                             const Joints& joints) {
  kinematics.update(joints, {Pose::Identity()});
  return {kinematics.linkPoses()[linkIndex(model, "left_palm_link")].translation(),
          kinematics.linkPoses()[linkIndex(model, "right_palm_link")].translation()};
}

}  // namespace

ArmPath::ArmPath(const Model& model, std::vector<Joints> knots)
    : knots_(std::move(knots)), arc_{0.0} {
  Kinematics kinematics(model);
  for (std::size_t i = 1; i < knots_.size(); ++i) {
    const auto before = palms(*model, kinematics, knots_[i - 1]);
    const auto after = palms(*model, kinematics, knots_[i]);
    arc_.push_back(arc_.back() +
                   std::max((after[0] - before[0]).norm(), (after[1] - before[1]).norm()));
  }
  for (std::size_t i = 0; i < knots_.size(); ++i) {
    const std::size_t before = i == 0 ? 0 : i - 1;
    const std::size_t after = std::min(i + 1, knots_.size() - 1);
    Joints tangent(knots_[i].size());
    for (std::size_t j = 0; j < tangent.size(); ++j) {
      tangent[j] = (knots_[after][j] - knots_[before][j]) / (arc_[after] - arc_[before]);
    }
    tangents_.push_back(tangent);
  }
}

ArmPath::Segment ArmPath::segmentAt(double s) const {
  const double clamped = std::clamp(s, 0.0, length());
  const auto above = std::upper_bound(arc_.begin() + 1, arc_.end() - 1, clamped);
  const auto first = static_cast<std::size_t>(above - arc_.begin()) - 1;
  const double segment_length = arc_[first + 1] - arc_[first];
  return {first, segment_length, (clamped - arc_[first]) / segment_length};
}

/// Cubic Hermite curve between the knots.
Joints ArmPath::positions(double s) const {
  const auto [first, segment_length, u] = segmentAt(s);
  const double h01 = u * u * (3.0 - 2.0 * u);
  const double h10 = u * (1.0 - u) * (1.0 - u) * segment_length;
  const double h11 = u * u * (u - 1.0) * segment_length;
  Joints result(knots_[first].size());
  for (std::size_t j = 0; j < result.size(); ++j) {
    result[j] = (1.0 - h01) * knots_[first][j] + h01 * knots_[first + 1][j] +
                h10 * tangents_[first][j] + h11 * tangents_[first + 1][j];
  }
  return result;
}

Joints ArmPath::slopes(double s) const {
  const auto [first, segment_length, u] = segmentAt(s);
  const double d01 = 6.0 * u * (1.0 - u) / segment_length;
  const double d10 = (1.0 - u) * (1.0 - 3.0 * u);
  const double d11 = u * (3.0 * u - 2.0);
  Joints result(knots_[first].size());
  for (std::size_t j = 0; j < result.size(); ++j) {
    result[j] = d01 * (knots_[first + 1][j] - knots_[first][j]) + d10 * tangents_[first][j] +
                d11 * tangents_[first + 1][j];
  }
  return result;
}

std::vector<std::string> motionNames() {
  std::vector<std::string> names;
  for (const auto& [name, make] : motions()) names.push_back(name);
  return names;
}

ArmPath armPath(const Model& model, const std::string& name) {
  const auto found = motions().find(name);
  if (found == motions().end()) throw ConfigError("motion: " + name + " is none of reach, wave");
  return found->second(model);
}

Pose reachingPalm(const Vector3& position) {
  constexpr double kDown = 0.15;  // [rad] below the horizontal
  Pose pose = Pose::Identity();
  pose.translation() = position;
  pose.rotate(Eigen::AngleAxisd(-M_PI_2 + kDown, Vector3::UnitY()));
  return pose;
}

ArmPath reachVia(const Model& model, const std::vector<Vector3>& places) {
  constexpr double kSpacing = 0.0117;  // [m] of the knots, at most
  InverseProblem problem{linkIndex(*model, "right_palm_link"), Pose::Identity(),
                         armVariables(*model, "right")};
  std::vector<Joints> knots;
  Joints joints = restingJoints(*model);
  for (std::size_t i = 1; i < places.size(); ++i) {
    const Vector3 way = places[i] - places[i - 1];
    const int steps = std::max(1, static_cast<int>(std::ceil(way.norm() / kSpacing)));
    for (int k = i == 1 ? 0 : 1; k <= steps; ++k) {
      const double u = static_cast<double>(k) / steps;
      problem.T_root_link = reachingPalm((1.0 - u) * places[i - 1] + u * places[i]);
      joints = solve(model, problem, joints);
      knots.push_back(joints);
    }
  }
  return ArmPath(model, knots);
}

Joints solve(const Model& model, const InverseProblem& problem, Joints seed) {
  constexpr int kAttempts = 300;
  constexpr double kTolerance = 1e-4;
  Solver solver(model, problem);
  for (int i = 0; i < kAttempts; ++i) {
    if (solver.error(seed).norm() < kTolerance) return seed;
    solver.improve(seed);
  }
  throw std::runtime_error("no joint positions bring " + model->links()[problem.link] + " there");
}

}  // namespace tccm::simulation
