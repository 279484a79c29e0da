#include "rviz/status_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

namespace tccm {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using tccm_monitor::MonitorStatus;

const char* const kNone = "-";

std::string number(double value, int digits, const char* unit) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f %s", digits, value, unit);
  return text.data();
}

std::string milliseconds(float seconds) {
  return std::isfinite(seconds) ? number(1e3 * static_cast<double>(seconds), 1, "ms") : "?";
}

std::string contactText(const MonitorStatus& status) {
  if (!std::isfinite(status.time_to_contact_s)) return kNone;
  std::string text = status.contact_link + " in " + number(status.time_to_contact_s, 2, "s");
  if (std::isfinite(status.distance_to_contact_m)) {
    text += ", " + number(status.distance_to_contact_m, 3, "m");
  }
  return text;
}

/// Of the link that is the nearest to anything.
std::string clearanceText(const MonitorStatus& status) {
  const tccm_monitor::LinkStatus* nearest = nullptr;
  for (const tccm_monitor::LinkStatus& link : status.links) {
    if (link.ahead || !std::isfinite(link.clearance)) continue;
    if (nearest == nullptr || link.clearance < nearest->clearance) nearest = &link;
  }
  if (nearest == nullptr) return "nothing near";
  return number(static_cast<double>(nearest->clearance), 3, "m") + ", " + nearest->link;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text.empty() ? kNone : text;
}

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

}  // namespace

std::string levelName(std::uint8_t level) {
  switch (level) {
    case MonitorStatus::OK:
      return "OK";
    case MonitorStatus::SLOW:
      return "SLOW";
    case MonitorStatus::STOP:
      return "STOP";
    case MonitorStatus::FAULT:
      return "FAULT";
    default:
      return "UNKNOWN";
  }
}

std::string reasonOf(const MonitorStatus& status) {
  if (status.stopped_by.empty() || status.stopped_by == status.reason) return status.reason;
  return status.stopped_by + ", now " + status.reason;
}

std::string detailOf(const MonitorStatus& status) {
  return status.stopped_by.empty() ? status.detail : status.stopped_by_detail;
}

std::vector<TextRow> rowsOf(const MonitorStatus& status) {
  return {{"Link", status.link.empty() ? kNone : status.link},
          {"Contact ahead", contactText(status)},
          {"Clearance", clearanceText(status)},
          {"Speed scale", number(100.0 * status.speed_scale, 0, "%")},
          {"Latency", milliseconds(status.ready_to_verdict_s) + ", from the first beam " +
                          milliseconds(status.scan_to_verdict_s)},
          {"Map", std::to_string(status.cuboids) + " cuboids, " + std::to_string(status.held) +
                      " held, " + std::to_string(status.window_scans) + " scans"},
          {"Holds", joined(status.attached_objects)},
          {"Until reset", status.latched.empty() ? kNone : status.latched}};
}

bool refusesReset(const MonitorStatus& status) {
  if (status.level == MonitorStatus::FAULT) return true;
  const auto isContact = [](const std::string& reason) {
    return reason == "COLLISION" || reason == "KEEP_OUT";
  };
  // Of a fault that is over the latch is lifted whatever is touched.
  if (!status.latched.empty() && !isContact(status.latched)) return false;
  return std::any_of(status.reasons.begin(), status.reasons.end(), isContact) ||
         std::any_of(status.links.begin(), status.links.end(),
                     [](const auto& link) { return !link.ahead && link.collision; });
}

void LastStop::take(const MonitorStatus& status, double now_s) {
  const bool counts = could_move_ || !status.latched.empty();
  const bool lasted = std::exchange(lasts_, counts && status.level >= MonitorStatus::STOP);
  could_move_ = could_move_ || status.level < MonitorStatus::STOP;
  if (!lasts_) return;
  const std::string& reason = status.stopped_by.empty() ? status.reason : status.stopped_by;
  if (!lasted || reason != reason_) link_.clear();
  if (status.reason == reason && !status.link.empty()) link_ = status.link;
  reason_ = reason;
  at_s_ = now_s;
}

std::string LastStop::text(double now_s) const {
  if (reason_.empty()) return "none yet";
  const std::string when = lasts_ ? "now" : number(now_s - at_s_, 0, "s ago");
  return reason_ + (link_.empty() ? "" : ", " + link_) + ", " + when;
}

SensorHealth::SensorHealth(const std::string& name_space)
    : prefix_(name_space.substr(std::min<std::size_t>(1, name_space.size()))) {
  if (!prefix_.empty()) prefix_ += "/";
}

void SensorHealth::take(const diagnostic_msgs::DiagnosticArray& message, double now_s) {
  for (const DiagnosticStatus& status : message.status) {
    const std::string node = status.name.substr(0, status.name.find(": "));
    if (node.compare(0, prefix_.size(), prefix_) != 0) continue;
    const bool of_sensor = endsWith(node, "tilt_scan_assembler") ||
                           endsWith(node, "cloud_assembler") || endsWith(node, "tccm_mapper");
    if (!of_sensor) continue;
    heard_[status.name.substr(prefix_.size())] = {static_cast<std::uint8_t>(status.level),
                                                  status.message, now_s};
  }
}

std::vector<SensorHealth::Line> SensorHealth::lines(double now_s) const {
  std::vector<Line> lines;
  for (const auto& [name, heard] : heard_) {
    const double silence = now_s - heard.at_s;
    if (silence > kSilence_s) {
      lines.push_back({DiagnosticStatus::STALE, name, "silent for " + number(silence, 0, "s")});
    } else {
      lines.push_back({heard.level, name, heard.text});
    }
  }
  return lines;
}

}  // namespace tccm
