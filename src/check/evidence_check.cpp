#include "check/evidence_check.h"

#include <algorithm>
#include <array>
#include <functional>

#include "base/line_of.h"

namespace tccm {
namespace {

using Kind = LookImage::Sight::Kind;

const LinkUse::Keys kEvidenceKeys{"evidence_links", "occlusion_ignored_links", "", "", ""};
constexpr std::size_t kUnseenShown = 4096;
constexpr double kAround = 0.07;    // [rad]
constexpr double kLateShare = 0.2;  // of a period that a look may be overdue by

/// Places in a primitive, as shares of its half extents; those of a sphere lie inside, too.
const std::array<Vector3, 9> kPlaces = {
    Vector3(0.0, 0.0, 0.0),   Vector3(0.5, 0.5, 0.7),   Vector3(0.5, 0.5, -0.7),
    Vector3(0.5, -0.5, 0.7),  Vector3(0.5, -0.5, -0.7), Vector3(-0.5, 0.5, 0.7),
    Vector3(-0.5, 0.5, -0.7), Vector3(-0.5, -0.5, 0.7), Vector3(-0.5, -0.5, -0.7)};

double share(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

/// The link of which a value is largest; nothing where there is none.
template <typename Value>
const LinkEvidence* most(const std::vector<LinkEvidence>& links, Value value) {
  const auto found = std::max_element(
      links.begin(), links.end(),
      [&](const auto& a, const auto& b) { return std::invoke(value, a) < std::invoke(value, b); });
  return found == links.end() ? nullptr : &*found;
}

}  // namespace

void EvidenceCheck::Config::describe(ParameterTable& table) {
  table.add("evidence_links", &links, "whose way should have been seen; empty: `occlusion_links`");
  table.add("evidence_margin_m", &margin_m, "m", {0.0, 1.0},
            "a look that ended this much before a place saw it all the same");
  table.add("evidence_slow_periods", &slow_periods, "periods", {1.0, 100.0},
            "a place that was not looked at for so many tilt periods slows the robot down");
  table.add("evidence_stop_periods", &stop_periods, "periods", {slow_periods, 100.0},
            "and for so many stops it; at least `evidence_slow_periods`");
  table.add("evidence_old_fraction_max", &old_fraction_max, "", {0.0, 1.0},
            "of the places of one link's way, in directions where the sensor looked before");
  table.add("unseen_fraction_max", &unseen_fraction_max, "", {0.0, 1.0},
            "of all that the links go through until the horizon; where more is unseen the robot "
            "slows down");
  table.add("unseen_volume_min_m3", &unseen_volume_min_m3, "m3", {0.0, 1.0},
            "less than this to go through is too little to judge by");
  table.add("unseen_slow_scale", &slow_scale, "", {0.0, 1.0},
            "speed scale where too much is unseen, or evidence is old");
  table.add("unseen_stops", &unseen_stops, "true: too much that is unseen stops the robot");
}

EvidenceCheck::EvidenceCheck(std::shared_ptr<const CheckedRobot> robot, const Config& config)
    : robot_(std::move(robot)), config_(validated(config)) {
  const RobotModel& model = *robot_->model;
  const UsedBody& body = robot_->collision_body;
  LinkUse watched = robot_->config.occlusion_use;
  if (!config.links.empty()) watched.links = config.links;
  const std::vector<std::size_t> seen_shapes = model.shapesFor(watched, kEvidenceKeys).shapes;
  std::vector<LinkEvidence>& links = findings_.links;
  for (std::size_t i = 0; i < body.shapes.size(); ++i) {
    const std::uint32_t link = body.links[i];
    const bool is_seen = std::any_of(seen_shapes.begin(), seen_shapes.end(),
                                     [&](std::size_t s) { return model.shapes()[s].link == link; });
    slot_of_shape_.push_back(is_seen ? entryOf(link, links) : kPassedOver);
    if (!is_seen) continue;
    shapes_.push_back(body.shapes[i]);
    end_shape_of_slot_.resize(links.size());
    end_shape_of_slot_[slot_of_shape_.back()] = i;
  }
  tallies_.resize(links.size());
  unseen_.reserve(kUnseenShown);
}

void EvidenceCheck::judge(const Situation& situation, Causes& causes) {
  find(situation.around, situation.now, situation.check_here.collisionBody().body,
       situation.check_ahead.collisionBody().body);
  const auto nameOf = [this](const LinkEvidence* link) {
    return robot_->model->links()[link->link];
  };
  if (findings_.unseen_fraction > config_.unseen_fraction_max) {
    const std::string link = nameOf(most(findings_.links, [](const LinkEvidence& evidence) {
      return evidence.unseen_fraction * evidence.new_volume_m3;
    }));
    std::string text = lineOf("%.0f %% of the way ahead is unseen, most of %.100s's",
                              100.0 * findings_.unseen_fraction, link.c_str());
    if (findings_.outside_fraction > 0.0) {
      text +=
          lineOf("; %.0f %% of it lies outside the map's area", 100.0 * findings_.outside_fraction);
    }
    causes.push_back(config_.unseen_stops
                         ? Cause::stopping(Reason::kUnseenAhead, text, link)
                         : Cause::slowing(Reason::kUnseenAhead, config_.slow_scale, text, link));
  }
  const LinkEvidence* lost = most(findings_.links, &LinkEvidence::lost_fraction);
  const LinkEvidence* old = most(findings_.links, &LinkEvidence::old_fraction);
  if (lost && lost->lost_fraction > config_.old_fraction_max) {
    causes.push_back({Reason::kEvidenceOld,
                      "the sensor looks no more where " + nameOf(lost) + " is", nameOf(lost)});
  } else if (old && old->old_fraction > config_.old_fraction_max) {
    causes.push_back(Cause::slowing(Reason::kEvidenceOld, config_.slow_scale,
                                    "the sensor did not look lately where " + nameOf(old) + " is",
                                    nameOf(old)));
  }
}

const EvidenceCheck::Findings& EvidenceCheck::find(const Surroundings& around, Time now,
                                                   const Body& now_body, const Body& end_body) {
  sensors_.clear();
  for (const SensorView& view : around) {
    const double period_s = toSeconds(view.map->look_period);
    sensors_.push_back({view.map, fromSeconds(config_.slow_periods * period_s),
                        fromSeconds(config_.stop_periods * period_s), view.is_out});
  }
  const Question question{around.map.grid, now};
  std::fill(tallies_.begin(), tallies_.end(), Tally());
  unseen_.clear();
  radii_.clear();
  T_shapes_fixed_.clear();
  for (const Shape& shape : now_body.shapes) radii_.push_back(boundingRadius(shape));
  for (const Pose& pose : now_body.poses) T_shapes_fixed_.push_back(pose.inverse());
  for (std::size_t i = 0; i < now_body.shapes.size(); ++i) {
    if (slot_of_shape_[i] == kPassedOver) continue;
    const auto is_housing = [&](const Sensor& sensor) {
      return distance(now_body.shapes[i], T_shapes_fixed_[i] * sensor.map->looks.viewpoint()) ==
             0.0;
    };
    if (std::all_of(sensors_.begin(), sensors_.end(), is_housing)) continue;
    lookAlong(question, now_body, i, end_body.poses[i]);
  }
  sumUp(question, end_body);
  return findings_;
}

void EvidenceCheck::lookAlong(const Question& question, const Body& now_body, std::size_t i,
                              const Pose& T_fixed_end) {
  const Shape& shape = now_body.shapes[i];
  const Pose& T_fixed_now = now_body.poses[i];
  Tally& tally = tallies_[slot_of_shape_[i]];
  const Vector3 half = bounds(shape, Pose::Identity()).max();
  const double volume_each = volume(shape) / (2.0 * kPlaces.size());
  const auto placeAt = [&](const Vector3& p_fixed) {
    const double new_volume = contains(now_body, i, p_fixed) ? 0.0 : volume_each;
    return Place{p_fixed, new_volume, evidenceOf(p_fixed, question.now)};
  };
  const Vector3 middle = T_fixed_now.translation();
  count(question, {middle, 0.0, evidenceOf(middle, question.now)}, tally);
  for (const Vector3& place : kPlaces) {
    const Vector3 p_shape = half.cwiseProduct(place);
    const Vector3 p_end = T_fixed_end * p_shape;
    const Place halfway = placeAt(0.5 * (T_fixed_now * p_shape + p_end));
    count(question, halfway, tally);
    // What stands still ends where it is halfway.
    count(question, p_end == halfway.p_fixed ? halfway : placeAt(p_end), tally);
  }
}

/// Where one part of the robot is now another finds nothing new. A slow one is mostly where it is.
bool EvidenceCheck::contains(const Body& body, std::size_t first, const Vector3& p_fixed) const {
  const auto isIn = [&](std::size_t i) {
    if ((p_fixed - body.poses[i].translation()).squaredNorm() > radii_[i] * radii_[i]) return false;
    return distance(body.shapes[i], T_shapes_fixed_[i] * p_fixed) == 0.0;
  };
  if (isIn(first)) return true;
  for (std::size_t i = 0; i < body.shapes.size(); ++i) {
    if (isIn(i)) return true;
  }
  return false;
}

EvidenceCheck::Evidence EvidenceCheck::evidenceOf(const Sensor& sensor, const Vector3& p_fixed,
                                                  Time now) const {
  const LookImage& looks = sensor.map->looks;
  const LookImage::Sight sight = looks.at(p_fixed, config_.margin_m);
  std::optional<Time> looked = sight.looked;
  const bool ages_matter = sensor.old > Duration::zero();  // else no period is known yet
  Evidence evidence;
  if (looked && ages_matter) {
    // At the edges of where the sensor looks a direction may be passed by a little.
    if (now - *looked > sensor.old) looked = looks.lookedAround(p_fixed, kAround);
    evidence.looked = true;
    evidence.old = now - *looked > sensor.old;
    evidence.lost = now - *looked > sensor.lost;
  }
  if (sight.kind != Kind::kSeen) return evidence;
  if (now - sight.stamp <= sensor.old || !ages_matter) {
    evidence.known = sight.stamp;
  } else if (looked) {
    // Where the sensor used to look, what was seen goes on growing old when it is too old to count.
    evidence.seen = std::max(sight.stamp, *looked);
  }
  return evidence;
}

/// What one sensor saw lately is known, however old another's evidence is.
EvidenceCheck::Evidence EvidenceCheck::evidenceOf(const Vector3& p_fixed, Time now) const {
  Evidence all;
  for (const Sensor& sensor : sensors_) {
    const Evidence evidence = evidenceOf(sensor, p_fixed, now);
    all.known = std::max(all.known, evidence.known);
    all.seen = std::max(all.seen, evidence.seen);
    if (!evidence.looked) continue;
    all.looked = true;
    all.old = all.old && evidence.old;
    all.lost = all.lost && evidence.lost;
  }
  // One may have seen it for the first time, from where it is now.
  all.old = all.old && !all.known;
  all.lost = all.lost && !all.known;
  return all;
}

void EvidenceCheck::count(const Question& question, const Place& place, Tally& tally) {
  const auto& [p_fixed, new_volume, evidence] = place;
  if (evidence.looked) {
    tally.looked_at += 1.0;
    tally.old += evidence.old ? 1.0 : 0.0;
    tally.lost += evidence.lost ? 1.0 : 0.0;
  }
  const bool is_covered = question.grid.covers(p_fixed);
  const bool is_known = evidence.known && is_covered;
  const std::optional<Time> stamp = evidence.known ? evidence.known : evidence.seen;
  if (stamp && is_covered) tally.oldest = std::min(tally.oldest.value_or(*stamp), *stamp);
  tally.new_volume += new_volume;
  if (is_known || new_volume <= 0.0) return;
  tally.unseen_volume += new_volume;
  if (!is_covered) tally.outside_volume += new_volume;
  if (unseen_.size() < kUnseenShown) unseen_.push_back(p_fixed);
}

/// Of whichever sensor looks there first.
std::optional<double> EvidenceCheck::nextLook(const Vector3& p_fixed, Time now) const {
  std::optional<double> next_s;
  for (const Sensor& sensor : sensors_) {
    if (sensor.is_out) continue;
    const Duration period = sensor.map->look_period;
    const Duration late_max = fromSeconds(kLateShare * toSeconds(period));
    const auto next = sensor.map->looks.nextLook(p_fixed, config_.margin_m, now, period, late_max);
    if (!next) continue;
    const double until_s = std::max(0.0, toSeconds(*next - now));
    next_s = std::min(next_s.value_or(until_s), until_s);
  }
  return next_s;
}

void EvidenceCheck::sumUp(const Question& question, const Body& end_body) {
  double new_volume = 0.0, unseen_volume = 0.0, outside_volume = 0.0;
  for (std::size_t slot = 0; slot < tallies_.size(); ++slot) {
    const Tally& tally = tallies_[slot];
    LinkEvidence& link = findings_.links[slot];
    link.new_volume_m3 = tally.new_volume;
    link.unseen_fraction = share(tally.unseen_volume, tally.new_volume);
    link.old_fraction = share(tally.old, tally.looked_at);
    link.lost_fraction = share(tally.lost, tally.looked_at);
    link.age_s.reset();
    if (tally.oldest) link.age_s = toSeconds(question.now - *tally.oldest);
    const Vector3 end = end_body.poses[end_shape_of_slot_[slot]].translation();
    link.next_look_s = nextLook(end, question.now);
    new_volume += tally.new_volume;
    unseen_volume += tally.unseen_volume;
    outside_volume += tally.outside_volume;
  }
  const bool is_enough = new_volume >= config_.unseen_volume_min_m3;
  findings_.unseen_fraction = is_enough ? share(unseen_volume, new_volume) : 0.0;
  findings_.outside_fraction = is_enough ? share(outside_volume, new_volume) : 0.0;
}

}  // namespace tccm
