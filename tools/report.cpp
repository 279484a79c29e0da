#include "report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <set>

#include "base/line_of.h"
#include "check/model_agreement.h"
#include "program.h"
#include "report_figures.h"

namespace tccm {
namespace {

using Json = nlohmann::ordered_json;

/// Nearest rank. @param sorted ascending, not empty.
double percentile(const std::vector<double>& sorted, double p) {
  const auto rank = static_cast<std::size_t>(std::ceil(p * static_cast<double>(sorted.size())));
  return sorted[std::max<std::size_t>(rank, 1) - 1];
}

Json percentiles(std::vector<double> values) {
  if (values.empty()) return {{"p50", nullptr}, {"p99", nullptr}, {"max", nullptr}};
  std::sort(values.begin(), values.end());
  const auto tenths = [](double us) { return std::nearbyint(us * 10.0) / 10.0; };
  return {{"p50", tenths(percentile(values, 0.50))},
          {"p99", tenths(percentile(values, 0.99))},
          {"max", tenths(values.back())}};
}

Json pointsOf(const ScanTotals& totals) {
  const auto of = [&totals](BeamKind kind) { return totals.beams[static_cast<std::size_t>(kind)]; };
  const std::size_t overflowed =
      of(BeamKind::kReturn) - totals.points_mapped - totals.points_out_of_area;
  Json json = {
      {"measured", std::accumulate(totals.beams.begin(), totals.beams.end(), std::size_t{0})},
      {"out_of_range", of(BeamKind::kNoReturn) + of(BeamKind::kTooClose) + of(BeamKind::kUnknown)},
      {"mixed_pixel", of(BeamKind::kMixedPixel)},
      {"self", of(BeamKind::kSelf)},
      {"shadow", of(BeamKind::kShadow)},
      {"out_of_area", totals.points_out_of_area},
      {"mapped", totals.points_mapped},
      {"overflowed", overflowed}};
  if (of(BeamKind::kThinned) > 0) json["thinned"] = of(BeamKind::kThinned);  // a laser's never are
  return json;
}

Json cuboidsOf(const ScanTotals& totals) {
  if (totals.scans_mapped == 0) return {{"mean", nullptr}, {"max", nullptr}};
  const double mean =
      static_cast<double>(totals.cuboids_sum) / static_cast<double>(totals.scans_mapped);
  return {{"mean", rounded(mean)}, {"max", totals.cuboids_max}};
}

Json mapOf(const Evaluation& evaluation, const SensorConfig& settings, std::size_t sensor) {
  const ScanTotals& totals = evaluation.totals().sensors[sensor];
  const IntegrationMap& map = evaluation.monitor().mapper(sensor).map();
  const Grid& grid = map.grid();
  const Grid::Config& config = grid.config();
  const Height thickness = grid.heightOf(settings.mapper.mapper.map.thickness_m);
  const CuboidMap* newest = evaluation.monitor().map(sensor);
  const auto period = evaluation.monitor().mapper(sensor).tiltPeriod();
  return {{"origin_m", {config.origin_x_m, config.origin_y_m}},
          {"cell_size_m", config.cell_size_m},
          {"cells", {grid.cellsX(), grid.cellsY()}},
          {"height_limits_m", {config.height_min_m, config.height_max_m}},
          {"thickness_m", rounded(grid.metres(thickness))},
          {"height_quantum_m", config.height_quantum_m},
          {"window_scans", map.scans()},
          {"last_scan", map.serial()},
          {"window_s", newest ? Json(rounded(toSeconds(newest->window))) : Json(nullptr)},
          {"tilt_period_s", period ? Json(rounded(toSeconds(*period))) : Json(nullptr)},
          {"complete", newest != nullptr && newest->complete},
          {"complete_fraction", fraction(totals.complete_maps, totals.scans_mapped)},
          {"overflowed_fraction", fraction(totals.overflowed_maps, totals.scans_mapped)},
          {"cuboids", cuboidsOf(totals)},
          {"memory_bytes", map.memoryBytes()}};
}

Json droppedOf(const ScanTotals& totals) {
  return totals.scans_dropped.empty() ? Json::object() : Json(totals.scans_dropped);
}

/// By name; what one alone has stands in the summary itself.
Json sensorsOf(const Evaluation& evaluation, const MonitorConfig& settings) {
  Json sensors = Json::object();
  const std::vector<SensorConfig> configs = settings.sensors();
  for (std::size_t i = 0; i < configs.size(); ++i) {
    const ScanTotals& totals = evaluation.totals().sensors[i];
    sensors[configs[i].name] = {{"scans", totals.scans_mapped},
                                {"scans_received", totals.scans_received},
                                {"scans_dropped", droppedOf(totals)},
                                {"points", pointsOf(totals)},
                                {"map", mapOf(evaluation, configs[i], i)}};
  }
  return sensors;
}

Json robotOf(const Evaluation& evaluation) {
  if (!evaluation.hasRobot()) return nullptr;
  const RobotModel& model = evaluation.model();
  std::set<std::size_t> links;
  for (const LinkShape& shape : model.shapes()) links.insert(shape.link);
  Json robot{{"name", model.name()},
             {"links_monitored", links.size()},
             {"primitives", model.shapes().size()},
             {"links_without_shape", model.linksWithoutShape()},
             {"joints_never_published", evaluation.missingJoints()}};
  if (!model.warnings().empty()) robot["warnings"] = model.warnings();
  return robot;
}

/// Where tf and the URDF with joint states put links and sensors.
Json agreementOf(const Evaluation& evaluation, double tolerance_m) {
  if (!evaluation.hasRobot()) return nullptr;
  const ModelAgreement& agreement = evaluation.monitor().checker().agreement();
  Json disagree = Json::array();
  std::size_t compared = 0;
  const ModelAgreement::Compared* worst = nullptr;
  const auto frames = agreement.compared();
  for (const auto& frame : frames) {
    if (frame.comparisons == 0) continue;
    ++compared;
    if (!worst || frame.worst_m > worst->worst_m) worst = &frame;
    if (!frame.did_disagree) continue;
    disagree.push_back({{"link", frame.link},
                        {"against", frame.reference},
                        {"sensor", frame.is_sensor},
                        {"beyond_fraction", fraction(frame.beyond, frame.comparisons)},
                        {"worst_m", rounded(frame.worst_m)}});
  }
  return {{"tolerance_m", tolerance_m},
          {"compared", compared},
          {"worst_m", worst ? Json(rounded(worst->worst_m)) : Json(nullptr)},
          {"worst_link", worst ? Json(worst->link) : Json(nullptr)},
          {"disagree", disagree},
          {"first_disagreement", agreement.firstDisagreement()},
          {"not_compared", agreement.notCompared()}};
}

/// To three digits, for people.
std::string number(const Json& value) {
  if (!value.is_number_float()) return value.is_null() ? "-" : value.dump();
  const double figure = value.get<double>();
  return formatted(std::abs(figure) >= 100.0 ? "%.0f" : "%.3g", figure);
}

std::string percent(const Json& fraction) {
  if (fraction.is_null()) return "-";
  char text[32];
  std::snprintf(text, sizeof text, "%.1f %%", 100.0 * fraction.get<double>());
  return text;
}

}  // namespace

double rounded(double value) { return std::nearbyint(value * 1e6) / 1e6; }

Json fraction(std::size_t part, std::size_t whole) {
  if (whole == 0) return nullptr;
  return rounded(static_cast<double>(part) / static_cast<double>(whole));
}

std::string stampText(Time stamp) {
  const auto nanoseconds = stamp.time_since_epoch().count();
  char text[40];
  std::snprintf(text, sizeof text, "%lld.%09lld", static_cast<long long>(nanoseconds / 1000000000),
                static_cast<long long>(nanoseconds % 1000000000));
  return text;
}

CsvFile::CsvFile(const std::string& path, const std::string& header) : path_(path), stream_(path) {
  stream_ << header << '\n';
  if (!stream_) throw InputError("cannot write " + path_);
}

void CsvFile::write(const char* text, int length) {
  stream_.write(text, length);
  stream_ << '\n';
}

void CsvFile::close() {
  stream_.close();
  if (!stream_) throw InputError("cannot write all of " + path_);
}

void dumpPoints(const Monitor& monitor, std::size_t sensor, CsvFile& file) {
  const CuboidMap& map = *monitor.map(sensor);
  for (const Vector3& exact : monitor.returns(sensor).points) {
    const Vector3 p(Grid::toMicrometre(exact.x()), Grid::toMicrometre(exact.y()),
                    Grid::toMicrometre(exact.z()));
    if (map.grid.cellOf(p)) file.line("%u,%.6f,%.6f,%.6f", map.serial, p.x(), p.y(), p.z());
  }
}

void dumpCuboids(const CuboidMap& map, CsvFile& file) {
  for (const Cuboid& cuboid : map.cuboids) {
    const Eigen::Vector2d centre = map.grid.centre(cuboid.cell);
    file.line("%.6f,%.6f,%.6f,%.6f,%u,%u,%d", centre.x(), centre.y(),
              map.grid.metres(cuboid.bottom), map.grid.metres(cuboid.top), cuboid.age_scans,
              cuboid.dyn, cuboid.held ? 1 : 0);
  }
}

void dumpVerdict(const Verdict& verdict, CsvFile& file) {
  const bool any = verdict.joints_stamp > Time();
  const std::string stamp = any ? stampText(verdict.joints_stamp) : "";
  file.line("%s,%u,%d,%d,%d,%s,%s", stamp.c_str(), verdict.serial, verdict.collision,
            verdict.occlusion, verdict.stop, name(verdict.reason), verdict.link.c_str());
}

Json summaryOf(const Evaluation& evaluation, const MonitorConfig& settings) {
  const Totals& totals = evaluation.totals();
  const bool any = totals.first_stamp && totals.last_stamp;
  Json summary{
      {"scans", totals.scans_mapped},
      {"scans_received", totals.scans_received},
      {"scans_dropped", droppedOf(totals)},
      {"points", pointsOf(totals)},
      {"map", mapOf(evaluation, settings.sensors().front(), 0)},
      {"robot", robotOf(evaluation)},
      {"agreement", agreementOf(evaluation, settings.checker.checker.inputs.agreement.tolerance_m)},
      {"checks", totals.checks},
      {"collision_fraction", fraction(totals.collisions, totals.checks)},
      {"occlusion_fraction", fraction(totals.occlusions, totals.checks)},
      {"stop_fraction", fraction(totals.stops, totals.checks)},
      {"slow_fraction", fraction(totals.slows, totals.checks)},
      {"unknown_fraction", fraction(totals.checks_unknown, totals.checks)},
      {"sight", sightOf(totals, evaluation.monitor().map())},
      {"stops", stopsOf(totals).size()},
      {"stop_segments", stopSegmentsOf(totals)},
      {"time_jumps", totals.time_jumps},
      {"duration_s",
       any ? Json(rounded(toSeconds(*totals.last_stamp - *totals.first_stamp))) : Json(nullptr)}};
  if (!settings.named_sensors.empty()) {
    summary.erase("map");
    summary["sensors"] = sensorsOf(evaluation, settings);
  }
  return summary;
}

namespace {

void printAgreement(const Json& agreement, std::ostream& out) {
  out << "tf       " << agreement["compared"] << " links and sensors compared with the URDF";
  if (agreement["compared"] > 0) {
    out << lineOf(", at most %.3f m apart (%.80s)", agreement["worst_m"].get<double>(),
                  agreement["worst_link"].get<std::string>().c_str());
  }
  out << "; not compared: " << agreement["not_compared"].size() << "\n";
  const auto first = agreement["first_disagreement"].get<std::string>();
  if (!first.empty()) out << "warning  MODEL_DISAGREES: " << first << "\n";
}

/// Of all sensors, or of one.
void printScans(const Json& summary, const std::string& sensor, std::ostream& out) {
  const Json& map = summary["map"];
  const Json& points = summary["points"];
  out << "scans    " << summary["scans"] << " of " << summary["scans_received"] << " mapped";
  for (const auto& [reason, count] : summary["scans_dropped"].items()) {
    out << ", " << count << " dropped: " << reason;
  }
  out << "\npoints   " << points["mapped"] << " of " << points["measured"] << " mapped";
  for (const char* step : {"out_of_range", "mixed_pixel", "self", "shadow", "out_of_area"}) {
    out << ", " << points[step] << " " << step;
  }
  out << "\nmap      " << number(map["cuboids"]["mean"]) << " cuboids on average, window "
      << map["window_scans"] << " scans, whole in " << percent(map["complete_fraction"])
      << " of the scans\n";
  if (points["overflowed"] > 0) {
    out << "warning  " << points["overflowed"]
        << " points did not fit into the map: raise intervals_max or window_returns_max\n";
  }
  if (points["mapped"] == 0 && points["out_of_area"] > 0) {
    out << "warning  no point of " << sensor << " lies in the map's area: see to area_origin_*_m, "
        << "area_size_*_m, height_*_m and to where the sensor is\n";
  }
}

}  // namespace

Json timesOf(const Totals& totals, bool each) {
  const Timings& timings = totals.timings;
  Json json{{"time_us",
             {{"assemble", percentiles(timings.assemble)},
              {"integrate", percentiles(timings.integrate)},
              {"snapshot", percentiles(timings.snapshot)},
              {"collision", percentiles(timings.collision)},
              {"occlusion", percentiles(timings.occlusion)},
              {"evidence", percentiles(timings.evidence)},
              {"clearance", percentiles(timings.clearance)},
              {"scan_to_verdict", percentiles(timings.scan_to_verdict)}}}};
  if (!each) return json;
  Json& checks = json["scans"];
  checks = {{"time_s", Json::array()}, {"scan_to_verdict_us", Json::array()}};
  for (std::size_t i = 0; i < timings.verdict_at.size(); ++i) {
    const Duration since = timings.verdict_at[i] - *totals.first_stamp;
    checks["time_s"].push_back(std::nearbyint(toSeconds(since) * 1e3) / 1e3);
    checks["scan_to_verdict_us"].push_back(std::nearbyint(timings.scan_to_verdict[i] * 10) / 10);
  }
  return json;
}

void printSummary(const Json& summary, std::ostream& out) {
  if (summary.contains("sensors")) {
    for (const auto& [name, sensor] : summary["sensors"].items()) {
      out << "sensor   " << name << "\n";
      printScans(sensor, name, out);
    }
  } else {
    printScans(summary, "the laser", out);
  }
  const Json& robot = summary["robot"];
  if (!robot.is_null()) {
    out << "robot    " << robot["links_monitored"] << " links monitored, " << robot["primitives"]
        << " primitives; " << robot["links_without_shape"].size() << " links have no shape\n";
    for (const auto& joint : robot["joints_never_published"]) {
      out << "warning  joint " << joint << " was never published\n";
    }
    printAgreement(summary["agreement"], out);
  }
  out << "checks   " << summary["checks"] << ": stop " << percent(summary["stop_fraction"])
      << ", slow " << percent(summary["slow_fraction"]) << ", collision "
      << percent(summary["collision_fraction"]) << ", occlusion "
      << percent(summary["occlusion_fraction"]) << ", unknown "
      << percent(summary["unknown_fraction"]) << "\n";
  const Json& sight = summary["sight"];
  out << "sight    " << number(sight["held"]["mean"]) << " cuboids held on average, unseen ahead "
      << percent(sight["unseen_fraction"]["mean"]) << " on average, too much in "
      << percent(sight["unseen_fraction"]["above_max"]) << " of the checks, oldest evidence "
      << number(sight["evidence_age_s"]["max"]) << " s\n";
  if (summary["time_jumps"] > 0) {
    out << "warning  time jumped back " << summary["time_jumps"]
        << " times; each time all started anew\n";
  }
}

void printTimes(const Json& timing, std::ostream& out) {
  const Json& times = timing["time_us"];
  out << "time     assemble " << number(times["assemble"]["p50"]) << " us, integrate "
      << number(times["integrate"]["p50"]) << " us, scan to verdict "
      << number(times["scan_to_verdict"]["p50"]) << " us (medians)\n";
}

}  // namespace tccm
