#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "fuzz/promises.h"
#include "robot/kinematics.h"
#include "robot/link_use.h"
#include "support/mesh_texts.h"
#include "support/random.h"
#include "tccm_monitor/config_error.h"
#include "tccm_monitor/robot_model.h"

/// What the fuzz target of RobotModel and the test of its corpus do with an input: a byte that
/// chooses the configuration, and a URDF.
namespace tccm::test {

/// The files that inputs may refer to.
inline std::string fuzzedResource(const std::string& uri) {
  static const std::map<std::string, std::string> files{
      {"p/a.stl", binaryStl({{Vector3(0, 0, 0), Vector3(0.1, 0, 0), Vector3(0, 0.2, 0)},
                             {Vector3(0, 0, 0), Vector3(0.1, 0, 0), Vector3(0, 0, 0.3)}})},
      {"p/b.stl", kAsciiStl},
      {"p/c.obj", kObj},
      {"p/d.dae", collada({})},
      {"p/e.obj", ""},
      {"primitives.yaml",
       "links:\n"
       "  a:\n"
       "    - {shape: box, size: [0.1, 0.2, 0.3], xyz: [0, 0, 1]}\n"
       "    - {shape: capsule, radius: 0.1, length: 0, rpy: [0, 1, 0]}\n"}};
  const auto found = files.find(uri);
  if (found == files.end()) throw ConfigError(uri + ": there is no such file");
  return found->second;
}

/// The name in the first tag that begins like this; empty where there is none.
inline std::string firstNameAfter(const std::string& urdf, const std::string& tag) {
  const std::size_t begin = urdf.find(tag);
  if (begin == std::string::npos) return {};
  const std::size_t end = urdf.find('"', begin + tag.size());
  return end == std::string::npos ? "" : urdf.substr(begin + tag.size(), end - begin - tag.size());
}

inline RobotModel::Config fuzzedConfig(unsigned choice, const std::string& urdf) {
  RobotModel::Config config;
  const auto chosen = [choice](unsigned bit) { return (choice >> bit & 1U) != 0; };
  if (chosen(0)) config.visual_links = {"*"};
  if (chosen(1)) config.capsule_links = {"*"};
  const std::string joint = firstNameAfter(urdf, "<joint name=\"");
  if (chosen(2) && !joint.empty()) config.fixed_joints[joint] = 0.1;
  if (chosen(3)) config.link_groups["some"] = {"a*", "[b-d]*"};
  if (chosen(3) && chosen(4)) config.monitored_links = {"some"};
  if (!chosen(3) && chosen(4)) config.ignored_links = {"b*", "?"};
  if (chosen(5)) config.primitives_file = "primitives.yaml";
  config.apply_mesh_up_axis = chosen(6);
  if (chosen(7)) config.fit.primitives_max = 1;
  return config;
}

inline void requireTree(const RobotModel& model) {
  promise(!model.links().empty(), "there is no link");
  const std::set<std::string> names(model.links().begin(), model.links().end());
  promise(names.size() == model.links().size(), "a link is there twice");
  std::vector<bool> placed(model.links().size(), false);
  for (const std::size_t root : model.roots()) placed.at(root) = true;
  for (const RobotJoint& joint : model.joints()) {
    const std::string owner = "joint '" + joint.name + "': ";
    promise(joint.parent < joint.child, owner + "its parent comes after its child");
    promise(placed.at(joint.parent) && !placed.at(joint.child), owner + "it closes a circle");
    placed.at(joint.child) = true;
    promise(isRigid(joint.T_parent_joint), owner + "its pose is not rigid");
    if (joint.motion == RobotJoint::Motion::kFixed) continue;
    promise(std::abs(joint.axis.norm() - 1.0) < 1e-9, owner + "its axis is not of length 1");
    promise(joint.variable < model.variables().size(), owner + "nothing moves it");
    promise(std::isfinite(joint.multiplier) && std::isfinite(joint.offset),
            owner + "its mimic is not finite");
  }
  promise(std::find(placed.begin(), placed.end(), false) == placed.end(), "a link hangs nowhere");
  for (const JointVariable& variable : model.variables()) {
    promise(variable.lower.value_or(-1.0) <= variable.upper.value_or(1e300),
            "variable '" + variable.name + "': its limits are crossed");
  }
}

inline void requireShapes(const RobotModel& model) {
  for (const LinkShape& shape : model.shapes()) {
    promise(shape.link < model.links().size(), "a shape has no link");
    promise(isRigid(shape.T_link_shape), "a shape's pose is not rigid");
    try {
      validate(shape.shape, "a shape");
    } catch (const ConfigError& error) {
      throw BrokenPromise(error.what());
    }
  }
  std::size_t covered = 0;
  for (const LinkElement& element : model.elements()) {
    promise(element.first_shape == covered, "the elements do not follow each other");
    promise(element.shapes > 0, "an element has no shape");
    promise(std::isfinite(element.hull_volume_m3), "a volume is not finite");
    covered += element.shapes;
  }
  promise(covered == model.shapes().size(), "a shape belongs to no element");
}

inline void requirePoses(const std::shared_ptr<const RobotModel>& model) {
  Random random(1);
  Kinematics kinematics(model);
  for (const double reach : {1.0, 1e6}) {
    std::vector<double> positions;
    for (std::size_t i = 0; i < model->variables().size(); ++i) {
      positions.push_back(random.uniform(-reach, reach));
    }
    std::vector<Pose> roots;
    for (std::size_t i = 0; i < model->roots().size(); ++i) roots.push_back(random.pose(10.0));
    kinematics.update(positions, roots);
    for (const Pose& pose : kinematics.linkPoses()) promise(isRigid(pose), "a link's pose");
    for (const Pose& pose : kinematics.shapePoses()) promise(isRigid(pose), "a shape's pose");
  }
}

inline void requireUses(const RobotModel& model) {
  LinkUse first_alone(Expansion{1.1, 0.01});
  first_alone.links = {model.linkOf(0)};
  for (const auto& [use, keys] : {std::pair{LinkUse(Expansion{1.0, 0.06}), kSelfFilterKeys},
                                  std::pair{LinkUse(Expansion{3.0, 1.0}), kCollisionKeys},
                                  std::pair{LinkUse(), kOcclusionKeys}}) {
    const UsedShapes used = model.shapesFor(use, keys);
    promise(used.shapes.size() == model.shapes().size(), "a use leaves a shape out");
    for (std::size_t i = 0; i < used.shapes.size(); ++i) {
      const Shape grown = expanded(model.shapes().at(used.shapes[i]).shape, used.expansions.at(i));
      promise(std::isfinite(boundingRadius(grown)), "a grown shape is not finite");
    }
  }
  try {
    (void)model.shapesFor(first_alone, kCollisionKeys);
  } catch (const ConfigError& error) {  // a name may be no pattern of itself: "[a"
    requireOneLine(error.what());
  }
}

/// What the model broke of its promises on an input, or nothing.
inline std::string robotModelDefect(const std::string& input) {
  if (input.empty()) return {};
  const std::string urdf = input.substr(1);
  RobotResources resources;
  resources.read = fuzzedResource;
  return brokenPromise([&] {
    const auto choice = static_cast<unsigned char>(input.front());
    const auto model =
        std::make_shared<const RobotModel>(urdf, fuzzedConfig(choice, urdf), resources);
    requireTree(*model);
    requireShapes(*model);
    requirePoses(model);
    requireUses(*model);
  });
}

}  // namespace tccm::test
