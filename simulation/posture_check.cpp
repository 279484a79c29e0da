#include "simulation/posture_check.h"

#include <algorithm>
#include <string>

#include "simulation/clearance.h"

namespace tccm::simulation {
namespace {

bool startsWith(const std::string& text, const std::string& start) {
  return text.compare(0, start.size(), start) == 0;
}

}  // namespace

PostureCheck::PostureCheck(const std::shared_ptr<const RobotModel>& model, const World& world,
                           double clearance_m)
    : kinematics_(model), clearance_m_(clearance_m) {
  constexpr double kSpacing = 0.03;  // [m]
  for (const LinkShape& shape : model->shapes()) {
    body_.push_back(
        {shape.shape, {}, boundingRadius(shape.shape), partOf(model->links()[shape.link])});
    if (body_.back().part != Part::kTrunk) {
      body_.back().points = surfacePoints(shape.shape, kSpacing);
    }
  }
  for (const SceneObject& object : world) {
    if (object.name == "floor") continue;
    scene_.push_back({object.shape, object.T_fixed_shape.inverse()});
  }
}

bool PostureCheck::passes(const std::vector<double>& joints) {
  kinematics_.update(joints, {Pose::Identity()});
  for (std::size_t i = 0; i < body_.size(); ++i) {
    if (body_[i].part == Part::kTrunk) continue;
    for (const Obstacle& obstacle : scene_) {
      if (nearer(i, obstacle.shape, obstacle.T_shape_fixed, clearance_m_)) return false;
    }
    if (meetsItself(i)) return false;
  }
  return true;
}

bool PostureCheck::passesAround(const std::vector<double>& joints, const std::vector<double>& rates,
                                double horizon_s) {
  constexpr int kLooksAhead = 4;
  if (!passes(joints)) return false;
  // The furthest first: they fail most.
  for (int i = kLooksAhead; i > 0; --i) {
    const double later_s = horizon_s * i / kLooksAhead;
    if (!passesLater(joints, rates, later_s) || !passesLater(joints, rates, -later_s)) return false;
  }
  return true;
}

bool PostureCheck::passesLater(std::vector<double> joints, const std::vector<double>& rates,
                               double seconds) {
  for (std::size_t j = 0; j < joints.size(); ++j) joints[j] += seconds * rates[j];
  return passes(joints);
}

PostureCheck::Part PostureCheck::partOf(const std::string& link) {
  const bool upper = link.find("shoulder") != std::string::npos;
  if (startsWith(link, "left_")) return upper ? Part::kLeftUpperArm : Part::kLeftForearm;
  if (startsWith(link, "right_")) return upper ? Part::kRightUpperArm : Part::kRightForearm;
  return Part::kTrunk;
}

/// Whether body shape i comes nearer to another shape than that.
bool PostureCheck::nearer(std::size_t i, const Shape& other, const Pose& T_other_fixed,
                          double least) const {
  const Pose T_other_shape = T_other_fixed * kinematics_.shapePoses()[i];
  if (distance(other, T_other_shape.translation()) > body_[i].radius + least) return false;
  return std::any_of(body_[i].points.begin(), body_[i].points.end(),
                     [&](const Vector3& p) { return distance(other, T_other_shape * p) < least; });
}

/// A forearm with its hand may come near neither to the trunk nor to the other arm.
bool PostureCheck::meetsItself(std::size_t i) const {
  constexpr double kApart = 0.04;  // [m]
  const Part part = body_[i].part;
  if (part != Part::kLeftForearm && part != Part::kRightForearm) return false;
  const Part own_upper = part == Part::kLeftForearm ? Part::kLeftUpperArm : Part::kRightUpperArm;
  for (std::size_t j = 0; j < body_.size(); ++j) {
    if (body_[j].part == part || body_[j].part == own_upper) continue;
    if (nearer(i, body_[j].shape, kinematics_.shapePoses()[j].inverse(), kApart)) return true;
  }
  return false;
}

}  // namespace tccm::simulation
