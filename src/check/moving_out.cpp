#include "check/moving_out.h"

#include <algorithm>
#include <limits>

#include "geometry/distance.h"

namespace tccm {
namespace {

constexpr double kStep = 0.01;  // [m] between two poses
constexpr std::size_t kPosesMax = 256;
constexpr double kJump = 1e-6;    // [s]; a motion that is as short cannot be followed
constexpr double kNoise = 0.002;  // [m] by which a distance may shrink without closing
constexpr double kOpens = 0.003;  // [m] by which it has to grow over the way
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

MovingOut::MovingOut(std::shared_ptr<const CheckedRobot> robot)
    : robot_(std::move(robot)),
      body_(robot_->collisionBody()),
      kinematics_(robot_->sharedModel()),
      bound_(robot_->model(), body_.shapes, body_.radii(0.0)),
      contacts_max_(static_cast<std::size_t>(robot_->config().collision.contacts_max)) {
  for (const std::size_t shape : body_.shapes) {
    cores_.push_back(core(robot_->model().shapes()[shape].shape));
  }
  pairs_.reserve(contacts_max_);
  least_m_.resize(body_.shapes.size());
}

void MovingOut::place(const Way& way, double time_s) {
  way.path.positionsAt(time_s, positions_);
  body_.place(kinematics_.update(positions_, way.T_fixed_roots));
}

double MovingOut::coreDistance(const CuboidMap& map, std::size_t shape,
                               std::uint32_t cuboid) const {
  return distance(cores_[shape], body_.body.poses[shape], map.box(map.cuboids[cuboid]));
}

bool MovingOut::closesAny(const CuboidMap& map) {
  for (Pair& pair : pairs_) {
    const double metres = coreDistance(map, pair.shape, pair.cuboid);
    if (metres == 0.0 || metres < pair.last_m - kNoise) return true;
    pair.last_m = std::max(pair.last_m, metres);
  }
  // Cuboids that came into reach since: not nearer than what touched before.
  robot_->collision().find(map, body_.body, contacts_);
  if (contacts_.size() >= contacts_max_) return true;  // not all of them are known
  return std::any_of(contacts_.begin(), contacts_.end(), [&](const Contact& contact) {
    const double least = least_m_[contact.shape];
    if (least == kInfinity) return true;
    // The padding may reach it, the primitive itself may not.
    const UprightBox box = map.box(map.cuboids[contact.cuboid]);
    const bool is_new = std::none_of(pairs_.begin(), pairs_.end(), [&](const Pair& pair) {
      return pair.shape == contact.shape && pair.cuboid == contact.cuboid;
    });
    const Shape& bare = robot_->model().shapes()[body_.shapes[contact.shape]].shape;
    if (is_new && distance(bare, body_.body.poses[contact.shape], box) == 0.0) return true;
    return coreDistance(map, contact.shape, contact.cuboid) < least - kNoise;
  });
}

double MovingOut::furthest(const JointPath& way, double from_s, double to_s) {
  way.travelUntil(from_s, travel_from_);
  way.travelUntil(to_s, travel_);
  for (std::size_t v = 0; v < travel_.size(); ++v) travel_[v] -= travel_from_[v];
  double metres = 0.0;
  for (std::size_t i = 0; i < body_.shapes.size(); ++i) {
    metres = std::max(metres, bound_.displacement(i, travel_));
  }
  return metres;
}

double MovingOut::timeOf(const JointPath& way, double metres) {
  if (furthest(way, way.begin(), way.end()) <= metres) return way.end();
  double before = way.begin(), after = way.end();
  for (int i = 0; i < 20; ++i) {
    const double middle = 0.5 * (before + after);
    (furthest(way, way.begin(), middle) <= metres ? before : after) = middle;
  }
  return after;
}

bool MovingOut::closesBetween(const Way& way, double from_s, double to_s) {
  if (furthest(way.path, from_s, to_s) > kStep) {
    if (to_s - from_s < kJump) return true;
    const double middle_s = 0.5 * (from_s + to_s);
    return closesBetween(way, from_s, middle_s) || closesBetween(way, middle_s, to_s);
  }
  if (++poses_ > kPosesMax) return true;  // too fast to be looked at
  place(way, to_s);
  return closesAny(way.map);
}

bool MovingOut::opens(const Way& way, const std::vector<Contact>& contacts, double until_s,
                      bool must_open) {
  if (contacts.size() >= contacts_max_) return false;  // not all of them are known
  place(way, way.path.begin());
  pairs_.clear();
  std::fill(least_m_.begin(), least_m_.end(), kInfinity);
  for (const Contact& contact : contacts) {
    const auto used = std::find(body_.shapes.begin(), body_.shapes.end(), contact.shape);
    const auto shape = static_cast<std::size_t>(used - body_.shapes.begin());
    const double metres = coreDistance(way.map, shape, contact.cuboid);
    if (metres == 0.0) return false;
    pairs_.push_back({shape, contact.cuboid, metres, metres});
    least_m_[shape] = std::min(least_m_[shape], metres);
  }
  poses_ = 0;
  if (closesBetween(way, way.path.begin(), until_s)) return false;
  // Of each shape what was nearest has to recede; the rest must only not come nearer.
  return !must_open || std::all_of(pairs_.begin(), pairs_.end(), [this](const Pair& pair) {
    return pair.first_m > least_m_[pair.shape] || pair.last_m >= pair.first_m + kOpens;
  });
}

}  // namespace tccm
