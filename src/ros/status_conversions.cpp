#include "tccm_monitor/ros/status_conversions.h"

#include <algorithm>
#include <limits>

#include "tccm_monitor/ros/conversions.h"

namespace tccm {
namespace {

using tccm_monitor::CuboidFlag;
using tccm_monitor::LinkStatus;
using tccm_monitor::MonitorStatus;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

void addLinks(const PoseFindings& findings, const std::vector<LinkClearance>& clearances,
              bool ahead, const Checker& checker, MonitorStatus& message) {
  const RobotModel& model = checker.model();
  const std::size_t first = message.links.size();
  const auto entryOf = [&](const std::string& link) -> LinkStatus& {
    for (std::size_t i = first; i < message.links.size(); ++i) {
      if (message.links[i].link == link) return message.links[i];
    }
    message.links.emplace_back();
    message.links.back().link = link;
    message.links.back().ahead = ahead;
    message.links.back().visible_fraction = 1.0F;
    message.links.back().clearance = kInfinity;
    return message.links.back();
  };
  for (const LinkVisibility& visibility : findings.links) {
    LinkStatus& entry = entryOf(model.links()[visibility.link]);
    entry.visible_fraction = static_cast<float>(visibility.visible_fraction);
    entry.occlusion = checker.poseCheckNow().isOccluded(visibility);
  }
  for (const Contact& contact : findings.contacts) {
    entryOf(model.linkOf(contact.shape)).collision = true;
  }
  for (const LinkClearance& clearance : clearances) {
    if (clearance.distance_m == std::numeric_limits<double>::infinity()) continue;
    entryOf(model.links()[clearance.link]).clearance = static_cast<float>(clearance.distance_m);
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
  const std::string& name = checker.model().linkOf(verdict.first_contact->contact.shape);
  const auto found =
      std::find_if(message.links.begin(), message.links.end(),
                   [&name](const LinkStatus& entry) { return entry.ahead && entry.link == name; });
  if (found != message.links.end()) {
    found->collision = true;
    return;
  }
  LinkStatus entry;
  entry.link = name;
  entry.ahead = entry.collision = true;
  entry.visible_fraction = 1.0F;
  entry.clearance = kInfinity;
  message.links.push_back(entry);
}

void addContact(const Verdict& verdict, const Checker& checker, MonitorStatus& message) {
  if (!verdict.first_contact) return;
  const WayContact& first = *verdict.first_contact;
  message.time_to_contact_s = first.time_s;
  message.distance_to_contact_m = first.distance_m;
  message.contact_link = checker.model().linkOf(first.contact.shape);
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
  message.exemptions.clear();
  for (const Exemption& exemption : checker.exemptions().list()) {
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
  addLinks(verdict.now, verdict.clearances, false, checker, message);
  addLinks(verdict.ahead, {}, true, checker, message);
  addContactLink(verdict, checker, message);
  message.time_to_contact_s = message.distance_to_contact_m =
      std::numeric_limits<double>::infinity();
  message.contact_link.clear();
  const CuboidMap* map = checker.map();
  message.map_stamp = map ? toRos(map->stamp) : ros::Time();
  message.cuboids = map ? static_cast<std::uint32_t>(map->cuboids.size()) : 0;
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
