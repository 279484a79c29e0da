#include "check/way_ahead.h"

#include <algorithm>
#include <cmath>

#include "geometry/distance.h"

namespace tccm {
namespace {

constexpr double kGrown = 1.0;    // [m] by which lever arms with a margin are found
constexpr double kLookMax = 2.0;  // [s] ahead, unless the horizon is further
constexpr double kUnits = 8.0;    // of a step, between two places: they tell the time of a contact
constexpr double kSearch = 0.1;   // [m] around a primitive; nearer is not always cheaper
constexpr double kTouching = 1e-6;        // [m] that count as nothing
constexpr std::size_t kWorkOfJoint = 20;  // in cuboids passed by
constexpr std::size_t kWorkOfShape = 30;
constexpr std::size_t kWorkOfDistance = 50;

/// Places along a way, in units: eight within the first, four within the second, two in each of the
/// next two, then one. A slow primitive's way is short.
constexpr std::size_t kDense = 16;
constexpr double kUnitsMax = 1e12;  // further than any way that is looked along to its end
constexpr std::size_t kHalvingsMax = 20;
double placeOf(std::size_t index) {
  const auto j = static_cast<double>(index);
  if (index < 8) return j / 8.0;
  if (index < 12) return 1.0 + (j - 8.0) / 4.0;
  return index < kDense ? 2.0 + (j - 12.0) / 2.0 : j - 12.0;
}

/// The first place that is not before that.
std::size_t placeFrom(double units) {
  std::size_t index = 0;
  units = std::min(units, kUnitsMax);
  if (units > 4.0) index = 12 + static_cast<std::size_t>(units);
  while (placeOf(index) < units) ++index;
  return index;
}

/// The same with each distance between two of them halved so many times.
double placeOf(std::size_t index, std::size_t halvings) {
  const std::size_t whole = index >> halvings;
  const double parts = std::ldexp(1.0, static_cast<int>(halvings));
  const double share = static_cast<double>(index - (whole << halvings)) / parts;
  return placeOf(whole) + share * (placeOf(whole + 1) - placeOf(whole));
}

std::size_t placeFrom(double units, std::size_t halvings) {
  units = std::min(units, kUnitsMax);
  const std::size_t after = placeFrom(units);
  if (after == 0) return 0;
  const double before = placeOf(after - 1), span = placeOf(after) - before;
  const double parts = std::ldexp((units - before) / span, static_cast<int>(halvings));
  return ((after - 1) << halvings) + static_cast<std::size_t>(std::ceil(parts));
}

/// Radii around the primitives as they are, grown by that.
std::vector<double> bareRadii(const CheckedRobot& robot, double growth_m) {
  std::vector<double> radii;
  for (const std::size_t shape : robot.collision_body.shapes) {
    radii.push_back(boundingRadius(robot.model->shapes()[shape].shape) + growth_m);
  }
  return radii;
}

bool isGraver(const WayAhead::Found& one, const WayAhead::Found& other) {
  if (one.stops != other.stops) return one.stops;
  if (!one.stops && one.scale != other.scale) return one.scale < other.scale;
  return one.contact.time_s < other.contact.time_s;
}

}  // namespace

WayAhead::WayAhead(const std::shared_ptr<const CheckedRobot>& robot, double step_m,
                   double margin_max_m)
    : robot_(robot),
      body_(robot_->collision_body),
      step_m_(step_m),
      unit_m_(step_m / kUnits),
      margin_max_m_(margin_max_m),
      speeds_(robot),
      bound_(*robot_->model, body_.shapes, body_.radii(0.0)),
      bound_grown_(*robot_->model, body_.shapes, body_.radii(kGrown)),
      cursor_bound_(*robot_->model, body_.shapes, bareRadii(*robot_, MovingOut::kGrowth)),
      kinematics_(robot_->model),
      cursor_(robot_->model->variables().size()),
      T_fixed_links_(robot_->model->links().size(), Pose::Identity()),
      leaving_(static_cast<std::size_t>(robot_->config.collision.contacts_max)) {
  const std::size_t variables = robot_->model->variables().size();
  for (auto* values : {&positions_, &begin_, &halfway_, &end_}) {
    values->resize(variables);
  }
  for (std::size_t i = 0; i < body_.shapes.size(); ++i) parts_.push_back(partOf(i));
  for (std::size_t link = 0; link < robot_->model->links().size(); ++link) {
    link_chains_.emplace_back(*robot_->model, link);
  }
}

WayAhead::Part WayAhead::partOf(std::size_t i) const {
  Part part{LinkChain(*robot_->model, body_.links[i]), body_.body.shapes[i],
            core(robot_->model->shapes()[body_.shapes[i]].shape)};
  part.arms.resize(robot_->model->variables().size());
  part.touched.reserve(static_cast<std::size_t>(robot_->config.collision.contacts_max));
  return part;
}

double WayAhead::lookTimeMax() const { return std::max(kLookMax, halting_.horizon_s); }

void WayAhead::begin(const Halting& halting, const std::vector<Contact>& contacts,
                     const Posture& posture, std::size_t work) {
  halting_ = halting;
  here_ = &posture;
  touch_.reset();
  margin_.reset();
  too_fast_.reset();
  poses_ = 0;
  work_end_ = work_ + robot_->collision.work() + work;
  is_too_long_ = false;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    std::vector<std::uint32_t>& touched = parts_[i].touched;
    touched.clear();
    for (const Contact& contact : contacts) {
      if (contact.shape == body_.shapes[i]) touched.push_back(contact.cuboid);
    }
  }
}

bool WayAhead::isExhausted() {
  is_too_long_ = is_too_long_ || work_ + robot_->collision.work() >= work_end_;
  return is_too_long_;
}

bool WayAhead::lookAlong(const Way& way) {
  speeds_.find(way, halting_);
  poses_ += speeds_.places();
  is_too_long_ = is_too_long_ || speeds_.exhausted();
  const double look_s = halting_.lookTime(speeds_.fastest());
  if (way.path.end() < std::min(look_s, lookTimeMax())) return false;
  if (look_s > way.path.end()) noteTooFast(way);
  for (MotionBound* bound : {&bound_, &bound_grown_}) bound->cover(way.path);
  for (std::size_t i = 0; i < parts_.size(); ++i) prepare(i);
  halfway_s_ = 0.5 * std::min(look_s, way.path.end());
  way.path.positionsAt(halfway_s_, positions_);
  kinematics_.update(positions_, way.T_fixed_roots);
  way.path.travelUntil(way.path.begin(), begin_);
  way.path.travelUntil(halfway_s_, halfway_);
  ++poses_;
  for (std::size_t i = 0; i < parts_.size() && !isExhausted(); ++i) {
    if (!isFree(way, i)) walk(way, i);
  }
  return true;
}

void WayAhead::noteTooFast(const Way& way) {
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const double speed = speeds_.of(i);
    if (halting_.lookTime(speed) <= way.path.end()) continue;
    const double scale = halting_.scaleWithin(way.path.end(), speed);
    if (too_fast_ && too_fast_->scale <= scale) continue;
    too_fast_ = TooFast{body_.shapes[i], speed, way.path.end(), scale};
  }
}

void WayAhead::prepare(std::size_t i) {
  Part& part = parts_[i];
  const double speed = speeds_.of(i);
  part.margin_m = std::min(halting_.delay_s * speed, margin_max_m_);
  part.grown = expanded(body_.body.shapes[i], {1.0, part.margin_m});
  part.look_s = halting_.lookTime(speed);
  const double* arms = bound_.leverArms(i);
  const double* arms_grown = bound_grown_.leverArms(i);
  for (std::size_t v = 0; v < part.arms.size(); ++v) {
    part.arms[v] = arms[v] + part.margin_m / kGrown * (arms_grown[v] - arms[v]);
  }
}

/// The most on any straight piece of the way.
void WayAhead::findPerMetre(const Way& way, std::size_t i) {
  Part& part = parts_[i];
  const double* cursor_arms = cursor_bound_.leverArms(i);
  part.per_metre = 0.0;
  for (std::size_t point = 0; point + 1 < way.path.size(); ++point) {
    if (way.path.time(point) > part.look_s) break;
    const double* from = way.path.travel(point);
    const double* to = way.path.travel(point + 1);
    double metres = 0.0, cursor_metres = 0.0;
    for (std::size_t v = 0; v < part.arms.size(); ++v) {
      metres += part.arms[v] * (to[v] - from[v]);
      cursor_metres += cursor_arms[v] * (to[v] - from[v]);
    }
    if (metres > 0.0) part.per_metre = std::max(part.per_metre, metres / cursor_metres);
  }
  part.halvings = 0;
  while (part.halvings < kHalvingsMax &&
         std::ldexp(step_m_, static_cast<int>(part.halvings)) < unit_m_ * part.per_metre) {
    ++part.halvings;
  }
  is_too_long_ = is_too_long_ || part.halvings == kHalvingsMax;  // a step would pass over something
}

double WayAhead::moved(std::size_t i, const std::vector<double>& from,
                       const std::vector<double>& to) const {
  const Part& part = parts_[i];
  double metres = 0.0;
  for (std::size_t v = 0; v < part.arms.size(); ++v) metres += part.arms[v] * (to[v] - from[v]);
  return metres;
}

bool WayAhead::isFree(const Way& way, std::size_t i) {
  work_ += kWorkOfShape;
  Part& part = parts_[i];
  way.path.travelUntil(std::min(part.look_s, way.path.end()), end_);
  const double metres = std::max(moved(i, begin_, halfway_), moved(i, halfway_, end_));
  const auto found = robot_->collision.nearest(way.obstacles, part.grown,
                                               kinematics_.shapePoses()[body_.shapes[i]],
                                               static_cast<std::uint32_t>(i), metres + kTouching);
  if (found) part.free_halfway_m = std::max(0.0, found->distance_m - kTouching);
  return !found;
}

double WayAhead::latest(std::size_t i) const {
  const double look_s = parts_[i].look_s;
  if (!touch_) return look_s;
  if (touch_->stops) return std::min(look_s, touch_->contact.time_s);
  return std::min(look_s, halting_.latest(touch_->scale, speeds_.of(i)));
}

void WayAhead::walk(const Way& way, std::size_t i) {
  findPerMetre(way, i);
  const Part& part = parts_[i];
  if (part.per_metre <= 0.0) return;
  cursor_.start(way.path, cursor_bound_.leverArms(i));
  end_m_ = cursor_.metresUntil(part.look_s);
  const double halfway_m = cursor_.metresUntil(halfway_s_);
  const double around_m = part.free_halfway_m / part.per_metre;  // is free
  beginLeaving(way, i);
  bool with_margin = part.margin_m > 0.0;
  double free_m = 0.0, free_before_m = 0.0;  // by the cursor
  for (std::size_t index = 0; !isExhausted();) {
    const double here_m = unit_m_ * placeOf(index, part.halvings);
    if (!cursor_.moveTo(here_m) || cursor_.time() > latest(i)) return;
    with_margin = with_margin && !(touch_ && touch_->stops);
    place(way, i, index == 0);
    const double leaving_m = leave(way, i, here_m);
    free_before_m = free_m;
    free_m = freeAround(way, i, with_margin);
    if (with_margin && free_m <= 0.0 && touches(way, i, true)) {
      with_margin = false;
      free_m = freeAround(way, i, false);
    }
    if (!with_margin && free_m <= 0.0 && touches(way, i, false)) return;
    double next_m = here_m + free_m;
    // Where it does not come nearer it is looked further ahead, and back from there.
    if (free_m > 0.8 * free_before_m && leaving_.obstacles().empty()) {
      next_m = passFree(way, i, with_margin, next_m, free_m);
    }
    if (std::abs(next_m - halfway_m) < around_m) next_m = halfway_m + around_m;
    if (!leaving_.obstacles().empty()) next_m = std::min(next_m, here_m + leaving_m);
    index = std::max(index + 1, placeFrom(next_m / unit_m_, part.halvings));
  }
}

double WayAhead::passFree(const Way& way, std::size_t i, bool with_margin, double until_m,
                          double free_m) {
  while (free_m > unit_m_ && !isExhausted()) {
    const double ahead_m = until_m + 0.8 * free_m;
    if (ahead_m >= end_m_ || !cursor_.moveTo(ahead_m)) break;
    place(way, i, false);
    free_m = freeAround(way, i, with_margin);
    if (ahead_m - free_m > until_m) break;
    until_m = ahead_m + free_m;
  }
  return until_m;
}

void WayAhead::place(const Way& way, std::size_t i, bool is_here) {
  const std::size_t shape = body_.shapes[i];
  Part& part = parts_[i];
  ++poses_;
  is_here_ = is_here;
  work_ += kWorkOfShape + kWorkOfJoint * part.chain.joints();
  T_fixed_shape_ = is_here ? here_->T_fixed_shapes[shape]
                           : part.chain.place(cursor_.positions(), way.T_fixed_roots) *
                                 robot_->model->shapes()[shape].T_link_shape;
}

void WayAhead::placeRegions(const Way& way, std::size_t i) {
  const ExemptRegions& exempt = robot_->collision.exempted();
  if (exempt.of_shapes.empty()) return;
  for (const std::size_t region : exempt.of_shapes[i]) {
    const std::optional<std::size_t>& link = exempt.regions[region].link;
    if (!link) continue;
    LinkChain& chain = link_chains_[*link];
    work_ += kWorkOfShape + kWorkOfJoint * chain.joints();
    T_fixed_links_[*link] = is_here_ ? here_->T_fixed_links[*link]
                                     : chain.place(cursor_.positions(), way.T_fixed_roots);
  }
}

void WayAhead::beginLeaving(const Way& way, std::size_t i) {
  leaving_.begin(parts_[i].touched);
  if (leaving_.obstacles().empty() || !cursor_.moveTo(MovingOut::kEscape)) return;
  place(way, i, false);
  work_ += kWorkOfDistance * leaving_.obstacles().size();
  leaving_.passEscape(way.obstacles, solid(i, false), parts_[i].core, T_fixed_shape_);
}

double WayAhead::leave(const Way& way, std::size_t i, double here_m) {
  if (here_m <= MovingOut::kEscape) return MovingOut::kEscape - here_m;
  work_ += kWorkOfDistance * leaving_.followed();
  return leaving_.update(way.obstacles, parts_[i].core, T_fixed_shape_) / parts_[i].per_metre;
}

const std::vector<std::uint32_t>* WayAhead::left(bool with_margin) const {
  return with_margin ? nullptr : &leaving_.obstacles();
}

const Shape& WayAhead::solid(std::size_t i, bool with_margin) const {
  return with_margin ? parts_[i].grown : body_.body.shapes[i];
}

double WayAhead::freeAround(const Way& way, std::size_t i, bool with_margin) const {
  const double radius_m = std::min(kSearch, parts_[i].per_metre * end_m_) + kTouching;
  const auto found =
      robot_->collision.nearest(way.obstacles, solid(i, with_margin), T_fixed_shape_,
                                static_cast<std::uint32_t>(i), radius_m, left(with_margin));
  const double metres = (found ? found->distance_m : radius_m) - kTouching;
  return std::max(0.0, metres) / parts_[i].per_metre;
}

bool WayAhead::touches(const Way& way, std::size_t i, bool with_margin) {
  const Part& part = parts_[i];
  const Shape& shape = solid(i, with_margin);
  const auto index = static_cast<std::uint32_t>(i);
  placeRegions(way, i);
  const auto obstacle = robot_->collision.first(way.obstacles, shape, T_fixed_shape_, index,
                                                &T_fixed_links_, left(with_margin));
  if (!obstacle) return false;
  const auto model_shape = static_cast<std::uint32_t>(body_.shapes[i]);
  const double time_s = cursor_.time(), speed = speeds_.of(i);
  Found found{{{model_shape, *obstacle},
               time_s,
               way.obstacles.distanceTo(*obstacle, shape, here_->T_fixed_shapes[model_shape]),
               speed,
               with_margin}};
  // Within the margin it is when it touches what it will within the delay.
  found.stops = !with_margin && time_s <= halting_.haltTime(speed);
  const double touch_s = with_margin ? time_s + part.margin_m / speed : time_s;
  if (!found.stops) found.scale = halting_.scale(touch_s, speed);
  std::optional<Found>& gravest = with_margin ? margin_ : touch_;
  if (!gravest || isGraver(found, *gravest)) gravest = found;
  return true;
}

}  // namespace tccm
