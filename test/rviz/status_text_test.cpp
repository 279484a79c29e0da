#include "rviz/status_text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>

namespace tccm {
namespace {

using diagnostic_msgs::DiagnosticArray;
using diagnostic_msgs::DiagnosticStatus;
using tccm_monitor::MonitorStatus;

constexpr double kInf = std::numeric_limits<double>::infinity();

std::string row(const MonitorStatus& status, const std::string& name) {
  for (const TextRow& row : rowsOf(status)) {
    if (row.name == name) return row.text;
  }
  return "no such row";
}

tccm_monitor::LinkStatus link(const std::string& name, float clearance, bool ahead = false) {
  tccm_monitor::LinkStatus link;
  link.link = name;
  link.clearance = clearance;
  link.ahead = static_cast<std::uint8_t>(ahead);
  return link;
}

DiagnosticArray array(const std::string& name, int level, const std::string& text) {
  DiagnosticArray message;
  message.status.emplace_back();
  message.status.back().name = name;
  message.status.back().level = static_cast<signed char>(level);
  message.status.back().message = text;
  return message;
}

TEST(StatusTextTest, EveryLevelHasItsName) {
  EXPECT_EQ(levelName(MonitorStatus::OK), "OK");
  EXPECT_EQ(levelName(MonitorStatus::FAULT), "FAULT");
  EXPECT_EQ(levelName(77), "UNKNOWN");
}

TEST(StatusTextTest, WhatBroughtAStopAboutComesFirst) {
  MonitorStatus status;
  status.reason = "CLEAR";
  EXPECT_EQ(reasonOf(status), "CLEAR");
  status.reason = status.stopped_by = "COLLISION_AHEAD";
  status.detail = status.stopped_by_detail = "hand touches the map";
  EXPECT_EQ(reasonOf(status), "COLLISION_AHEAD");
  status.reason = "RELEASING";
  status.detail = "clear, but not for long enough";
  EXPECT_EQ(reasonOf(status), "COLLISION_AHEAD, now RELEASING");
  EXPECT_EQ(detailOf(status), "hand touches the map");
}

TEST(StatusTextTest, TheClearanceIsThatOfTheNearestLinkWhereItIs) {
  MonitorStatus status;
  status.links = {link("far", 0.3F), link("near", 0.123F), link("nowhere", INFINITY),
                  link("ahead", 0.01F, true), link("unknown", NAN)};
  EXPECT_EQ(row(status, "Clearance"), "0.123 m, near");
  status.links.clear();
  EXPECT_EQ(row(status, "Clearance"), "nothing near");
}

TEST(StatusTextTest, AContactAheadHasLinkTimeAndDistance) {
  MonitorStatus status;
  status.time_to_contact_s = status.distance_to_contact_m = kInf;
  EXPECT_EQ(row(status, "Contact ahead"), "-");
  status.time_to_contact_s = 0.31;
  status.contact_link = "hand";
  EXPECT_EQ(row(status, "Contact ahead"), "hand in 0.31 s");
  status.distance_to_contact_m = 0.0825;
  EXPECT_EQ(row(status, "Contact ahead").substr(0, 15), "hand in 0.31 s,");
}

TEST(StatusTextTest, WhatIsNotKnownIsNotSaidToBeNone) {
  MonitorStatus status;
  status.ready_to_verdict_s = status.scan_to_verdict_s = NAN;
  EXPECT_EQ(row(status, "Latency"), "?, from the first beam ?");
}

TEST(SensorHealthTest, TheSensorsOfANamespaceAreTold) {
  SensorHealth health("/left");
  health.take(array("left/laser/tccm_mapper: map", DiagnosticStatus::OK, "fine"), 0.0);
  health.take(array("left/laser/tilt_scan_assembler: scans", DiagnosticStatus::WARN, "odd"), 0.0);
  health.take(array("left/collision_checker: checks", DiagnosticStatus::ERROR, "no"), 0.0);
  health.take(array("right/laser/tccm_mapper: map", DiagnosticStatus::ERROR, "no"), 0.0);
  const auto lines = health.lines(1.0);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].name, "laser/tccm_mapper: map");
  EXPECT_EQ(lines[0].text, "fine");
  EXPECT_EQ(lines[1].level, DiagnosticStatus::WARN);
}

TEST(SensorHealthTest, WhatWasHeardLongAgoIsSilent) {
  SensorHealth health;
  health.take(array("tccm_mapper: map", DiagnosticStatus::OK, "fine"), 0.0);
  EXPECT_EQ(health.lines(2.0).front().level, DiagnosticStatus::OK);
  EXPECT_EQ(health.lines(4.0).front().level, DiagnosticStatus::STALE);
  EXPECT_EQ(health.lines(4.0).front().text, "silent for 4 s");
}

}  // namespace
}  // namespace tccm
