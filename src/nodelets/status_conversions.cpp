#include "nodelets/status_conversions.h"

#include <tf2_eigen/tf2_eigen.h>

#include <limits>

#include "ros/conversions.h"

namespace tccm {
namespace {

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

/// What is known of the links at the present pose besides.
void addWatched(const Verdict& verdict, const Checker& checker, MonitorStatus& message) {
  const std::vector<std::string>& links = checker.model()->links();
  for (const LinkClearance& clearance : verdict.clearances) {
    if (clearance.distance_m == std::numeric_limits<double>::infinity()) continue;
    LinkStatus& entry = entryOf(links[clearance.link], false, message);
    entry.clearance = static_cast<float>(clearance.distance_m);
  }
  if (!verdict.placed) return;
  for (const LinkEvidence& link : checker.evidence().findings().links) {
    LinkStatus& entry = entryOf(links[link.link], false, message);
    entry.way_unseen_fraction = static_cast<float>(link.unseen_fraction);
    entry.evidence_age = link.age_s ? static_cast<float>(*link.age_s) : kNotKnown;
    entry.next_look = link.next_look_s ? static_cast<float>(*link.next_look_s) : kInfinity;
  }
}

void addFirstContact(const Verdict& verdict, const Checker& checker, MonitorStatus& message) {
  if (!verdict.first_contact) return;
  const WayContact& first = *verdict.first_contact;
  const std::string& link = checker.model()->linkOf(first.contact.shape);
  // It may be another one than those at the way's end.
  if (!first.by_margin && !verdict.now.collision) entryOf(link, true, message).collision = true;
  if (!checker.map()) return;
  message.time_to_contact_s = first.time_s;
  message.distance_to_contact_m = first.distance_m;
  message.contact_link = link;
  message.contact_cuboid =
      toFlag(*checker.map(), first.contact.cuboid, tccm_monitor::Cuboid::COLLISION);
  if (!first.by_margin) message.flagged.push_back(message.contact_cuboid);
}

void addMap(const Verdict& verdict, const CuboidMap& map, MonitorStatus& message) {
  message.map_stamp = toRos(map.stamp);
  message.cuboids = static_cast<std::uint32_t>(map.cuboids.size());
  message.held = static_cast<std::uint32_t>(heldIn(map));
  message.window_scans = map.window_scans;
  for (const auto& [cuboid, col] : flaggedBy(verdict)) {
    message.flagged.push_back(toFlag(map, cuboid, col));
  }
}

}  // namespace

tccm_monitor::CuboidFlag toFlag(const CuboidMap& map, std::uint32_t index, std::uint8_t col) {
  const Cuboid& cuboid = map.cuboids[index];
  tccm_monitor::CuboidFlag flag;
  flag.cell = cuboid.cell;
  flag.bottom = static_cast<float>(map.grid.metres(cuboid.bottom));
  flag.top = static_cast<float>(map.grid.metres(cuboid.top));
  flag.col = col;
  return flag;
}

std::vector<tccm_monitor::Exemption> exemptionsOf(const Checker& checker) {
  std::vector<tccm_monitor::Exemption> messages;
  for (const Exemption& exemption : checker.exemptions()) {
    const auto pose = checker.regionPose(messages.size());
    tccm_monitor::Exemption& message = messages.emplace_back();
    message.owner = exemption.owner;
    message.link = exemption.link;
    message.frame = exemption.frame;
    message.with_goal = exemption.with_goal;
    message.region = toMessage(exemption.region);
    if (pose) message.pose = tf2::toMsg(*pose);
    message.until = toRos(exemption.until);
    message.why_not = checker.whyNotInForce(exemption);
  }
  return messages;
}

MonitorStatus statusOf(const Verdict& verdict, const Checker& checker) {
  MonitorStatus message;
  message.header.stamp = toRos(verdict.stamp);
  message.level = static_cast<std::uint8_t>(verdict.level);
  message.reason = name(verdict.reason);
  for (const Reason reason : verdict.reasons) message.reasons.emplace_back(name(reason));
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
  message.exemptions = exemptionsOf(checker);
  for (const AttachedObject& object : checker.attached()) {
    message.attached_objects.push_back(object.name);
  }
  addLinks(verdict.now, false, checker, message);
  addWatched(verdict, checker, message);
  addLinks(verdict.ahead, true, checker, message);
  message.time_to_contact_s = message.distance_to_contact_m =
      std::numeric_limits<double>::infinity();
  addFirstContact(verdict, checker, message);
  if (const CuboidMap* map = checker.map()) addMap(verdict, *map, message);
  return message;
}

}  // namespace tccm
