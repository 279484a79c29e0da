#include "check/way_check.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "check/nearest_cuboid.h"
#include "geometry/distance.h"
#include "geometry/overlap.h"

namespace tccm {
namespace {

constexpr std::size_t kDepthMax = 24;  // halvings; a way of a kilometre in steps of 0.1 mm
constexpr int kSpeedSamples = 4;
constexpr double kTouching = 1e-6;  // [m] that count as nothing

}  // namespace

WayCheck::WayCheck(std::shared_ptr<const CheckedRobot> robot, double step_m, double margin_max_m)
    : robot_(std::move(robot)),
      body_(robot_->collisionBody()),
      grown_(body_),
      margin_max_m_(margin_max_m),
      margins_m_(body_.shapes.size(), 0.0),
      speeds_mps_(body_.shapes.size(), 0.0),
      skipped_(body_.shapes.size(), false),
      kinematics_(robot_->sharedModel()),
      bound_(robot_->model(), body_.shapes, body_.radii(margin_max_m)),
      reach_max_m_(0.5 * step_m),
      stretches_(kDepthMax + 1),
      known_(body_.shapes.size()) {
  const std::size_t variables = robot_->model().variables().size();
  for (Known& known : known_) known.travel.resize(variables);
  since_known_.resize(variables);
  for (Stretch& stretch : stretches_) {
    stretch.shapes.reserve(body_.shapes.size());
    for (auto* values : {&stretch.travel_from, &stretch.travel_middle, &stretch.travel_to,
                         &stretch.travel, &stretch.positions}) {
      values->resize(variables);
    }
  }
}

void WayCheck::clearMargins() {
  std::fill(margins_m_.begin(), margins_m_.end(), 0.0);
  growBodies();
}

void WayCheck::skip(const std::vector<Contact>& contacts) {
  std::fill(skipped_.begin(), skipped_.end(), false);
  for (const Contact& contact : contacts) {
    const auto used = std::find(body_.shapes.begin(), body_.shapes.end(), contact.shape);
    if (used != body_.shapes.end()) {
      skipped_[static_cast<std::size_t>(used - body_.shapes.begin())] = true;
    }
  }
}

void WayCheck::setMargins(const JointPath& path, double from_s, double to_s,
                          const std::vector<Pose>& T_fixed_roots, double per_speed_s) {
  std::fill(speeds_mps_.begin(), speeds_mps_.end(), 0.0);
  const double step_s = (to_s - from_s) / kSpeedSamples;
  std::vector<double>& positions = stretches_.front().positions;
  for (int k = 0; step_s > 0.0 && k <= kSpeedSamples; ++k) {
    path.positionsAt(from_s + k * step_s, positions);
    kinematics_.update(positions, T_fixed_roots);
    for (std::size_t i = 0; i < body_.shapes.size(); ++i) {
      const Pose& pose = kinematics_.shapePoses()[body_.shapes[i]];
      if (k > 0) {
        const double moved =
            displacement(body_.body.poses[i], pose, boundingRadius(body_.body.shapes[i]));
        speeds_mps_[i] = std::max(speeds_mps_[i], moved / step_s);
      }
      body_.body.poses[i] = pose;
    }
  }
  for (std::size_t i = 0; i < margins_m_.size(); ++i) {
    margins_m_[i] = std::min(per_speed_s * speeds_mps_[i], margin_max_m_);
  }
  growBodies();
}

void WayCheck::growBodies() {
  for (std::size_t i = 0; i < margins_m_.size(); ++i) {
    grown_.body.shapes[i] = expanded(body_.body.shapes[i], {1.0, margins_m_[i]});
  }
}

void WayCheck::place(const Way& way, double time_s, std::vector<double>& positions) {
  way.path.positionsAt(time_s, positions);
  grown_.place(kinematics_.update(positions, way.T_fixed_roots));
  ++poses_;
}

double WayCheck::reach(std::uint32_t shape, const std::vector<double>& from,
                       const std::vector<double>& middle, const std::vector<double>& to,
                       std::vector<double>& travel) const {
  for (std::size_t v = 0; v < travel.size(); ++v) {
    travel[v] = std::max(middle[v] - from[v], to[v] - middle[v]);
  }
  return bound_.displacement(shape, travel);
}

double WayCheck::knownClearance(std::uint32_t shape, const std::vector<double>& travel) {
  const Known& known = known_[shape];
  for (std::size_t v = 0; v < travel.size(); ++v) {
    since_known_[v] = std::abs(travel[v] - known.travel[v]);
  }
  return known.clearance_m - bound_.displacement(shape, since_known_);
}

std::optional<Contact> WayCheck::touching(const Way& way, std::uint32_t shape,
                                          const std::vector<double>& travel) {
  if (knownClearance(shape, travel) > 0.0) return std::nullopt;
  const auto cuboid = robot_->collision().first(way.map, grown_.body.shapes[shape],
                                                grown_.body.poses[shape], shape);
  if (!cuboid) return std::nullopt;
  return Contact{shape, *cuboid};
}

bool WayCheck::comesNear(const Way& way, std::uint32_t shape, const std::vector<double>& travel,
                         double metres) {
  Known& known = known_[shape];
  const Shape& solid = grown_.body.shapes[shape];
  const Pose& pose = grown_.body.poses[shape];
  if (known.nearest) {
    const UprightBox box = way.map.box(way.map.cuboids[*known.nearest]);
    if (overlaps(expanded(solid, {1.0, metres}), pose, box)) return true;
  }
  NearestCuboidSearch search(way.map, solid, pose, metres + kTouching);
  const auto found = search.find(
      [&](const Cuboid& cuboid) { return robot_->collision().hasSupport(way.map, cuboid); });
  known.clearance_m = found ? found->distance_m : metres + kTouching;
  known.travel = travel;
  if (found) known.nearest = found->cuboid;
  return found.has_value();
}

std::optional<WayCheck::Found> WayCheck::at(const Way& way, double time_s) {
  std::vector<double>& travel = stretches_.front().travel;
  place(way, time_s, stretches_.front().positions);
  way.path.travelUntil(time_s, travel);
  for (std::uint32_t shape = 0; shape < grown_.shapes.size(); ++shape) {
    if (skipped_[shape]) continue;
    if (const auto contact = touching(way, shape, travel)) return Found{time_s, *contact};
  }
  return std::nullopt;
}

/// @pre stretches_[depth].shapes are those to look at.
std::optional<WayCheck::Found> WayCheck::search(const Way& way, double from_s, double to_s,
                                                std::size_t depth) {
  Stretch& stretch = stretches_[depth];
  const double middle_s = 0.5 * (from_s + to_s);
  place(way, middle_s, stretch.positions);
  way.path.travelUntil(from_s, stretch.travel_from);
  way.path.travelUntil(middle_s, stretch.travel_middle);
  way.path.travelUntil(to_s, stretch.travel_to);
  double furthest = 0.0;
  std::optional<Found> found;
  std::size_t near = 0;
  for (const std::uint32_t shape : stretch.shapes) {
    const double moved =
        reach(shape, stretch.travel_from, stretch.travel_middle, stretch.travel_to, stretch.travel);
    if (knownClearance(shape, stretch.travel_middle) > moved) continue;
    if (!comesNear(way, shape, stretch.travel_middle, moved)) continue;
    const bool is_jump = depth == kDepthMax && moved > reach_max_m_;
    std::optional<std::uint32_t> swept_cuboid;
    if (robot_->collision().exemptsAny() || is_jump) {
      const Shape swept = expanded(grown_.body.shapes[shape], {1.0, moved});
      swept_cuboid = robot_->collision().first(way.map, swept, grown_.body.poses[shape], shape);
      if (!swept_cuboid) continue;
    }
    stretch.shapes[near++] = shape;
    furthest = std::max(furthest, moved);
    if (found) continue;
    if (const auto contact = touching(way, shape, stretch.travel_middle)) {
      found = Found{middle_s, *contact};
    } else if (is_jump) {
      found = Found{middle_s, {shape, *swept_cuboid}};  // a jump: nothing shows that it is free
    }
  }
  stretch.shapes.resize(near);
  if (near == 0) return std::nullopt;
  if (furthest <= reach_max_m_ || depth == kDepthMax) return found;
  stretches_[depth + 1].shapes = stretch.shapes;
  if (const auto earlier = search(way, from_s, middle_s, depth + 1)) return earlier;
  if (found) return found;
  stretches_[depth + 1].shapes = stretch.shapes;
  return search(way, middle_s, to_s, depth + 1);
}

std::optional<WayContact> WayCheck::firstContact(const CuboidMap& map, const JointPath& path,
                                                 double from_s, double to_s,
                                                 const std::vector<Pose>& T_fixed_roots,
                                                 bool look_at_begin) {
  const Way way{map, path, T_fixed_roots};
  poses_ = 0;
  for (Known& known : known_) {
    known.clearance_m = 0.0;
    known.nearest.reset();
  }
  std::optional<Found> found;
  if (look_at_begin) found = at(way, from_s);
  if (!found && to_s > from_s) {
    auto& shapes = stretches_.front().shapes;
    shapes.clear();
    for (std::uint32_t i = 0; i < grown_.shapes.size(); ++i) {
      if (!skipped_[i]) shapes.push_back(i);
    }
    found = search(way, from_s, to_s, 0);
    if (!found) found = at(way, to_s);
  }
  if (!found) return std::nullopt;
  WayContact contact;
  contact.time_s = found->time_s - from_s;
  contact.link_speed_mps = speeds_mps_[found->contact.shape];
  place(way, from_s, stretches_.front().positions);
  contact.distance_m =
      distance(grown_.body.shapes[found->contact.shape], grown_.body.poses[found->contact.shape],
               map.box(map.cuboids[found->contact.cuboid]));
  contact.contact = {static_cast<std::uint32_t>(body_.shapes[found->contact.shape]),
                     found->contact.cuboid};
  return contact;
}

}  // namespace tccm
