#include "scene.h"

#include <tccm_monitor/Cuboid.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "report_figures.h"

namespace tccm {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kCuboidsMax = 2000;
constexpr std::size_t kFlaggedMax = 500;
constexpr std::size_t kUnseenMax = 300;

/// To a tenth of a millimetre.
double metres(double value) { return std::nearbyint(value * 1e4) / 1e4 + 0.0; }

Json corners(const UprightBox& box) {
  const Vector3 &a = box.min(), &b = box.max();
  return {metres(a.x()), metres(a.y()), metres(a.z()), metres(b.x()), metres(b.y()), metres(b.z())};
}

void addPose(const Pose& pose, Json& json) {
  json["position"] = coordinates(Vector3(pose.translation()));
  Json rows = Json::array();
  const Eigen::Matrix3d turn = pose.linear();
  for (Eigen::Index row = 0; row < 3; ++row) {
    for (Eigen::Index column = 0; column < 3; ++column) {
      rows.push_back(rounded(turn(row, column)));
    }
  }
  json["rotation"] = std::move(rows);
}

/// A box's half sides, or radius and half length, or radius.
Json sizeOf(const Shape& shape) {
  if (const auto* box = std::get_if<Box>(&shape)) return coordinates(box->half_extents);
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    return {metres(cylinder->radius), metres(cylinder->half_length)};
  }
  if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    return {metres(capsule->radius), metres(capsule->half_length)};
  }
  return Json::array({metres(std::get<Sphere>(shape).radius)});
}

bool isAhead(Reason reason) {
  return reason == Reason::kCollisionAhead || reason == Reason::kOcclusionAhead ||
         reason == Reason::kKeepOutAhead;
}

/// One check and what it knew, for its scene. @pre the robot was placed
class PlacedScene {
 public:
  PlacedScene(const Verdict& verdict, const Checker& checker)
      : verdict_(verdict),
        model_(*checker.model()),
        map_(*checker.map()),
        ahead_(isAhead(verdict.reason)),
        pose_(ahead_ ? checker.checkAhead() : checker.checkHere()),
        findings_(ahead_ ? verdict.ahead : verdict.now) {}

  /// The contact that the verdict names, or else the first.
  [[nodiscard]] std::optional<Contact> contact() const {
    std::vector<Contact> all = findings_.contacts;
    if (ahead_ && verdict_.first_contact) all.push_back(verdict_.first_contact->contact);
    if (verdict_.reason == Reason::kApproached && verdict_.approached) {
      all.insert(all.begin(), *verdict_.approached);
    }
    for (const Contact& contact : all) {
      if (model_.linkOf(contact.shape) == verdict_.link) return contact;
    }
    return all.empty() ? std::nullopt : std::optional(all.front());
  }

  /// Where a primitive is; the model's index. Nothing where it is not checked.
  [[nodiscard]] std::optional<Vector3> placeOf(std::size_t shape) const {
    const UsedBody& used = pose_.collisionBody();
    const auto found = std::find(used.shapes.begin(), used.shapes.end(), shape);
    if (found == used.shapes.end()) return std::nullopt;
    const auto index = static_cast<std::size_t>(found - used.shapes.begin());
    return Vector3(used.body.poses[index].translation());
  }

  /// The middle of a link's primitives.
  [[nodiscard]] std::optional<Vector3> middleOf(const std::string& link) const {
    const UsedBody& used = pose_.collisionBody();
    Vector3 sum = Vector3::Zero();
    double count = 0.0;
    for (std::size_t i = 0; i < used.shapes.size(); ++i) {
      if (model_.links()[used.links[i]] != link) continue;
      sum += Vector3(used.body.poses[i].translation());
      count += 1.0;
    }
    if (count == 0.0) return std::nullopt;
    return Vector3(sum / count);
  }

  /// What all is about.
  [[nodiscard]] std::optional<Vector3> point() const {
    const Reason reason = verdict_.reason;
    const bool touches = reason == Reason::kCollision || reason == Reason::kCollisionAhead ||
                         reason == Reason::kApproached;
    const auto touched = touches ? contact() : std::nullopt;
    if (!touched) return middleOf(verdict_.link);
    const UprightBox box = map_.box(map_.cuboids[touched->cuboid]);
    const Vector3 from = placeOf(touched->shape).value_or(Vector3(box.center()));
    return Vector3(from.cwiseMax(box.min()).cwiseMin(box.max()));
  }

  /// That touch, are hidden or near, at the pose that decides.
  [[nodiscard]] std::set<std::string> concerned(const Checker& checker) const {
    std::set<std::string> links;
    if (!verdict_.link.empty()) links.insert(verdict_.link);
    for (const auto* contacts : {&findings_.contacts, &findings_.keep_out}) {
      for (const Contact& contact : *contacts) links.insert(model_.linkOf(contact.shape));
    }
    for (const LinkVisibility& link : findings_.links) {
      if (checker.checkHere().isOccluded(link)) links.insert(model_.links()[link.link]);
    }
    return links;
  }

 private:
  const Verdict& verdict_;
  const RobotModel& model_;
  const CuboidMap& map_;
  bool ahead_;
  const PoseCheck& pose_;
  const PoseFindings& findings_;
};

/// Each cuboid once. @param prefix of why.
Json flaggedOf(const std::vector<FlaggedBox>& boxes, const std::string& prefix) {
  Json flagged = Json::array();
  std::set<std::string> known;
  for (const auto& [box, col] : boxes) {
    const bool touched = col == tccm_monitor::Cuboid::COLLISION;
    Json entry{{"box", corners(box)},
               {"why", prefix + (touched          ? "touched"
                                 : prefix.empty() ? "hides"
                                                  : "hiding")}};
    if (known.insert(entry.dump()).second) flagged.push_back(std::move(entry));
    if (flagged.size() == kFlaggedMax) break;
  }
  return flagged;
}

std::vector<FlaggedBox> boxesOf(const Verdict& verdict, const CuboidMap& map) {
  std::vector<FlaggedBox> boxes = flaggedBoxes(verdict, map);
  if (verdict.first_contact) {
    const Cuboid& touched = map.cuboids[verdict.first_contact->contact.cuboid];
    boxes.emplace_back(map.box(touched), std::uint8_t{tccm_monitor::Cuboid::COLLISION});
  }
  return boxes;
}

/// Whether a sensor's own map has something there.
bool sees(const CuboidMap& map, const std::vector<FlaggedBox>& boxes) {
  return std::any_of(boxes.begin(), boxes.end(), [&map](const FlaggedBox& flagged) {
    const auto cell = map.grid.cellOf(Vector3(flagged.first.center()));
    if (!cell) return false;
    for (auto i = map.cell_begin[*cell]; i < map.cell_begin[*cell + 1]; ++i) {
      if (map.box(map.cuboids[i]).intersects(flagged.first)) return true;
    }
    return false;
  });
}

Json sensorsOf(const Checker& checker, const std::vector<FlaggedBox>& boxes) {
  Json sensors = Json::array();
  const auto& names = checker.config().inputs.sensors;
  const std::vector<SensorInput>& inputs = checker.inputs().sensors();
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (!inputs[i].map()) continue;
    sensors.push_back({{"name", i < names.size() ? names[i].name : ""},
                       {"position", coordinates(inputs[i].map()->viewpoint)},
                       {"saw", sees(*inputs[i].map(), boxes)}});
  }
  return sensors;
}

/// Those that stand in the fixed frame, or with a link of the robot.
Json regionsOf(const Verdict& verdict, const Checker& checker) {
  Json regions = Json::array();
  const std::vector<std::string>& links = checker.model()->links();
  for (std::size_t i = 0; i < checker.keepOut().size(); ++i) {
    const KeepOutRegion& region = checker.keepOut()[i];
    Pose T_fixed_box = region.T_frame_box;
    const auto link = std::find(links.begin(), links.end(), region.frame);
    if (link != links.end()) {
      const auto index = static_cast<std::size_t>(link - links.begin());
      T_fixed_box = checker.checkHere().posture().T_fixed_links[index] * T_fixed_box;
    }
    const auto touches = [i](const std::vector<Contact>& contacts) {
      return std::any_of(contacts.begin(), contacts.end(),
                         [i](const Contact& contact) { return contact.cuboid == i; });
    };
    Json json{{"name", region.name},
              {"kind", "box"},
              {"size", coordinates(region.box.half_extents)},
              {"touched", touches(verdict.now.keep_out) || touches(verdict.ahead.keep_out)}};
    addPose(T_fixed_box, json);
    regions.push_back(std::move(json));
  }
  return regions;
}

void addPlaced(const Verdict& verdict, const Checker& checker, Json& scene) {
  const PlacedScene placed(verdict, checker);
  scene["robot"] = placedShapes(checker.checkHere(), *checker.model());
  if (isAhead(verdict.reason)) {
    scene["robot_ahead"] = placedShapes(checker.checkAhead(), *checker.model());
  }
  scene["concerned"] = placed.concerned(checker);
  if (verdict.first_contact) {
    scene["first_contact"] = {{"time_s", rounded(verdict.first_contact->time_s)},
                              {"distance_m", metres(verdict.first_contact->distance_m)},
                              {"by_margin", verdict.first_contact->by_margin}};
  }
  const auto point = placed.point();
  if (point) scene["point"] = coordinates(*point);
  if (!checker.keepOut().empty()) scene["regions"] = regionsOf(verdict, checker);
  if (verdict.reason != Reason::kUnseenAhead && verdict.reason != Reason::kEvidenceOld) return;
  Json& unseen = scene["unseen"] = Json::array();
  const std::vector<Vector3>& places = checker.evidence().unseenPlaces();
  const std::size_t step = places.size() / kUnseenMax + 1;
  for (std::size_t i = 0; i < places.size(); i += step) unseen.push_back(coordinates(places[i]));
}

}  // namespace

Json coordinates(const Vector3& place) {
  return {metres(place.x()), metres(place.y()), metres(place.z())};
}

Json placedShapes(const PoseCheck& check, const RobotModel& model) {
  Json shapes = Json::array();
  const UsedBody& used = check.collisionBody();
  for (std::size_t i = 0; i < used.shapes.size(); ++i) {
    Json json{{"link", model.links()[used.links[i]]},
              {"kind", name(used.body.shapes[i])},
              {"size", sizeOf(used.body.shapes[i])}};
    addPose(used.body.poses[i], json);
    shapes.push_back(std::move(json));
  }
  return shapes;
}

Json cuboidsOf(const CuboidMap& map, const Vector3& near, std::size_t count_max) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < map.cuboids.size(); ++i) {
    const double distance = (map.box(map.cuboids[i]).center() - near).squaredNorm();
    order.emplace_back(map.cuboids.size() > count_max ? distance : 0.0, i);
  }
  std::sort(order.begin(), order.end());
  const std::size_t left_out = order.size() - std::min(order.size(), count_max);
  order.resize(order.size() - left_out);
  Json live = Json::array(), held = Json::array();
  for (const auto& [distance, i] : order) {
    const Cuboid& cuboid = map.cuboids[i];
    (cuboid.held ? held : live).push_back(corners(map.box(cuboid)));
  }
  return {{"cuboids", std::move(live)}, {"held", std::move(held)}, {"left_out", left_out}};
}

Json sceneOf(const Verdict& verdict, const Checker& checker, const StopCause& cause) {
  Json scene{{"stamp", stampText(verdict.stamp)},
             {"level", name(verdict.level)},
             {"reason", name(verdict.reason)},
             {"link", verdict.link},
             {"detail", verdict.detail}};
  const CuboidMap* map = checker.map();
  if (verdict.placed && map != nullptr) addPlaced(verdict, checker, scene);
  if (map == nullptr) return scene;
  const bool outlives = cause.outlives(verdict);
  std::vector<FlaggedBox> boxes;
  if (outlives) {
    boxes = cause.boxes();
    scene["cause"] = {{"reason", name(cause.reason())}, {"detail", cause.detail()}};
  } else if (verdict.placed) {
    boxes = boxesOf(verdict, *map);
  }
  scene["flagged"] = flaggedOf(boxes, outlives ? "was_" : "");
  if (!boxes.empty() && (outlives || !scene.contains("point"))) {
    scene["point"] = coordinates(Vector3(boxes.front().first.center()));
  }
  scene["sensors"] = sensorsOf(checker, boxes);
  Vector3 near = map->grid.area().center();
  if (scene.contains("point")) {
    const Json& p = scene["point"];
    near = Vector3(p[0].get<double>(), p[1].get<double>(), p[2].get<double>());
  }
  scene.update(cuboidsOf(*map, near, kCuboidsMax));
  return scene;
}

}  // namespace tccm
