#include "check/sensor_input.h"

#include <algorithm>
#include <utility>

#include "base/duration_text.h"
#include "base/line_of.h"

namespace tccm {
namespace {

constexpr const char* kFrameChanged = "frame_changed";
constexpr Duration kFrameChangeLasts = std::chrono::seconds(2);

std::string ageText(const std::string& what, Duration age) {
  return what + " " + durationText(age);
}

/// What the sweep takes, for people: 0.02 s is no tilt.
std::string periodText(const CuboidMap& map) {
  if (map.look_period <= Duration::zero()) return "";
  return ", which takes " + durationText(map.look_period);
}

/// What a fault that keeps all scans out of the map is called.
Reason reasonOf(const std::string& dropped) {
  if (dropped == "blind") return Reason::kBlind;
  if (dropped == "future_stamp") return Reason::kFuture;
  if (dropped == "no_transform" || dropped == "transform_gap") return Reason::kNoTransform;
  return Reason::kNoMap;
}

}  // namespace

void SensorInput::Config::describe(ParameterTable& table) {
  table.add("name", &name, "of the namespace that its assembler and mapper are in");
  table.add("required", &required,
            "false: the robot may go on where it fails; what it alone saw grows old by place");
}

void SensorInput::Limits::describe(ParameterTable& table) {
  table.add("scan_timeout_periods", &scan_timeout_periods, "periods", {1.0, 100.0},
            "without a new map, in measured scan periods");
  table.add("map_age_max_s", &map_age_max_s, "s", {0.001, 10.0},
            "from the newest scan's stamp to the check");
  table.add(
      "self_filter_fraction_max", &self_filter_fraction_max, "", {0.1, 1.0},
      "share of the returns inside the area and below it that may be taken for the robot, over a "
      "period of the tilt, where 50 a scan or more lie there; above it the sensor is blind");
  table.add("future_max_s", &future_max_s, "s", {0.0, 10.0},
            "a scan or joint state may lead the check by this");
}

void SensorInput::addScanReport(Time now, const ScanReport& report) {
  using Outcome = ScanReport::Outcome;
  if (report.outcome == Outcome::kWaiting) report_arrival_ = now;
  if (report.outcome == Outcome::kAssembled) assembled_ = now;
  if (report.outcome == Outcome::kWaiting) return;
  last_report_ = report;
  if (report.outcome == Outcome::kAssembled) self_link_ = report.self_link;
  if (report.dropped != kFrameChanged) return;
  frame_changed_ = now;
  frame_change_ = report.detail;
}

void SensorInput::setMap(Time now, std::shared_ptr<const CuboidMap> map) {
  if (map_ && map->stamp > map_->stamp) {
    gaps_s_[gaps_++ % gaps_s_.size()] = toSeconds(map->stamp - map_->stamp);
    measurePeriod();
  }
  // The same map again is no news of the sensor; what it was told to forget may be.
  const bool is_news = !map_ || map->stamp != map_->stamp || map->serial != map_->serial;
  map_ = std::move(map);
  if (is_news) map_arrival_ = now;
}

/// Of the last few gaps, so that a pause is forgotten, and what came before these changes nothing.
/// The longest do not count: one pause must not teach it to be patient.
void SensorInput::measurePeriod() {
  auto gaps = gaps_s_;
  const std::size_t count = std::min(gaps_, gaps.size());
  const auto quartile = gaps.begin() + static_cast<std::ptrdiff_t>(3 * (count - 1) / 4);
  std::nth_element(gaps.begin(), quartile, gaps.begin() + static_cast<std::ptrdiff_t>(count));
  scan_period_s_ = *quartile;
}

void SensorInput::reset() {
  map_.reset();
  gaps_ = 0;
  scan_period_s_.reset();
  report_arrival_.reset();
  assembled_.reset();
  last_report_ = {};
  frame_changed_.reset();
}

Duration SensorInput::silenceMax(const Limits& limits) const {
  if (!scan_period_s_) return fromSeconds(limits.map_age_max_s);
  return fromSeconds(std::min(limits.scan_timeout_periods * *scan_period_s_, limits.map_age_max_s));
}

bool SensorInput::scansCome(const Question& question) const {
  return report_arrival_ && question.now - *report_arrival_ <= silenceMax(question.limits);
}

Cause SensorInput::silenceCause(const Question& question) const {
  const Time now = question.now;
  if (report_arrival_ && !scansCome(question)) {
    return {Reason::kNoMap, ageText("no scan for", now - *report_arrival_)};
  }
  const Duration silence = now - (map_ ? map_arrival_ : question.started);
  if (!report_arrival_) return {Reason::kNoMap, ageText("no scan was mapped for", silence)};
  const std::string &dropped = last_report_.dropped, &detail = last_report_.detail;
  if (!dropped.empty()) {
    return {reasonOf(dropped), ageText("scans are dropped (" + dropped + ") for", silence) +
                                   (detail.empty() ? "" : ": " + detail)};
  }
  return {Reason::kNoMap, ageText("scans come, but none was mapped for", silence)};
}

Cause SensorInput::mapCause(const Question& question) const {
  const Time now = question.now;
  const Duration age_max = fromSeconds(question.limits.map_age_max_s);
  if (!map_) {
    if (now - question.started <= age_max) return {Reason::kInit, "waiting for the first scan"};
    return silenceCause(question);
  }
  const Duration age = now - map_->stamp, silence_max = silenceMax(question.limits);
  if (-age > fromSeconds(question.limits.future_max_s)) {
    return {Reason::kFuture, ageText("the newest scan is stamped in the future, by", -age)};
  }
  // Scans that wait for transforms may wait as long as these may be missing; blind ones may not.
  const std::string& dropped = last_report_.dropped;
  const bool lacks_transforms = dropped.empty() || reasonOf(dropped) == Reason::kNoTransform;
  const bool waits = scansCome(question) && lacks_transforms &&
                     !(assembled_ && *assembled_ - map_arrival_ > silence_max);
  if (now - map_arrival_ > silence_max && !waits) return silenceCause(question);
  if (age > age_max) {
    // Scans may wait for joint states as well.
    if (waits && question.joints_known) {
      return {Reason::kNoTransform,
              ageText("scans wait for transforms; the newest in the map is older than", age_max)};
    }
    return {Reason::kMapLate, ageText("the newest scan in the map is older than", age_max)};
  }
  if (map_->overflowed) return {Reason::kMapOverflow, "points were left out of the map"};
  if (map_->tilt_stopped) {
    return {Reason::kSweepIncomplete, "the sensor's tilt stands still, or does not turn in time"};
  }
  if (!map_->complete) {
    return {Reason::kInit, "the map does not hold a whole sweep yet" + periodText(*map_)};
  }
  return {};
}

void SensorInput::append(const Cause& cause, std::vector<Cause>& causes) const {
  if (cause.reason == Reason::kClear) return;
  causes.push_back(cause);
  if (!name().empty()) causes.back().detail = "sensor '" + name() + "': " + cause.detail;
}

void SensorInput::appendCauses(const Question& question, std::vector<Cause>& causes) const {
  if (frame_changed_ && question.now - *frame_changed_ <= kFrameChangeLasts) {
    append({Reason::kFrameChanged, frame_change_}, causes);
  }
  const double share_max = question.limits.self_filter_fraction_max;
  if (map_ && map_->self_share && *map_->self_share > share_max) {
    append(
        {Reason::kBlind,
         lineOf("the self filter takes %.0f %% of what lies inside the area and below it, at most "
                "%.0f %% are believed (self_filter_fraction_max); most of it for '%.100s': see "
                "whether it is described too large",
                100.0 * *map_->self_share, 100.0 * share_max, self_link_.c_str()),
         self_link_},
        causes);
  }
  append(mapCause(question), causes);
}

}  // namespace tccm
