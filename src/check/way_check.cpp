#include "check/way_check.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tccm {
namespace {

constexpr std::size_t kDepthMax = 24;     // halvings; a way of a kilometre in steps of 0.1 mm
constexpr std::size_t kWorkOfJoint = 20;  // in cuboids passed by: to place its link, or a shape
constexpr std::size_t kWorkOfShape = 30;  // what is asked of a shape beside its cuboids
constexpr double kTouching = 1e-6;        // [m] that count as nothing

}  // namespace

WayCheck::WayCheck(std::shared_ptr<const CheckedRobot> robot, double step_m)
    : robot_(std::move(robot)),
      body_(robot_->collision_body),
      kinematics_(robot_->model),
      bound_(*robot_->model, body_.shapes, body_.radii(0.0)),
      reach_max_m_(0.5 * step_m),
      near_(kDepthMax + 1),
      known_(body_.shapes.size()),
      left_(body_.shapes.size()),
      work_end_(std::numeric_limits<std::size_t>::max()) {
  const std::size_t variables = robot_->model->variables().size();
  for (auto& shapes : near_) shapes.reserve(body_.shapes.size());
  for (Known& known : known_) known.travel.resize(variables);
  for (auto* values : {&positions_, &travel_, &travel_from_, &travel_to_, &reach_, &since_known_}) {
    values->resize(variables);
  }
}

void WayCheck::allow(std::size_t work) {
  work_end_ = work_ + robot_->collision.work() + work;
  is_too_long_ = false;
}

void WayCheck::leave(const std::vector<Contact>& contacts) {
  leaves_any_ = !contacts.empty();
  for (std::size_t i = 0; i < left_.size(); ++i) {
    left_[i].clear();
    for (const Contact& contact : contacts) {
      if (contact.shape == body_.shapes[i]) left_[i].push_back(contact.cuboid);
    }
    std::sort(left_[i].begin(), left_[i].end());
  }
}

std::optional<std::uint32_t> WayCheck::first(const Way& way, const Shape& solid,
                                             std::uint32_t shape,
                                             const std::vector<Pose>* T_fixed_links) const {
  return robot_->collision.first(way.obstacles, solid, body_.body.poses[shape], shape,
                                 T_fixed_links, &left_[shape]);
}

bool WayCheck::isExhausted() {
  is_too_long_ = is_too_long_ || work_ + robot_->collision.work() >= work_end_;
  return is_too_long_;
}

void WayCheck::place(const Way& way, double time_s) {
  way.path.positionsAt(time_s, positions_);
  way.path.travelUntil(time_s, travel_);
  body_.place(kinematics_.update(positions_, way.T_fixed_roots));
  ++poses_;
  work_ += kWorkOfJoint * (robot_->model->joints().size() + robot_->model->shapes().size());
}

double WayCheck::knownClearance(std::uint32_t shape) {
  const Known& known = known_[shape];
  for (std::size_t v = 0; v < travel_.size(); ++v) {
    since_known_[v] = std::abs(travel_[v] - known.travel[v]);
  }
  return known.clearance_m - bound_.displacement(shape, since_known_);
}

std::optional<Contact> WayCheck::touching(const Way& way, std::uint32_t shape) {
  if (knownClearance(shape) > 0.0) return std::nullopt;
  const auto cuboid = first(way, body_.body.shapes[shape], shape, &kinematics_.linkPoses());
  if (!cuboid) return std::nullopt;
  return Contact{shape, *cuboid};
}

bool WayCheck::comesNear(const Way& way, std::uint32_t shape, double metres) {
  Known& known = known_[shape];
  const Shape& solid = body_.body.shapes[shape];
  const Pose& pose = body_.body.poses[shape];
  if (known.nearest &&
      way.obstacles.touches(*known.nearest, expanded(solid, {1.0, metres}), pose)) {
    return true;
  }
  const auto found =
      robot_->collision.nearest(way.obstacles, solid, pose, shape, metres + kTouching);
  known.clearance_m = found ? found->distance_m : metres + kTouching;
  known.travel = travel_;
  if (found) known.nearest = found->obstacle;
  return found.has_value();
}

std::optional<WayCheck::Found> WayCheck::at(const Way& way, double time_s) {
  place(way, time_s);
  for (std::uint32_t shape = 0; shape < body_.shapes.size(); ++shape) {
    if (const auto contact = touching(way, shape)) return Found{time_s, *contact};
  }
  return std::nullopt;
}

/// @pre near_[depth] are the shapes to look at.
std::optional<WayCheck::Found> WayCheck::search(const Way& way, double from_s, double to_s,
                                                std::size_t depth) {
  if (isExhausted()) return std::nullopt;
  std::vector<std::uint32_t>& shapes = near_[depth];
  work_ += kWorkOfShape * shapes.size();
  const double middle_s = 0.5 * (from_s + to_s);
  place(way, middle_s);
  way.path.travelUntil(from_s, travel_from_);
  way.path.travelUntil(to_s, travel_to_);
  for (std::size_t v = 0; v < reach_.size(); ++v) {
    reach_[v] = std::max(travel_[v] - travel_from_[v], travel_to_[v] - travel_[v]);
  }
  double furthest = 0.0;
  std::optional<Found> found;
  std::size_t near = 0;
  for (const std::uint32_t shape : shapes) {
    // How far any of its points is from where it is in the middle, at most.
    const double moved = bound_.displacement(shape, reach_);
    if (knownClearance(shape) > moved || !comesNear(way, shape, moved)) continue;
    const bool is_jump = depth == kDepthMax && moved > reach_max_m_;
    std::optional<std::uint32_t> swept_cuboid;
    if (robot_->collision.exempts(shape) || leaves_any_ || is_jump) {
      // Regions that move are not over the whole stretch where they are in its middle.
      const Shape swept = expanded(body_.body.shapes[shape], {1.0, moved});
      swept_cuboid = first(way, swept, shape, nullptr);
      if (!swept_cuboid) continue;
    }
    shapes[near++] = shape;
    furthest = std::max(furthest, moved);
    if (found) continue;
    if (const auto contact = touching(way, shape)) {
      found = Found{middle_s, *contact};
    } else if (is_jump) {
      found = Found{middle_s, {shape, *swept_cuboid}};  // a jump: nothing shows that it is free
    }
  }
  shapes.resize(near);
  if (near == 0) return std::nullopt;
  if (furthest <= reach_max_m_ || depth == kDepthMax) return found;
  near_[depth + 1] = shapes;
  if (const auto earlier = search(way, from_s, middle_s, depth + 1)) return earlier;
  if (found) return found;
  near_[depth + 1] = shapes;
  return search(way, middle_s, to_s, depth + 1);
}

std::optional<WayContact> WayCheck::firstContact(const Way& way, double from_s, double to_s,
                                                 bool look_at_begin) {
  poses_ = 0;
  bound_.cover(way.path);
  for (Known& known : known_) {
    known.clearance_m = 0.0;
    known.nearest.reset();
  }
  std::optional<Found> found;
  if (look_at_begin) found = at(way, from_s);
  if (!found && to_s > from_s) {
    near_.front().clear();
    for (std::uint32_t i = 0; i < body_.shapes.size(); ++i) near_.front().push_back(i);
    found = search(way, from_s, to_s, 0);
    if (!found) found = at(way, to_s);
  }
  if (!found) return std::nullopt;
  const auto [shape, cuboid] = found->contact;
  place(way, from_s);
  return WayContact{
      {static_cast<std::uint32_t>(body_.shapes[shape]), cuboid},
      found->time_s - from_s,
      way.obstacles.distanceTo(cuboid, body_.body.shapes[shape], body_.body.poses[shape])};
}

}  // namespace tccm
