#pragma once

#include <geometry_msgs/Pose.h>
#include <tccm_monitor/Primitive.h>

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/line_of.h"
#include "ros/conversions.h"
#include "tccm_monitor/config_error.h"

namespace tccm {

/// An attached object as the monitor's services take it.
struct HeldShape {
  std::string link;
  tccm_monitor::Primitive primitive;  ///< its pose in the link's frame

  bool operator==(const HeldShape& other) const {
    return link == other.link && primitive == other.primitive;
  }
};
/// By name.
using HeldShapes = std::map<std::string, HeldShape>;

/// The objects that a planner has attached to the robot, as shapes that the monitor knows. For the
/// messages of moveit_msgs, which need not be there: whatever has the same fields will do.
class PlannerObjects {
 public:
  /// Where a frame is in that of a link; nothing where that is not known.
  using Place =
      std::function<std::optional<Pose>(const std::string& link, const std::string& frame)>;
  /// Of an object, and of all of them: of more the object is refused.
  static constexpr std::size_t kShapesMax = 16, kAllShapesMax = 64;

  explicit PlannerObjects(Place place) : place_(std::move(place)) {}

  /// @param message moveit_msgs/AttachedCollisionObject: adds, appends or removes.
  /// @return why it is passed over, in one line; then nothing changes. Empty where it is not.
  template <typename Attached>
  std::string take(const Attached& message);
  /// @param state moveit_msgs/RobotState, as a moveit_msgs/PlanningScene has it: all that is
  /// attached, unless it is a difference. @return what is passed over.
  template <typename State>
  std::vector<std::string> takeState(const State& state);

  /// An object of one shape has its own name, the shapes of another are NAME/0, NAME/1 ...
  [[nodiscard]] HeldShapes shapes() const;

 private:
  struct Object {
    std::string link;
    std::vector<PlacedShape> shapes;  ///< in the link's frame
  };
  template <typename Attached>
  [[nodiscard]] Object objectOf(const Attached& message) const;
  template <typename Attached>
  void remove(const Attached& message);
  void put(const std::string& id, Object object, bool append);

  Place place_;
  std::map<std::string, Object> objects_;  ///< by their ids
};

// How the messages' shapes are taken.
namespace planner {

/// Of SolidPrimitive.
enum SolidType { kBox = 1, kSphere = 2, kCylinder = 3, kCone = 4 };
/// Of CollisionObject.
enum Operation { kAdd = 0, kRemove = 1, kAppend = 2 };

/// Planners leave the rotation out where there is none.
[[nodiscard]] inline Pose poseOf(geometry_msgs::Pose message, const std::string& owner) {
  geometry_msgs::Quaternion& q = message.orientation;
  if (q.x == 0.0 && q.y == 0.0 && q.z == 0.0 && q.w == 0.0) q.w = 1.0;
  return fromMessage(message, owner);
}

/// The pose of an object, which its shapes' poses are in; older messages have none.
template <typename Object, typename = void>
struct ObjectPose {
  static Pose of(const Object& /*object*/) { return Pose::Identity(); }
};
template <typename Object>
struct ObjectPose<Object, std::void_t<decltype(std::declval<const Object&>().pose)>> {
  static Pose of(const Object& object) { return poseOf(object.pose, "'" + object.id + "'"); }
};

/// A cone is enclosed by a cylinder. @throws ConfigError
template <typename Solid>
[[nodiscard]] Shape shapeOfSolid(const Solid& solid, const std::string& owner) {
  const auto needs = [&](std::size_t dimensions) {
    if (solid.dimensions.size() == dimensions) return;
    throw ConfigError(owner + ": a primitive has " + std::to_string(solid.dimensions.size()) +
                      " dimensions in place of " + std::to_string(dimensions));
  };
  switch (solid.type) {
    case kBox:
      needs(3);
      return Box{0.5 * Vector3(solid.dimensions[0], solid.dimensions[1], solid.dimensions[2])};
    case kSphere:
      needs(1);
      return Sphere{solid.dimensions[0]};
    case kCylinder:
    case kCone:
      needs(2);
      return Cylinder{solid.dimensions[1], 0.5 * solid.dimensions[0]};
    default:
      throw ConfigError(owner + ": a primitive of type " + std::to_string(solid.type) +
                        " is none that the monitor knows");
  }
}

/// The box around it, at least 0.2 mm thick. @throws ConfigError
template <typename Mesh>
[[nodiscard]] PlacedShape boxAround(const Mesh& mesh, const std::string& owner) {
  constexpr double kThinnest = 1e-4;  // [m] to either side
  UprightBox box;
  for (const auto& vertex : mesh.vertices) {
    const Vector3 p(vertex.x, vertex.y, vertex.z);
    if (!p.allFinite()) throw ConfigError(owner + ": a vertex of a mesh is not finite");
    box.extend(p);
  }
  if (box.isEmpty()) throw ConfigError(owner + ": a mesh has no vertices");
  return {Box{(0.5 * box.sizes()).cwiseMax(kThinnest)},
          Pose(Eigen::Translation3d(Vector3(box.center())))};
}

}  // namespace planner

template <typename Attached>
PlannerObjects::Object PlannerObjects::objectOf(const Attached& message) const {
  const auto& object = message.object;
  const std::string owner = "'" + object.id + "'";
  if (object.id.empty()) throw ConfigError("an object has no name");
  if (!object.planes.empty()) throw ConfigError(owner + ": a plane has no end");
  const std::size_t solids = object.primitives.size(), meshes = object.meshes.size();
  if (solids + meshes == 0) {
    throw ConfigError(owner + " has no shape: it is taken once a planning scene tells it");
  }
  if (solids + meshes > kShapesMax) {
    throw ConfigError(owner + " has more than " + std::to_string(kShapesMax) + " shapes");
  }
  Pose T_link_frame = Pose::Identity();
  const std::string& frame = object.header.frame_id;
  if (!frame.empty() && frame != message.link_name) {
    const auto place = place_(message.link_name, frame);
    if (!place) {
      throw ConfigError(owner + ": no fresh transform from its frame '" + frame + "' to '" +
                        message.link_name + "'");
    }
    T_link_frame = *place;
  }
  const Pose T_link_object =
      T_link_frame * planner::ObjectPose<std::decay_t<decltype(object)>>::of(object);
  Object taken{message.link_name, {}};
  const auto add = [&](const PlacedShape& shape, const auto& poses, std::size_t i) {
    validate(shape.shape, owner);
    Pose T_object_shape = shape.pose;
    if (i < poses.size()) T_object_shape = planner::poseOf(poses[i], owner) * shape.pose;
    taken.shapes.push_back({shape.shape, T_link_object * T_object_shape});
  };
  for (std::size_t i = 0; i < solids; ++i) {
    add({planner::shapeOfSolid(object.primitives[i], owner)}, object.primitive_poses, i);
  }
  for (std::size_t i = 0; i < meshes; ++i) {
    add(planner::boxAround(object.meshes[i], owner), object.mesh_poses, i);
  }
  return taken;
}

template <typename Attached>
std::string PlannerObjects::take(const Attached& message) {
  const auto operation = static_cast<int>(message.object.operation);
  try {
    if (operation == planner::kRemove) {
      remove(message);
    } else if (operation == planner::kAdd || operation == planner::kAppend) {
      put(message.object.id, objectOf(message), operation == planner::kAppend);
    } else {
      return "'" + message.object.id + "': what is attached is added, appended to or removed alone";
    }
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

template <typename Attached>
void PlannerObjects::remove(const Attached& message) {
  for (auto object = objects_.begin(); object != objects_.end();) {
    const bool is_meant = message.object.id.empty() ? message.link_name.empty() ||
                                                          object->second.link == message.link_name
                                                    : object->first == message.object.id;
    object = is_meant ? objects_.erase(object) : std::next(object);
  }
}

template <typename State>
std::vector<std::string> PlannerObjects::takeState(const State& state) {
  const auto& attached = state.attached_collision_objects;
  for (auto object = objects_.begin(); !state.is_diff && object != objects_.end();) {
    const bool is_there = std::any_of(attached.begin(), attached.end(), [&](const auto& message) {
      return message.object.id == object->first;
    });
    object = is_there ? std::next(object) : objects_.erase(object);
  }
  std::vector<std::string> passed_over;
  for (const auto& message : attached) {
    const std::string why = take(message);
    if (!why.empty()) passed_over.push_back(why);
  }
  return passed_over;
}

inline void PlannerObjects::put(const std::string& id, Object object, bool append) {
  const auto known = objects_.find(id);
  if (append && known != objects_.end() && known->second.link == object.link) {
    object.shapes.insert(object.shapes.begin(), known->second.shapes.begin(),
                         known->second.shapes.end());
  }
  std::size_t all = object.shapes.size();
  for (const auto& [name, other] : objects_) all += name == id ? 0 : other.shapes.size();
  if (object.shapes.size() > kShapesMax || all > kAllShapesMax) {
    throw ConfigError(
        lineOf("'%.100s': more than %zu shapes of one object, or %zu of all, are attached",
               id.c_str(), kShapesMax, kAllShapesMax));
  }
  objects_[id] = std::move(object);
}

inline HeldShapes PlannerObjects::shapes() const {
  HeldShapes shapes;
  for (const auto& [id, object] : objects_) {
    const bool is_one = object.shapes.size() == 1;
    for (std::size_t i = 0; i < object.shapes.size(); ++i) {
      shapes[is_one ? id : id + "/" + std::to_string(i)] = {object.link,
                                                            toMessage(object.shapes[i])};
    }
  }
  return shapes;
}

}  // namespace tccm
