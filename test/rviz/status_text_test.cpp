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

MonitorStatus at(std::uint8_t level, const std::string& reason, const std::string& link = "",
                 const std::string& stopped_by = "") {
  MonitorStatus status;
  status.level = level;
  status.reason = reason;
  status.reasons = {reason};
  status.link = link;
  status.stopped_by = stopped_by;
  return status;
}

TEST(LastStopTest, ItIsKeptWithWhatBroughtItAboutAndItsLink) {
  LastStop last;
  last.take(at(MonitorStatus::OK, "CLEAR"), 1.0);
  EXPECT_EQ(last.text(1.0), "none yet");
  last.take(at(MonitorStatus::STOP, "COLLISION_AHEAD", "hand", "COLLISION_AHEAD"), 2.0);
  last.take(at(MonitorStatus::STOP, "RELEASING", "", "COLLISION_AHEAD"), 2.1);
  EXPECT_EQ(last.text(2.1), "COLLISION_AHEAD, hand, now");
  last.take(at(MonitorStatus::OK, "CLEAR"), 2.3);
  EXPECT_EQ(last.text(22.1), "COLLISION_AHEAD, hand, 20 s ago");
  last.take(at(MonitorStatus::STOP, "RELEASING", "", "COLLISION_AHEAD"), 30.0);
  EXPECT_EQ(last.text(30.0), "COLLISION_AHEAD, now") << "of another stop nobody knows the link";
}

TEST(LastStopTest, WhatStopsARobotThatStartsIsNone) {
  LastStop last;
  last.take(at(MonitorStatus::STOP, "INIT"), 1.0);
  last.take(at(MonitorStatus::FAULT, "NO_MAP"), 2.0);
  EXPECT_EQ(last.text(2.0), "none yet");
  MonitorStatus held = at(MonitorStatus::STOP, "AWAITING_RESET", "", "COLLISION");
  held.latched = "COLLISION";
  LastStop heard_late;
  heard_late.take(held, 2.0);
  EXPECT_EQ(heard_late.text(2.0), "COLLISION, now");
  last.take(at(MonitorStatus::SLOW, "UNSEEN_AHEAD"), 3.0);
  last.take(at(MonitorStatus::FAULT, "NO_MAP"), 4.0);
  EXPECT_EQ(last.text(5.0), "NO_MAP, now");
}

TEST(RefusesResetTest, AFaultAndAContactThatLastRefuseIt) {
  EXPECT_TRUE(refusesReset(at(MonitorStatus::FAULT, "NO_JOINTS")));
  EXPECT_TRUE(refusesReset(at(MonitorStatus::STOP, "COLLISION", "hand")));
  EXPECT_TRUE(refusesReset(at(MonitorStatus::STOP, "KEEP_OUT", "hand")));
  EXPECT_FALSE(refusesReset(at(MonitorStatus::STOP, "AWAITING_RESET")));
  EXPECT_FALSE(refusesReset(at(MonitorStatus::STOP, "COLLISION_AHEAD", "hand")));
  MonitorStatus moving_out = at(MonitorStatus::SLOW, "MOVING_OUT");
  moving_out.links = {link("hand", 0.0F)};
  EXPECT_FALSE(refusesReset(moving_out));
  moving_out.links.front().collision = 1;
  EXPECT_TRUE(refusesReset(moving_out));
  MonitorStatus over = at(MonitorStatus::STOP, "COLLISION", "hand");
  over.latched = "NO_JOINTS";
  EXPECT_FALSE(refusesReset(over)) << "what holds is over; the contact will hold in its place";
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
