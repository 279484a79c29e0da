#include "nodelets/status_conversions.h"

#include <algorithm>
#include <limits>

#include "ros/conversions.h"

namespace tccm {
namespace {

using tccm_monitor::CuboidFlag;
using tccm_monitor::LinkStatus;
using tccm_monitor::MonitorStatus;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

constexpr float kNotKnown = std::numeric_limits<float>::quiet_NaN();

/// The message's entry of a link, a new one where there is none yet.
LinkStatus& entryOf(const std::string& link, bool ahead, MonitorStatus& message) {
  for (LinkStatus& entry : message.links) {
    if (entry.link == link && (entry.ahead != 0) == ahead) return entry;
  }
  LinkStatus& entry = message.links.emplace_back();
  entry.link = link;
  entry.ahead = ahead;
  entry.visible_fraction = 1.0F;
  entry.way_unseen_fraction = entry.evidence_age = entry.next_look = kNotKnown;
  entry.clearance = kInfinity;
  return entry;
}

void addLinks(const PoseFindings& findings, bool ahead, const Checker& checker,
              MonitorStatus& message) {
  const RobotModel& model = *checker.model();
  for (const LinkVisibility& visibility : findings.links) {
    LinkStatus& entry = entryOf(model.links()[visibility.link], ahead, message);
    entry.visible_fraction = static_cast<float>(visibility.visible_fraction);
    entry.occluded_fraction = static_cast<float>(visibility.occluded_fraction);
    entry.unseen_fraction = static_cast<float>(visibility.unseen_fraction);
    entry.occlusion = checker.checkHere().isOccluded(visibility);
  }
  for (const Contact& contact : findings.contacts) {
    entryOf(model.linkOf(contact.shape), ahead, message).collision = true;
  }
}

void addClearances(const std::vector<LinkClearance>& clearances, const RobotModel& model,
                   MonitorStatus& message) {
  for (const LinkClearance& clearance : clearances) {
    if (clearance.distance_m == std::numeric_limits<double>::infinity()) continue;
    entryOf(model.links()[clearance.link], false, message).clearance =
        static_cast<float>(clearance.distance_m);
  }
}

void addEvidence(const EvidenceCheck::Findings& findings, const RobotModel& model,
                 MonitorStatus& message) {
  for (const LinkEvidence& link : findings.links) {
    LinkStatus& entry = entryOf(model.links()[link.link], false, message);
    entry.way_unseen_fraction = static_cast<float>(link.unseen_fraction);
    entry.evidence_age = link.age_s ? static_cast<float>(*link.age_s) : kNotKnown;
    entry.next_look = link.next_look_s ? static_cast<float>(*link.next_look_s) : kInfinity;
  }
}

void addFlags(const PoseFindings& findings, const CuboidMap& map, MonitorStatus& message) {
  for (const Contact& contact : findings.contacts) {
    message.flagged.push_back(toFlag(map, contact.cuboid, tccm_monitor::Cuboid::COLLISION));
  }
  for (const std::uint32_t index : findings.occluding_cuboids) {
    message.flagged.push_back(toFlag(map, index, tccm_monitor::Cuboid::OCCLUSION));
  }
}

/// On the way ahead the first contact may be another one than those at its end.
void addContactLink(const Verdict& verdict, const Checker& checker, MonitorStatus& message) {
  if (!verdict.first_contact || verdict.first_contact->by_margin || verdict.now.collision) return;
  const std::string& name = checker.model()->linkOf(verdict.first_contact->contact.shape);
  entryOf(name, true, message).collision = true;
}

void addContact(const Verdict& verdict, const Checker& checker, MonitorStatus& message) {
  if (!verdict.first_contact) return;
  const WayContact& first = *verdict.first_contact;
  message.time_to_contact_s = first.time_s;
  message.distance_to_contact_m = first.distance_m;
  message.contact_link = checker.model()->linkOf(first.contact.shape);
  message.contact_cuboid =
      toFlag(*checker.map(), first.contact.cuboid, tccm_monitor::Cuboid::COLLISION);
  if (!first.by_margin) message.flagged.push_back(message.contact_cuboid);
}

std::vector<std::string> namesOf(const Verdict& verdict) {
  std::vector<std::string> names;
  for (const Reason reason : verdict.reasons) names.emplace_back(name(reason));
  return names;
}

}  // namespace

CuboidFlag toFlag(const CuboidMap& map, std::uint32_t index, std::uint8_t col) {
  const Cuboid& cuboid = map.cuboids[index];
  CuboidFlag flag;
  flag.cell = cuboid.cell;
  flag.bottom = static_cast<float>(map.grid.metres(cuboid.bottom));
  flag.top = static_cast<float>(map.grid.metres(cuboid.top));
  flag.col = col;
  return flag;
}

void toMessage(const Verdict& verdict, const Checker& checker,
               tccm_monitor::MonitorStatus& message) {
  message.header.stamp = toRos(verdict.stamp);
  message.level = static_cast<std::uint8_t>(verdict.level);
  message.reason = name(verdict.reason);
  message.reasons = namesOf(verdict);
  message.detail = verdict.detail;
  message.speed_scale = verdict.speed_scale;
  message.latched = verdict.latched == Reason::kClear ? "" : name(verdict.latched);
  message.link = verdict.link;
  message.known = verdict.known;
  message.stop = verdict.stop;
  message.collision = verdict.collision;
  message.occlusion = verdict.occlusion;
  message.serial = verdict.serial;
  message.joints_stamp = toRos(verdict.joints_stamp);
  message.follows_trajectory = verdict.follows_trajectory;
  message.governed_scale = verdict.placed ? static_cast<float>(verdict.governed_scale) : kNotKnown;
  message.unseen_fraction =
      verdict.placed ? static_cast<float>(verdict.unseen_fraction) : kNotKnown;
  message.exemptions.clear();
  for (const Exemption& exemption : checker.exemptions()) {
    message.exemptions.emplace_back();
    message.exemptions.back().owner = exemption.owner;
    message.exemptions.back().link = exemption.link;
    message.exemptions.back().region = toMessage(exemption.region);
    message.exemptions.back().until = toRos(exemption.until);
  }
  message.attached_objects.clear();
  for (const AttachedObject& object : checker.attached()) {
    message.attached_objects.push_back(object.name);
  }
  message.links.clear();
  message.flagged.clear();
  addLinks(verdict.now, false, checker, message);
  addClearances(verdict.clearances, *checker.model(), message);
  if (verdict.placed) addEvidence(checker.evidence().findings(), *checker.model(), message);
  addLinks(verdict.ahead, true, checker, message);
  addContactLink(verdict, checker, message);
  message.time_to_contact_s = message.distance_to_contact_m =
      std::numeric_limits<double>::infinity();
  message.contact_link.clear();
  const CuboidMap* map = checker.map();
  message.map_stamp = map ? toRos(map->stamp) : ros::Time();
  message.cuboids = map ? static_cast<std::uint32_t>(map->cuboids.size()) : 0;
  message.held = map ? static_cast<std::uint32_t>(heldIn(*map)) : 0;
  message.window_scans = map ? map->window_scans : 0;
  if (!map) return;
  addContact(verdict, checker, message);
  addFlags(verdict.now, *map, message);
  addFlags(verdict.ahead, *map, message);
}

void toMessage(const Verdict& verdict, tccm_monitor::MotionPermission& message) {
  message.level = static_cast<std::uint8_t>(verdict.level);
  message.permitted = !verdict.stop;
  message.speed_scale = verdict.stop ? 0.0 : verdict.speed_scale;
  message.reasons = namesOf(verdict);
  message.detail = verdict.detail;
}

}  // namespace tccm
