#include "stop_scenes.h"

#include <algorithm>
#include <utility>

#include "report_figures.h"
#include "ros/advice.h"
#include "scene.h"

namespace tccm {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMapCuboidsMax = 12000;

/// The page has some reasons under another level.
std::string adviceOn(Reason reason) {
  static const Advice advice = Advice::ofThePage();
  for (const char* level : {"STOP", "FAULT", "SLOW"}) {
    std::string text = advice.about(name(reason), level);
    if (!text.empty()) return text;
  }
  return {};
}

/// Of a stop, the scenes apart.
Json jsonOf(const Stop& stop, Time start) {
  const StopRun& gravest = gravestOf(stop);
  return {{"from_s", rounded(toSeconds(stop.runs.front()->from - start))},
          {"to_s", rounded(toSeconds(stop.runs.back()->to - start))},
          {"length_s", rounded(toSeconds(stop.length))},
          {"reason", name(gravest.reason)},
          {"link", gravest.link},
          {"detail", gravest.detail},
          {"in_turn", inTurn(stop)},
          {"what_helps", adviceOn(gravest.reason)}};
}

/// All sensors' maps after the last scan.
Json mapsOf(const Evaluation& evaluation, const MonitorConfig& settings) {
  Json maps = Json::array();
  const std::vector<SensorConfig> sensors = settings.sensors();
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    const CuboidMap* map = evaluation.monitor().map(i);
    if (map == nullptr) continue;
    Json json{{"sensor", sensors[i].name}, {"position", coordinates(map->viewpoint)}};
    json.update(cuboidsOf(*map, map->viewpoint, kMapCuboidsMax));
    maps.push_back(std::move(json));
  }
  return maps;
}

}  // namespace

std::optional<std::size_t> StopScenes::placeFor(const Verdict& verdict,
                                                const std::vector<Scene>& scenes) {
  const auto known = std::find_if(scenes.begin(), scenes.end(), [&verdict](const Scene& scene) {
    return scene.reason == verdict.reason && scene.link == verdict.link;
  });
  if (known != scenes.end()) {
    if (known->is_placed || !verdict.placed) return std::nullopt;
    return static_cast<std::size_t>(known - scenes.begin());
  }
  if (scenes.size() < kScenesMax) return scenes.size();
  const bool is_gravest = std::all_of(scenes.begin(), scenes.end(), [&verdict](const Scene& scene) {
    return scene.reason < verdict.reason;
  });
  return is_gravest ? std::optional(scenes.size() - 1) : std::nullopt;
}

void StopScenes::add(const Verdict& verdict, const Checker& checker, Time start) {
  cause_.follow(verdict, checker.map());
  was_placed_ = was_placed_ || verdict.placed;
  const bool begins = verdict.stop && !stopped_;
  stopped_ = verdict.stop;
  if (begins) full_ = stops_.size() == kStopsMax;
  if (!verdict.stop || full_) return;
  if (begins) stops_.emplace_back();
  std::vector<Scene>& scenes = stops_.back();
  const std::optional<std::size_t> place = placeFor(verdict, scenes);
  if (!place) return;
  Json json{{"at_s", rounded(toSeconds(verdict.stamp - start))}};
  json.update(sceneOf(verdict, checker, cause_));
  scenes.resize(std::max(scenes.size(), *place + 1));
  scenes[*place] = {verdict.reason, verdict.link, verdict.placed, std::move(json)};
}

Json StopScenes::json(const Evaluation& evaluation, const MonitorConfig& settings,
                      bool interrupted) const {
  const Totals& totals = evaluation.totals();
  const Grid::Config& area = evaluation.monitor().mapper(0).map().grid().config();
  Json json{{"robot", evaluation.hasRobot() ? Json(evaluation.model().name()) : Json(nullptr)},
            {"fixed_frame", evaluation.fixedFrame()},
            {"area",
             {area.origin_x_m, area.origin_y_m, area.origin_x_m + area.size_x_m,
              area.origin_y_m + area.size_y_m}},
            {"interrupted", interrupted}};
  const std::vector<Stop> stops = stopsOf(totals);
  json["stops_in_all"] = stops.size();
  Json& list = json["stops"] = Json::array();
  for (std::size_t i = 0; i < std::min(stops.size(), stops_.size()); ++i) {
    Json stop = jsonOf(stops[i], *totals.first_stamp);
    Json& scenes = stop["scenes"] = Json::array();
    for (const Scene& scene : stops_[i]) scenes.push_back(scene.json);
    list.push_back(std::move(stop));
  }
  json["maps"] = mapsOf(evaluation, settings);
  if (was_placed_) {
    const Checker& checker = evaluation.monitor().checker();
    json["robot_at_the_end"] = placedShapes(checker.checkHere(), *checker.model());
  }
  return json;
}

}  // namespace tccm
