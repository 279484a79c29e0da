#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "fit/primitives_file.h"
#include "fit_table.h"
#include "link_primitives.h"
#include "mesh/mesh.h"
#include "monitor_config.h"
#include "program.h"
#include "robot/kinematics.h"

namespace tccm {
namespace {

using Json = nlohmann::json;

struct Options {
  std::string urdf;
  std::string out;
  std::string config;
  std::string package_path;
  std::string picture;
  bool no_picture = false;
  bool no_cache = false;
  double overhang_max_mm = 0.0;
};

void describe(CLI::App& app, Options& options) {
  app.footer(
      "The YAML may be edited; name it in primitives_file of monitored_robot, and the nodelets "
      "take it in place of the fit.\n"
      "Exit status: 0 done, 1 an overhang is larger than asked for, 2 bad input.\n"
      "Example: fit_primitives --urdf robot.urdf --out robot.yaml");
  app.add_option("--urdf", options.urdf, "the robot")->required();
  app.add_option("--out", options.out, "YAML file to write the primitives to")->required();
  app.add_option("--config", options.config,
                 "YAML whose section monitored_robot says which links, and how they are fitted; "
                 "without it every link that has a shape");
  app.add_option("--package-path", options.package_path,
                 "folder with a robot's packages: package://P/x is DIR/P/x where P is there, and "
                 "is looked for among the ROS packages elsewhere");
  app.add_option("--picture", options.picture,
                 "PNG of the primitives over the meshes; beside the YAML where not named");
  app.add_flag("--no-picture", options.no_picture, "draws none");
  app.add_flag("--no-cache", options.no_cache, "fits anew what was fitted before");
  app.add_option("--overhang-max-mm", options.overhang_max_mm,
                 "exit status 1 where a primitive reaches further beyond its mesh; 0: no limit")
      ->check(CLI::NonNegativeNumber);
}

RobotModel readModel(const Options& options) {
  RobotResources resources = resourcesIn(options.package_path);
  if (options.no_cache) resources.fit_cache_folder.clear();
  if (const Progress bar = progressBar()) {
    resources.progress = [bar](std::size_t done, std::size_t all) {
      bar(static_cast<double>(done) / static_cast<double>(all));
    };
  }
  return {readText(options.urdf, "the URDF"), readMonitorConfig(options.config).robot, resources};
}

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

/// Every joint at 0, or at the end of its range that is nearest to it.
std::vector<double> restingPositions(const RobotModel& model) {
  std::vector<double> positions;
  for (const JointVariable& variable : model.variables()) {
    positions.push_back(
        std::clamp(0.0, variable.lower.value_or(-1e9), variable.upper.value_or(1e9)));
  }
  return positions;
}

/// Meshes and primitives in the robot's frame, for scripts/draw_primitives.
Json sceneOf(const Options& options, const RobotModel& model) {
  const RobotResources resources = resourcesIn(options.package_path);
  Kinematics kinematics(std::make_shared<const RobotModel>(model));
  kinematics.update(restingPositions(model),
                    std::vector<Pose>(model.roots().size(), Pose::Identity()));
  Json scene{{"robot", model.name()}, {"meshes", Json::array()}, {"primitives", Json::array()}};
  for (const LinkElement& element : model.elements()) {
    if (element.source != "mesh") continue;
    const Mesh mesh = readMesh(resources.read(element.uri), element.uri,
                               {element.mesh_scale, element.mesh_up_axis});
    const Pose T_root_mesh = kinematics.linkPoses()[element.link] * element.T_link_element;
    Json vertices = Json::array();
    for (const Vector3& vertex : mesh.vertices) {
      const Vector3 p = T_root_mesh * vertex;
      vertices.push_back({p.x(), p.y(), p.z()});
    }
    scene["meshes"].push_back({{"vertices", vertices}, {"triangles", mesh.triangles}});
  }
  for (std::size_t i = 0; i < model.shapes().size(); ++i) {
    Json primitive = std::visit(SizeJson{}, model.shapes()[i].shape);
    primitive["shape"] = name(model.shapes()[i].shape);
    primitive["pose"] = jsonOf(kinematics.shapePoses()[i]);
    scene["primitives"].push_back(primitive);
  }
  return scene;
}

/// @throws InputError where it could not be drawn.
void draw(const Options& options, const RobotModel& model, const std::string& picture) {
  const std::string scene = picture + ".json";
  writeText(scene, sceneOf(options, model).dump());
  const bool drawn = runScript("draw_primitives", {scene, picture}) == kDone;
  std::error_code ignored;
  std::filesystem::remove(scene, ignored);
  if (!drawn) throw InputError("the picture " + picture + " could not be drawn");
}

int fit(Options& options) {
  const auto start = std::chrono::steady_clock::now();
  const RobotModel model = readModel(options);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  tellWarnings(model, "fit_primitives");
  printTable(model, std::cout);
  if (!model.cacheDefect().empty()) {
    std::cout << "fits are not kept for the next start: " << model.cacheDefect() << '\n';
  }
  writeText(options.out,
            writePrimitives(primitivesOf(model),
                            "Primitives of " + model.name() + ", in each link's frame [m, rad]."));
  std::printf("read in %.2f s\nwritten  %s\n", took.count(), options.out.c_str());
  std::fflush(stdout);
  if (!options.no_picture) {
    const std::string picture =
        options.picture.empty()
            ? std::filesystem::path(options.out).replace_extension(".png").string()
            : options.picture;
    draw(options, model, picture);
    std::printf("written  %s\n", picture.c_str());
  }
  const double overhang_mm = 1e3 * totalsOf(model).overhang_m;
  const bool missed = options.overhang_max_mm > 0.0 && overhang_mm > options.overhang_max_mm;
  if (missed) {
    std::fprintf(stderr, "fit_primitives: the largest overhang is %.1f mm, above %.1f mm\n",
                 overhang_mm, options.overhang_max_mm);
  }
  return missed ? kLimitMissed : kDone;
}

}  // namespace
}  // namespace tccm

int main(int argc, char** argv) {
  return tccm::runProgram("fit_primitives",
                          "Covers a robot's meshes with boxes, cylinders, capsules and spheres.",
                          {argv, argv + argc}, tccm::describe, tccm::fit);
}
