#include "experiments/hover_scene.h"

#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "experiments/draw.h"
#include "experiments/robot_part.h"
#include "simulation/clearance.h"
#include "simulation/robot/dual_arm.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

using Model = std::shared_ptr<const RobotModel>;

constexpr double kSpacing = 0.01;  // [m] between the points that clearances are measured from
const Eigen::Vector3f kBlue(0.25F, 0.45F, 0.80F);

/// Stands on the table, its axis at x, y.
struct Thing {
  World parts;
  Eigen::Vector2d axis;
};

Thing standing(const std::string& kind, Draw& draw) {
  const Eigen::Vector2d axis(draw.between(0.52, 0.68), draw.between(-0.38, -0.05));
  const auto part = [&](const Shape& shape, double middle_m) -> SceneObject {
    return {kind, shape, at(axis.x(), axis.y(), kTableTop + middle_m), kBlue};
  };
  if (kind == "box") {
    const Vector3 half(draw.between(0.03, 0.07), draw.between(0.03, 0.07), draw.between(0.04, 0.1));
    SceneObject box = part(Box{half}, half.z());
    box.T_fixed_shape.rotate(Eigen::AngleAxisd(draw.between(-0.8, 0.8), Vector3::UnitZ()));
    return {{box}, axis};
  }
  if (kind == "ball") {
    const double radius = draw.between(0.045, 0.07);
    return {{part(Sphere{radius}, radius)}, axis};
  }
  const double radius = draw.between(0.03, 0.045);
  const double half =
      0.5 * (kind == "bottle" ? draw.between(0.12, 0.18) : draw.between(0.08, 0.13));
  World parts = {part(Cylinder{radius, half}, half)};
  if (kind == "bottle") parts.push_back(part(Cylinder{0.014, 0.025}, 2.0 * half + 0.025));
  if (kind == "mug") {
    SceneObject handle = part(Box{0.5 * Vector3(0.012, 0.04, 0.06)}, half);
    handle.T_fixed_shape.translate(Vector3(0.0, radius + 0.015, 0.0));
    parts.push_back(handle);
  }
  return {parts, axis};
}

/// How far a hand high above a thing can go down until it is so near to it.
double wayDown(const SampledBody& hand, const SampledBody& thing, double gap) {
  double near = 0.0;
  double far = 1.0;
  while (far - near > 1e-5) {
    const double middle = 0.5 * (near + far);
    SampledBody lower = hand;
    lower.shift(Vector3(0.0, 0.0, -middle));
    (clearance(lower, thing) > gap ? near : far) = middle;
  }
  return near;
}

/// Where the palm goes.
struct Places {
  Vector3 hover, end;
  double touch_m;  ///< below hover
};

/// The hand's links, its palm at a place.
SampledBody handAt(const Model& model, const Vector3& place) {
  Kinematics kinematics(model);
  kinematics.update(std::vector<double>(model->variables().size(), 0.0), {Pose::Identity()});
  std::vector<Pose> links = kinematics.linkPoses();
  const Pose move = reachingPalm(place) * links[linkIndex(*model, "right_palm_link")].inverse();
  for (Pose& link : links) link = move * link;
  RobotPart hand(
      model,
      {"right_wrist_pitch_link", "right_wrist_roll_link", "right_palm_link", "right_*_finger_link"},
      kSpacing);
  hand.moveTo(links);
  return hand.body();
}

/// @param approach as in HoverScene.
Vector3 viaOf(const std::string& approach, const Vector3& hover) {
  if (approach == "above") return hover + Vector3(0.0, 0.0, 0.12);
  if (approach == "left") return hover + Vector3(0.0, 0.2, 0.0);
  if (approach == "right") return hover - Vector3(0.0, 0.2, 0.0);
  return hover - Vector3(0.2, 0.0, 0.0);
}

Places placesOver(const Model& model, const Thing& thing, double gap_m, Draw& draw) {
  constexpr double kInside = 0.015;  // [m] that the path leads into the thing
  const double along = draw.between(-0.01, 0.13);
  const double aside = draw.between(-0.03, 0.03);
  const Vector3 high(thing.axis.x() - along, thing.axis.y() + aside, 1.5);
  const SampledBody hand = handAt(model, high);
  const SampledBody body = SampledBody(bodyOf(thing.parts), kSpacing);
  const double down = wayDown(hand, body, gap_m);
  const double touch = wayDown(hand, body, 0.0) - down;
  const Vector3 hover = high - Vector3(0.0, 0.0, down);
  return {hover, hover - Vector3(0.0, 0.0, touch + kInside), touch};
}

/// Nothing where the arm cannot do it.
std::optional<HoverScene> drawn(const Model& model, const HoverRanges& ranges, Draw& draw) {
  static const std::array<const char*, 5> kObjects = {"box", "mug", "can", "ball", "bottle"};
  static const std::array<const char*, 4> kApproaches = {"above", "left", "right", "behind"};
  const std::string object = draw.of(kObjects);
  const std::string approach = draw.of(kApproaches);
  const double gap_m = draw.between(ranges.gap_min_m, ranges.gap_max_m);
  const double noise_m = draw.between(ranges.noise_min_m, ranges.noise_max_m);
  const double phase_rad = draw.between(0.0, 2.0 * M_PI);
  const Thing thing = standing(object, draw);
  const Places places = placesOver(model, thing, gap_m, draw);
  const Vector3 start(0.32, -0.45, places.hover.z());  // hides nothing of the thing
  const Vector3 via = viaOf(approach, places.hover);
  const double via_m = (via - start).norm();
  const double hover_m = via_m + (places.hover - via).norm();
  try {
    return HoverScene{object,
                      approach,
                      gap_m,
                      noise_m,
                      phase_rad,
                      thing.parts,
                      reachVia(model, {start, via, places.hover, places.end}),
                      via_m,
                      hover_m,
                      hover_m + places.touch_m};
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
}

}  // namespace

void HoverRanges::validate() const {
  requireInRange("gap_min_m", gap_min_m, 0.001, 0.3);
  requireInRange("gap_max_m", gap_max_m, gap_min_m, 0.3);
  requireInRange("noise_min_m", noise_min_m, 0.0, 0.1);
  requireInRange("noise_max_m", noise_max_m, noise_min_m, 0.1);
}

std::vector<std::string> hoveringLinks() {
  return {"right_elbow_link", "right_wrist_*_link", "right_palm_link", "right_*_finger_link"};
}

HoverScene hoverScene(const Model& model, const HoverRanges& ranges, std::uint64_t seed) {
  constexpr int kAttempts = 1000;
  ranges.validate();
  Draw draw(seed);
  for (int i = 0; i < kAttempts; ++i) {
    if (std::optional<HoverScene> scene = drawn(model, ranges, draw)) return *scene;
  }
  throw ConfigError("gap_max_m: no hand can hover so high over anything");
}

}  // namespace tccm::simulation
