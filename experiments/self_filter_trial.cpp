#include "experiments/self_filter_trial.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>
#include <set>
#include <utility>

#include "experiments/statistics.h"
#include "tccm_monitor/config_error.h"

namespace tccm::simulation {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kContactsListed = 100;

bool measured(const BeamTruth& truth, const Beam& beam) {
  return beam.measured() && (truth.mixed || truth.label);
}

Json toJson(const BeamFates& fates) {
  const auto of = [&fates](BeamKind kind) { return fates.in_area[BeamFates::index(kind)]; };
  return {{"measured_in_area", fates.measuredInArea()},
          {"removed_as_mixed_pixel", of(BeamKind::kMixedPixel)},
          {"removed_as_self", of(BeamKind::kSelf)},
          {"removed_as_shadow", of(BeamKind::kShadow)},
          {"out_of_range", of(BeamKind::kUnknown) + of(BeamKind::kTooClose)},
          {"mapped", fates.mapped()},
          {"kept_out_of_area", fates.keptAnywhere() - fates.mapped()}};
}

Json toJson(const SourceCounts& counts) {
  Json json;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    json[name(static_cast<BeamSource>(i))] = counts[i];
  }
  return json;
}

}  // namespace

std::size_t BeamFates::measuredInArea() const {
  return std::accumulate(in_area.begin(), in_area.end(), std::size_t{0});
}

double SelfFilterTally::sceneShareRemoved() const {
  const BeamFates& scene = of(BeamSource::kScene);
  return share(scene.measuredInArea() - scene.mapped(), scene.measuredInArea());
}

std::vector<std::string> SelfFilterLimits::missed(const SelfFilterTally& tally) const {
  std::vector<std::string> names;
  if (tally.of(BeamSource::kOwn).mapped() > 0) names.emplace_back("own_points");
  if (tally.contacts_with_body > 0) names.emplace_back("contacts_with_body");
  if (any_contact && tally.checks_with_contact > 0) names.emplace_back("contacts");
  if (!(tally.sceneShareRemoved() < scene_share_removed)) names.emplace_back("scene_removed");
  return names;
}

void SelfFilterTrial::Config::validate() const {
  simulator.validate();
  requireInRange("duration_s", duration_s, 1.0, 36000.0);
  requireInRange("pause_every_s", pause_every_s, 0.0, 3600.0);
  requireInRange("joints_late_s", joints_late_s, 0.0, 0.1);
}

SelfFilterTrial::SelfFilterTrial(const Config& config, std::shared_ptr<const RobotModel> model)
    : config_((config.validate(), config)),
      simulation_(config.simulator, config.monitor, std::move(model)),
      grid_(config.monitor.sensors.front().mapper.map.grid),
      ledgers_(config.simulator.sensors.size()),
      random_(config.simulator.seed),
      next_pause_change_(config.pause_every_s > 0.0 && !config.obeys ? now() : Time::max()) {
  if (config.obeys) simulation_.obey();
  simulation_.stampJointsLate(config.joints_late_s);
  simulation_.onScan([this](const SimulatedScan& scan) { countBeams(scan); });
  simulation_.onCloud([this](const MappedCloud& cloud) { countPoints(cloud); });
  simulation_.onVerdict([this](const Verdict& verdict) { countCheck(verdict); });
}

const SelfFilterTally& SelfFilterTrial::run(const std::function<void(double)>& progress) {
  const Time start = now();
  const Time end = start + fromSeconds(config_.duration_s);
  while (now() < end) {
    decidePause();
    if (!simulation_.step()) continue;
    if (progress) progress(toSeconds(now() - start) / config_.duration_s);
  }
  return tally_;
}

void SelfFilterTrial::decidePause() {
  if (now() < next_pause_change_) return;
  std::uniform_real_distribution<double> around_one(0.5, 1.5);
  const double mean_s = config_.pause_every_s * (paused_ ? 1.0 : 0.25);
  next_pause_change_ = now() + fromSeconds(mean_s * around_one(random_));
  simulation_.simulator().setStop(!paused_);
  paused_ = !paused_;
}

void SelfFilterTrial::countBeams(const SimulatedScan& scan) {
  ++tally_.scans;
  const std::vector<SensorKind>& sensors = config_.simulator.sensors;
  const auto laser = static_cast<std::size_t>(
      std::find(sensors.begin(), sensors.end(), SensorKind::kLaser) - sensors.begin());
  const Monitor& monitor = simulation_.monitor();
  std::vector<PointLedger::Entry> entries;
  for (std::size_t i = 0; i < scan.truth.size(); ++i) {
    const Beam& beam = monitor.assembled(laser).beams[i];
    if (!measured(scan.truth[i], beam)) continue;
    count(sourceOf(scan.truth[i]), beam.kind, beam.p_fixed, entries);
  }
  ledgers_[laser].add(std::move(entries), monitor.map(laser)->window_scans);
}

void SelfFilterTrial::countPoints(const MappedCloud& mapped) {
  ++tally_.scans;
  const Cloud& cloud = mapped.cloud.cloud;
  std::vector<PointLedger::Entry> entries;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (!isMeasured(cloud.points[i]) || mapped.kinds[i] == BeamKind::kThinned) continue;
    count(sourceOf(mapped.cloud.truth[i].beam()), mapped.kinds[i], mapped.p_fixed[i], entries);
  }
  ledgers_[mapped.sensor].add(std::move(entries),
                              simulation_.monitor().map(mapped.sensor)->window_scans);
}

void SelfFilterTrial::count(BeamSource source, BeamKind kind, const Vector3& p_fixed,
                            std::vector<PointLedger::Entry>& entries) {
  BeamFates& fates = tally_.fates[static_cast<std::size_t>(source)];
  ++fates.anywhere[BeamFates::index(kind)];
  const std::optional<Grid::Place> place = grid_.place(p_fixed);
  if (!place) return;
  ++fates.in_area[BeamFates::index(kind)];
  if (kind == BeamKind::kReturn) entries.push_back({place->cell, place->height, source});
}

void SelfFilterTrial::countCheck(const Verdict& verdict) {
  ++tally_.checks;
  if (verdict.collision) noteContacts(verdict);
  in_contact_ = verdict.collision;
  notePermission(verdict);
}

SourceCounts SelfFilterTrial::supportersOf(const Verdict& verdict) {
  std::set<std::uint32_t> cuboids;
  for (const auto* contacts : {&verdict.now.contacts, &verdict.ahead.contacts}) {
    for (const Contact& contact : *contacts) cuboids.insert(contact.cuboid);
  }
  if (verdict.first_contact) cuboids.insert(verdict.first_contact->contact.cuboid);
  if (verdict.approached) cuboids.insert(verdict.approached->cuboid);
  const Monitor& monitor = simulation_.monitor();
  const CuboidMap& map = *monitor.checker().map();
  const double height_m = monitor.checker().config().pose.collision.support_height_m;
  SourceCounts sum{};
  for (const std::uint32_t cuboid : cuboids) {
    for (const PointLedger& ledger : ledgers_) {
      const SourceCounts counts = ledger.around(map, map.cuboids[cuboid], height_m);
      for (std::size_t i = 0; i < counts.size(); ++i) sum[i] += counts[i];
    }
  }
  return sum;
}

FalseContact SelfFilterTrial::contactOf(const Verdict& verdict) {
  FalseContact contact{verdict.stamp, !verdict.now.collision, {}, {}};
  const RobotModel& model = *simulation_.monitor().checker().model();
  const std::vector<Contact>& first =
      verdict.now.collision ? verdict.now.contacts : verdict.ahead.contacts;
  if (!first.empty()) {
    contact.link = model.linkOf(first.front().shape);
  } else if (verdict.approached) {
    contact.link = model.linkOf(verdict.approached->shape);
  } else if (verdict.first_contact) {
    contact.link = model.linkOf(verdict.first_contact->contact.shape);
  }
  contact.supporters = supportersOf(verdict);
  return contact;
}

void SelfFilterTrial::noteContacts(const Verdict& verdict) {
  ++tally_.checks_with_contact;
  if (verdict.now.collision) ++tally_.contacts_now;
  const FalseContact contact = contactOf(verdict);
  for (std::size_t i = 0; i < kBeamSources; ++i) {
    if (contact.supporters[i] > 0) ++tally_.contacts_with[i];
  }
  const auto from = [&](BeamSource source) {
    return contact.supporters[static_cast<std::size_t>(source)] > 0;
  };
  if (from(BeamSource::kOwn) || from(BeamSource::kOwnMixed)) ++tally_.contacts_with_body;
  if (!in_contact_ && tally_.first_contacts.size() < kContactsListed) {
    tally_.first_contacts.push_back(contact);
  }
}

void SelfFilterTrial::notePermission(const Verdict& verdict) {
  const bool for_contact = verdict.reason == Reason::kCollision ||
                           verdict.reason == Reason::kCollisionAhead ||
                           verdict.reason == Reason::kApproached;
  const double elapsed_s = toSeconds(verdict.stamp - std::exchange(last_check_, verdict.stamp));
  if (permitted_) tally_.permitted_s += elapsed_s;
  if (permitted_ && !verdict.stop && for_contact) tally_.slowed_s += elapsed_s;
  const bool was_permitted = std::exchange(permitted_, !verdict.stop);
  if (was_permitted && verdict.stop && for_contact && tally_.stops.size() < kContactsListed) {
    tally_.stops.push_back(contactOf(verdict));
  }
}

Json toJson(const SelfFilterTally& tally) {
  Json json;
  json["scans"] = tally.scans;
  json["checks"] = tally.checks;
  for (std::size_t i = 0; i < kBeamSources; ++i) {
    json["points"][name(static_cast<BeamSource>(i))] = toJson(tally.fates[i]);
  }
  const BeamFates& scene = tally.of(BeamSource::kScene);
  const auto removed = [&scene](BeamKind kind) {
    return share(scene.in_area[BeamFates::index(kind)], scene.measuredInArea());
  };
  json["own_points_in_map"] = tally.of(BeamSource::kOwn).mapped();
  json["own_mixed_in_map"] = tally.of(BeamSource::kOwnMixed).mapped();
  json["contacts"] = {{"checks", tally.checks_with_contact},
                      {"checks_at_present_pose", tally.contacts_now},
                      {"checks_with_body_points", tally.contacts_with_body},
                      {"checks_with_points_of", toJson(tally.contacts_with)}};
  json["scene_share_removed"] = {{"all", tally.sceneShareRemoved()},
                                 {"as_mixed_pixel", removed(BeamKind::kMixedPixel)},
                                 {"as_self", removed(BeamKind::kSelf)},
                                 {"as_shadow", removed(BeamKind::kShadow)}};
  json["first_contacts"] = Json::array();
  for (const FalseContact& contact : tally.first_contacts) {
    json["first_contacts"].push_back({{"stamp", toSeconds(contact.stamp)},
                                      {"ahead", contact.ahead},
                                      {"link", contact.link},
                                      {"points_around", toJson(contact.supporters)}});
  }
  return json;
}

}  // namespace tccm::simulation
