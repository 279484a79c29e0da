#include "robot_picture.h"

#include <filesystem>
#include <system_error>
#include <variant>

#include "program.h"

namespace tccm {
namespace {

using Json = nlohmann::ordered_json;

Json jsonOf(const Pose& pose) {
  Json rows = Json::array();
  for (int row = 0; row < 3; ++row) {
    rows.push_back({pose.matrix()(row, 0), pose.matrix()(row, 1), pose.matrix()(row, 2),
                    pose.matrix()(row, 3)});
  }
  return rows;
}

struct SizeJson {
  Json operator()(const Box& box) const {
    const Vector3 size = 2.0 * box.half_extents;
    return {{"size", {size.x(), size.y(), size.z()}}};
  }
  Json operator()(const Cylinder& c) const {
    return {{"radius", c.radius}, {"length", 2.0 * c.half_length}};
  }
  Json operator()(const Capsule& c) const { return (*this)(Cylinder{c.radius, c.half_length}); }
  Json operator()(const Sphere& s) const { return {{"radius", s.radius}}; }
};

}  // namespace

Json primitivesJson(const RobotModel& model, const std::vector<Pose>& T_fixed_shapes) {
  Json primitives = Json::array();
  for (std::size_t i = 0; i < model.shapes().size(); ++i) {
    Json primitive = std::visit(SizeJson{}, model.shapes()[i].shape);
    primitive["shape"] = name(model.shapes()[i].shape);
    primitive["pose"] = jsonOf(T_fixed_shapes[i]);
    primitives.push_back(primitive);
  }
  return primitives;
}

void drawPrimitives(const Json& scene, const std::string& picture) {
  const std::string file = picture + ".json";
  writeText(file, scene.dump());
  const bool drawn = runScript("draw_primitives", {file, picture}) == kDone;
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
  if (!drawn) throw InputError("the picture " + picture + " could not be drawn");
}

}  // namespace tccm
