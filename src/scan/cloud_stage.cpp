#include "scan/cloud_stage.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/line_of.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr double kPlaceStep = 5e-4;  // [s]; at a hand's speed a sensor moves by half a millimetre

}  // namespace

void CloudStage::Config::describe(ParameterTable& table) {
  table.add("self_filter", &self_filter,
            "false: the robot is not filtered out, and need not be known");
  body.describe(table);
  body_filter.describe(table);
  limits.describe(table);
  table.add("range_min_m", &range_min_m, "m", {0.0, 100.0},
            "a point nearer to the sensor says nothing");
  table.add("range_max_m", &range_max_m, "m", {0.1, 1000.0},
            "nor does one further away: what lies there is unknown, not free");
  noise.describe(table);
  thinning.describe(table);
  flying.describe(table);
  support.describe(table);
  looks.describe(table);
  table.add("cloud_unknown_fraction_max", &unknown_fraction_max, "", {0.0, 1.0},
            "a cloud with a larger share of points without a range within the limits is dropped: "
            "the sensor is blind");
  table.add("future_max_s", &future_max_s, "s", {0.0, 10.0},
            "a cloud or joint state stamped further ahead is dropped");
}

void CloudStage::Config::validate() const {
  body.validate();
  if (range_min_m < range_max_m) return;
  throw ConfigError(lineOf("range_min_m, range_max_m: %.3g m has to be less than %.3g m",
                           range_min_m, range_max_m));
}

CloudStage::CloudStage(const Config& config, std::shared_ptr<const RobotModel> model)
    : config_(validated(config)),
      robot_(config.body, config.self_filter ? std::move(model) : nullptr),
      support_(config.support),
      looks_(config.looks) {}

bool CloudStage::addJoints(Time now, Time stamp, const std::vector<std::string>& names,
                           const std::vector<double>& positions,
                           const std::vector<double>& velocities) {
  if (stamp - now > fromSeconds(config_.future_max_s)) return false;
  if (robot_.body()) robot_.body()->joints().add(stamp, names, positions, velocities);
  return true;
}

std::string CloudStage::assemble(const Cloud& cloud, const PosePath& T_fixed_sensor,
                                 const std::vector<PosePath>& T_fixed_roots) {
  std::string unknown = robot_.sample(cloud.first(), cloud.last(), T_fixed_roots);
  if (!unknown.empty()) return unknown;
  if (!place(cloud, T_fixed_sensor)) return "no_transform";
  state_.ranges.resize(cloud.points.size());
  state_.kinds.resize(cloud.points.size());
  sorted_rows_ = within_ = 0;
  // Where no more than a row's neighbours has to be known, each row is sorted while it is at hand.
  const bool by_rows = looks_.isLaidOutFor(cloud);
  if (!by_rows) sortRows(cloud, cloud.height);
  if (!by_rows && isBlind(cloud)) return "blind";
  begin(cloud);
  if (places_.size() == 1) {
    takeRows(cloud, [](std::size_t) { return std::size_t{0}; });
  } else {
    takeRows(cloud, [&](std::size_t i) { return placeOf(cloud, i); });
  }
  if (isBlind(cloud)) return "blind";
  looks_.finish(cloud.organised(), places_, returns_.looks);
  robot_.count(body_filter_.selfCounts());
  return {};
}

/// Both ends and what is between, and of each the sample of the body that is nearest in time.
bool CloudStage::place(const Cloud& cloud, const PosePath& T_fixed_sensor) {
  if (!T_fixed_sensor.covers(cloud.first(), cloud.last())) return false;
  const double duration = cloud.last_offset_s - cloud.first_offset_s;
  places_.resize(1 + static_cast<std::size_t>(std::ceil(duration / kPlaceStep)));
  const std::vector<BodySample>& samples = robot_.samples();
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const Time time =
        std::min(cloud.last(), cloud.first() + fromSeconds(kPlaceStep * static_cast<double>(i)));
    const auto gap = [&](std::size_t k) { return std::chrono::abs(samples[k].stamp - time); };
    while (nearest + 1 < samples.size() && gap(nearest + 1) <= gap(nearest)) ++nearest;
    places_[i] = {*T_fixed_sensor.at(time), nearest};
  }
  return true;
}

std::size_t CloudStage::placeOf(const Cloud& cloud, std::size_t i) const {
  const float since = cloud.offsets_s[i] - static_cast<float>(cloud.first_offset_s);
  if (!(since > 0.0F)) return 0;
  constexpr auto kStep = static_cast<float>(kPlaceStep);
  const auto nearest = static_cast<std::size_t>((since + 0.5F * kStep) / kStep);
  return std::min(nearest, places_.size() - 1);
}

/// Those before row `end` that have not been.
void CloudStage::sortRows(const Cloud& cloud, std::size_t end) {
  const auto nearest = static_cast<float>(config_.range_min_m);
  const auto furthest = static_cast<float>(config_.range_max_m);
  const std::size_t end_point = std::min(end, cloud.height) * cloud.width;
  // A run at a time, so that what is loaded for the one loop is at hand for the other.
  constexpr std::size_t kRun = 1024;
  for (std::size_t begin = sorted_rows_ * cloud.width; begin < end_point; begin += kRun) {
    const std::size_t count = std::min(kRun, end_point - begin);
    const Eigen::Vector3f* const points = &cloud.points[begin];
    float* const ranges = &state_.ranges[begin];
    for (std::size_t i = 0; i < count; ++i) ranges[i] = points[i].squaredNorm();
    BeamKind* const kinds = &state_.kinds[begin];
    std::uint32_t within = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const float range = std::sqrt(ranges[i]);
      const bool is_measured = range > 0.0F && range >= nearest && range <= furthest;  // no NaN
      const bool is_too_close = range > 0.0F && range < nearest;
      kinds[i] = is_measured    ? BeamKind::kReturn
                 : is_too_close ? BeamKind::kTooClose
                                : BeamKind::kUnknown;
      ranges[i] = is_measured ? range : 0.0F;
      within += is_measured ? 1 : 0;
    }
    within_ += within;
  }
  sorted_rows_ = std::max(sorted_rows_, std::min(end, cloud.height));
}

bool CloudStage::isBlind(const Cloud& cloud) const {
  const double unknown_share =
      1.0 - static_cast<double>(within_) / static_cast<double>(cloud.points.size());
  return within_ == 0 || unknown_share > config_.unknown_fraction_max;
}

/// What is known before the first row.
void CloudStage::begin(const Cloud& cloud) {
  support_.apply(cloud, state_);
  body_filter_.draw(config_.body_filter, config_.noise, robot_.samples(), places_);
  looks_.begin(cloud, state_);
  returns_.stamp = cloud.first();
  returns_.tilt = 0.0;
  returns_.is_whole = true;
  returns_.viewpoint = places_.back().T_fixed_sensor.translation();
  returns_.points.clear();
  counts_ = {};
}

/// A row goes through all that follows while it is at hand: a cloud is larger than the cache.
template <typename PlaceOf>
void CloudStage::takeRows(const Cloud& cloud, const PlaceOf& place_of) {
  for (std::size_t row = 0; row < cloud.height; ++row) {
    sortRows(cloud, row + 1 + FlyingPixelFilter::kReach);
    config_.thinning.applyToRow(cloud, looks_.stepRad(), row, state_);
    config_.flying.applyToRow(cloud, config_.noise, row, state_);
    if (!robot_.samples().empty()) filterRow(cloud, row, place_of);
    takeRow(cloud, row, place_of);
    looks_.addRow(cloud, state_, row, place_of);
  }
}

template <typename PlaceOf>
void CloudStage::filterRow(const Cloud& cloud, std::size_t row, const PlaceOf& place_of) {
  const std::size_t end = (row + 1) * cloud.width;
  for (std::size_t i = row * cloud.width; i < end; ++i) {
    if (state_.kinds[i] != BeamKind::kReturn) continue;
    if (!body_filter_.mayMeet(cloud.points[i], state_.ranges[i])) continue;
    state_.kinds[i] = body_filter_.classify(cloud.points[i], state_.ranges[i], place_of(i));
  }
}

template <typename PlaceOf>
void CloudStage::takeRow(const Cloud& cloud, std::size_t row, const PlaceOf& place_of) {
  std::vector<Vector3>& points = returns_.points;
  const std::size_t before = points.size(), first = row * cloud.width;
  points.resize(before + cloud.width);
  Vector3* next = points.data() + before;
  for (std::size_t i = first; i < first + cloud.width; ++i) {
    if (state_.kinds[i] != BeamKind::kReturn) continue;
    *next++ = places_[place_of(i)].T_fixed_sensor * cloud.points[i].cast<double>();
  }
  points.resize(static_cast<std::size_t>(next - points.data()));
  // Neighbours are mostly of one kind: one counter would have to wait for itself.
  std::array<std::array<std::uint32_t, kBeamKinds>, 4> counts{};
  for (std::size_t i = 0; i < cloud.width; ++i) {
    ++counts[i % counts.size()][static_cast<std::size_t>(state_.kinds[first + i])];
  }
  for (const auto& some : counts) {
    for (std::size_t k = 0; k < kBeamKinds; ++k) counts_[k] += some[k];
  }
}

}  // namespace tccm
