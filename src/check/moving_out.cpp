#include "check/moving_out.h"

#include <algorithm>

#include "geometry/distance.h"

namespace tccm {
namespace {

constexpr double kStep = 0.0025;  // [m] between two poses
constexpr double kJump = 0.01;    // [m] in no time: such a motion cannot be followed
constexpr double kOpens = 0.001;  // [m] by which it has to grow over the way
constexpr double kMoves = 0.003;  // [m] that a primitive has to move for that

std::vector<double> radiiOf(const CheckedRobot& robot) {
  std::vector<double> radii;
  for (const std::size_t shape : robot.collision_body.shapes) {
    radii.push_back(boundingRadius(robot.model->shapes()[shape].shape) + MovingOut::kGrowth);
  }
  return radii;
}

}  // namespace

MovingOut::MovingOut(const std::shared_ptr<const CheckedRobot>& robot)
    : robot_(robot),
      shapes_(robot_->collision_body.shapes),
      bound_(*robot_->model, shapes_, radiiOf(*robot_)),
      contacts_max_(static_cast<std::size_t>(robot_->config.collision.contacts_max)),
      cursor_(robot_->model->variables().size()),
      positions_(robot_->model->variables().size()) {
  for (const std::size_t shape : shapes_) {
    const LinkShape& bare = robot_->model->shapes()[shape];
    cores_.push_back(core(bare.shape));
    chains_.emplace_back(*robot_->model, bare.link);
  }
  pairs_.reserve(contacts_max_);
}

void MovingOut::place(const Way& way, std::size_t i, const std::vector<double>& positions) {
  T_fixed_shape_ = chains_[i].place(positions, way.T_fixed_roots) *
                   robot_->model->shapes()[shapes_[i]].T_link_shape;
}

double MovingOut::coreDistance(const Obstacles& obstacles, std::size_t i,
                               std::uint32_t obstacle) const {
  return obstacles.distanceTo(obstacle, cores_[i], T_fixed_shape_);
}

bool MovingOut::beginPairs(const Way& way, const std::vector<Contact>& contacts, std::size_t i) {
  way.path.positionsAt(way.path.begin(), positions_);
  place(way, i, positions_);
  pairs_.clear();
  for (const Contact& contact : contacts) {
    if (contact.shape != shapes_[i]) continue;
    const double metres = coreDistance(way.obstacles, i, contact.cuboid);
    if (metres == 0.0) return false;
    pairs_.push_back({contact.cuboid, metres, metres});
  }
  return true;
}

bool MovingOut::closesAny(const Way& way, std::size_t i, const std::vector<double>& positions) {
  place(way, i, positions);
  for (Pair& pair : pairs_) {
    const double metres = coreDistance(way.obstacles, i, pair.obstacle);
    if (metres == 0.0 || metres < pair.last_m - kNoise) return true;
    pair.last_m = std::max(pair.last_m, metres);
  }
  return false;
}

bool MovingOut::stayOpen(const Way& way, std::size_t i) {
  cursor_.start(way.path, bound_.leverArms(i));
  for (double metres = kStep; metres <= kEscape; metres += kStep) {
    if (!cursor_.moveTo(metres)) {
      way.path.positionsAt(way.path.end(), positions_);
      followed_m_ = cursor_.metresUntil(way.path.end());
      return !cursor_.hasJumped(kJump) && !closesAny(way, i, positions_);
    }
    followed_m_ = metres;
    if (cursor_.hasJumped(kJump) || closesAny(way, i, cursor_.positions())) return false;
  }
  return true;
}

bool MovingOut::opens(const Way& way, const std::vector<Contact>& contacts, bool must_open) {
  if (contacts.size() >= contacts_max_) return false;  // not all of them are known
  bound_.cover(way.path);
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    const bool is_in_contact =
        std::any_of(contacts.begin(), contacts.end(),
                    [&](const Contact& contact) { return contact.shape == shapes_[i]; });
    if (!is_in_contact) continue;
    if (!beginPairs(way, contacts, i)) return false;
    if (!stayOpen(way, i)) return false;
    const bool all_open = std::all_of(pairs_.begin(), pairs_.end(), [](const Pair& pair) {
      return pair.last_m >= pair.first_m + kOpens;
    });
    if (must_open && (followed_m_ < kMoves || !all_open)) return false;
  }
  return true;
}

}  // namespace tccm
