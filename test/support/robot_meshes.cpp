#include "support/robot_meshes.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <filesystem>
#include <stdexcept>

#include "support/shared_data.h"
#include "support/temporary_folder.h"

namespace tccm::test {
namespace {

namespace fs = std::filesystem;

fs::path folderOf(const SharedRobot& robot) {
  return fs::path(sharedDataFolder()) / "robots" / robot.folder;
}

fs::path resolved(const std::string& uri, const SharedRobot& robot) {
  const std::string scheme = "package://";
  if (uri.rfind(scheme, 0) != 0) throw std::runtime_error("no package: " + uri);
  return fs::path(robot.packages()) / uri.substr(scheme.size());
}

Eigen::Affine3d toAffine(const aiMatrix4x4& matrix) {
  Eigen::Affine3d result;
  for (unsigned row = 0; row < 4; ++row) {
    for (unsigned column = 0; column < 4; ++column) {
      result.matrix()(row, column) = matrix[row][column];
    }
  }
  return result;
}

void addMesh(const aiMesh& from, const Eigen::Affine3d& T_mesh_part, Mesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (unsigned i = 0; i < from.mNumVertices; ++i) {
    const aiVector3D& p = from.mVertices[i];
    mesh.vertices.emplace_back(T_mesh_part * Vector3(p.x, p.y, p.z));
  }
  for (unsigned i = 0; i < from.mNumFaces; ++i) {
    const aiFace& face = from.mFaces[i];
    Mesh::Triangle triangle{};
    for (unsigned k = 0; k < 3; ++k) {
      triangle[k] = first + face.mIndices[std::min(k, face.mNumIndices - 1)];
    }
    mesh.triangles.push_back(triangle);
  }
}

void addNode(const aiScene& scene, const aiNode& node, const Eigen::Affine3d& T_mesh_parent,
             Mesh& mesh) {
  const Eigen::Affine3d T_mesh_node = T_mesh_parent * toAffine(node.mTransformation);
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    addMesh(*scene.mMeshes[node.mMeshes[i]], T_mesh_node, mesh);
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i) {
    addNode(scene, *node.mChildren[i], T_mesh_node, mesh);
  }
}

Mesh readByAssimp(const fs::path& path) {
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(path, aiProcess_Triangulate);
  if (scene == nullptr) throw std::runtime_error(importer.GetErrorString());
  Mesh mesh;
  addNode(*scene, *scene->mRootNode, Eigen::Affine3d::Identity(), mesh);
  return mesh;
}

LinkMesh readElement(const std::string& link, const urdf::Collision& collision,
                     const urdf::Mesh& element, const SharedRobot& robot) {
  LinkMesh result{link, element.filename, readByAssimp(resolved(element.filename, robot))};
  const Vector3 scale(element.scale.x, element.scale.y, element.scale.z);
  const Pose T_link_mesh = toPose(collision.origin);
  for (Vector3& vertex : result.mesh.vertices) {
    vertex = T_link_mesh * vertex.cwiseProduct(scale).eval();
  }
  return result;
}

}  // namespace

bool SharedRobot::isThere() const { return fs::exists(folderOf(*this) / file); }

std::string SharedRobot::urdf() const { return readFile(folderOf(*this) / file); }

std::string SharedRobot::packages() const {
  const fs::path packages = folderOf(*this) / "packages";
  return fs::exists(packages) ? packages.string() : std::string();
}

Pose toPose(const urdf::Pose& pose) {
  Eigen::Quaterniond rotation;
  pose.rotation.getQuaternion(rotation.x(), rotation.y(), rotation.z(), rotation.w());
  Pose result = Pose::Identity();
  result.linear() = rotation.toRotationMatrix();
  result.translation() = Vector3(pose.position.x, pose.position.y, pose.position.z);
  return result;
}

std::vector<LinkMesh> collisionMeshes(const urdf::ModelInterface& urdf, const SharedRobot& robot) {
  std::vector<LinkMesh> meshes;
  for (const auto& [name, link] : urdf.links_) {
    for (const auto& collision : link->collision_array) {
      const auto mesh = std::dynamic_pointer_cast<const urdf::Mesh>(collision->geometry);
      if (mesh) meshes.push_back(readElement(name, *collision, *mesh, robot));
    }
  }
  return meshes;
}

}  // namespace tccm::test
