#pragma once

#include <urdf_model/model.h>

#include <string>
#include <vector>

#include "mesh/mesh.h"

namespace tccm::test {

/// A robot among the shared data, with the packages that its URDF refers to.
struct SharedRobot {
  std::string folder;  ///< below robots/
  std::string file;

  [[nodiscard]] bool isThere() const;
  /// The URDF's text.
  [[nodiscard]] std::string urdf() const;
  /// Where package://P/x is P/x.
  [[nodiscard]] std::string packages() const;
};

inline const SharedRobot kBaxter{"baxter", "baxter.urdf"};
inline const SharedRobot kGuardian{"guardian_v7_tilt", "guardian_tracks.urdf"};
inline const SharedRobot kNextage{"nextage", "NextageOpen.urdf"};
inline const SharedRobot kPanda{"panda_moveit", "panda.urdf"};
inline const SharedRobot kPandaOfPrimitives{"panda_primitives", "panda_collision.urdf"};
inline const SharedRobot kPr2{"pr2_moveit", "pr2.urdf"};
inline const SharedRobot kUr5{"ur5", "ur5_robot.urdf"};

[[nodiscard]] Pose toPose(const urdf::Pose& pose);

/// One collision mesh.
struct LinkMesh {
  std::string link;
  std::string uri;
  Mesh mesh;  ///< in the link's frame [m], scaled as the URDF says
};

/// The meshes of every collision element, read without the project's own code: urdfdom says which
/// and where, Assimp what is in them. A COLLADA file's up axis is not applied.
/// @throws std::runtime_error where Assimp reads nothing.
[[nodiscard]] std::vector<LinkMesh> collisionMeshes(const urdf::ModelInterface& urdf,
                                                    const SharedRobot& robot);

}  // namespace tccm::test
