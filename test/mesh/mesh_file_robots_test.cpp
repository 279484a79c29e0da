/// The meshes of real robots, and random ones, against Assimp.

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>

#include "mesh/mesh.h"
#include "support/mesh_texts.h"
#include "support/random.h"
#include "support/shared_data.h"

namespace tccm {
namespace {

namespace fs = std::filesystem;

std::string contentOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream content;
  content << file.rdbuf();
  return content.str();
}

std::string lowerExtension(const fs::path& path) {
  std::string extension = path.extension();
  for (char& c : extension) c = static_cast<char>(std::tolower(c));
  return extension.empty() ? extension : extension.substr(1);
}

std::vector<fs::path> meshFiles() {
  std::vector<fs::path> files;
  const fs::path robots = fs::path(test::sharedDataFolder()) / "robots";
  if (!fs::exists(robots)) return files;
  for (const auto& entry : fs::recursive_directory_iterator(robots)) {
    const std::string extension = lowerExtension(entry.path());
    if (extension == "stl" || extension == "dae") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

void addNode(const aiScene& scene, const aiNode& node, const Eigen::Affine3d& T_parent,
             std::vector<Vector3>& points) {
  Eigen::Affine3d T_node;
  for (unsigned row = 0; row < 4; ++row) {
    for (unsigned column = 0; column < 4; ++column) {
      T_node.matrix()(row, column) = node.mTransformation[row][column];
    }
  }
  const Eigen::Affine3d T = T_parent * T_node;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[i]];
    for (unsigned k = 0; k < mesh.mNumVertices; ++k) {
      const aiVector3D& p = mesh.mVertices[k];
      points.emplace_back(T * Vector3(p.x, p.y, p.z));
    }
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i) addNode(scene, *node.mChildren[i], T, points);
}

/// As Assimp, which reads single precision, has them: the vertices of faces, without rotation to an
/// up axis. And the number of its triangles.
struct AssimpMesh {
  std::vector<Vector3> vertices;
  std::size_t triangles = 0;
};

AssimpMesh readByAssimp(const std::string& content, const std::string& extension) {
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene =
      importer.ReadFileFromMemory(content.data(), content.size(), 0, extension.c_str());
  AssimpMesh mesh;
  if (scene == nullptr) return mesh;
  addNode(*scene, *scene->mRootNode, Eigen::Affine3d::Identity(), mesh.vertices);
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) {
    for (unsigned k = 0; k < scene->mMeshes[i]->mNumFaces; ++k) {
      mesh.triangles += std::max(1U, scene->mMeshes[i]->mFaces[k].mNumIndices - 2);
    }
  }
  return mesh;
}

/// The furthest that any of the points is from all of the others [m].
double furthest(std::vector<Vector3> points, std::vector<Vector3> others) {
  const auto by_x = [](const Vector3& a, const Vector3& b) { return a.x() < b.x(); };
  std::sort(others.begin(), others.end(), by_x);
  double result = 0.0;
  for (const Vector3& p : points) {
    double nearest = std::numeric_limits<double>::infinity();
    const auto at = std::lower_bound(others.begin(), others.end(), p, by_x);
    for (auto up = at; up != others.end() && up->x() - p.x() < nearest; ++up) {
      nearest = std::min(nearest, (*up - p).norm());
    }
    for (auto down = at; down != others.begin() && p.x() - (down - 1)->x() < nearest; --down) {
      nearest = std::min(nearest, (*(down - 1) - p).norm());
    }
    result = std::max(result, nearest);
  }
  return result;
}

/// Assimp reads single precision; STL files hold no more.
void expectAsAssimp(const std::string& content, const std::string& extension) {
  const Mesh mesh = readMesh(content, "a." + extension, {});
  const AssimpMesh expected = readByAssimp(content, extension);
  ASSERT_FALSE(expected.vertices.empty());
  double size = 0.0;
  for (const Vector3& p : mesh.vertices) size = std::max(size, p.cwiseAbs().maxCoeff());
  const double tolerance = extension == "stl" ? 0.0 : 1e-6 * size;
  EXPECT_LE(furthest(mesh.vertices, expected.vertices), tolerance);
  EXPECT_LE(furthest(expected.vertices, mesh.vertices), tolerance);
  EXPECT_EQ(mesh.triangles.size(), expected.triangles);
}

TEST(MeshFileRobotsTest, EveryMeshOfRealRobotsIsWhatAssimpReads) {
  const std::vector<fs::path> files = meshFiles();
  if (files.empty()) GTEST_SKIP() << "no robots below " << test::sharedDataFolder();
  std::map<std::string, int> read;
  for (const fs::path& path : files) {
    SCOPED_TRACE(path);
    const std::string extension = lowerExtension(path);
    expectAsAssimp(contentOf(path), extension);
    ++read[extension];
  }
  EXPECT_GT(read["stl"], 30);
  EXPECT_GT(read["dae"], 20);
}

std::string randomTransforms(test::Random& random) {
  std::ostringstream text;
  const Vector3 t = random.point(2.0);
  const Vector3 axis = random.direction();
  const Eigen::Matrix3d R = random.rotation();
  text << "<translate>" << t.transpose() << "</translate>";
  if (random.chance(0.5)) {
    text << "<rotate>" << axis.transpose() << " " << random.uniform(-400, 400) << "</rotate>";
  }
  if (random.chance(0.5)) text << "<scale>" << random.point(3.0).transpose() << "</scale>";
  if (random.chance(0.5)) {
    text << "<matrix>" << R.row(0) << " 1 " << R.row(1) << " -2 " << R.row(2) << " 0 0 0 0 1"
         << "</matrix>";
  }
  if (random.chance(0.2)) {  // with up across, as Assimp does not make it so
    text << "<lookat>1 2 3 " << 1.0 + t.x() << " " << 2.0 + t.y() << " 3 0 0 1</lookat>";
  }
  return text.str();
}

std::string randomNode(test::Random& random, int depth) {
  std::string node = "<node>" + randomTransforms(random);
  if (depth == 0 || random.chance(0.3)) node += "<instance_geometry url=\"#g\"/>";
  for (int i = random.integer(1, 2); depth > 0 && i > 0; --i) node += randomNode(random, depth - 1);
  if (random.chance(0.3)) node += "<instance_node url=\"#l\"/>";
  return node + "</node>";
}

TEST(MeshFileRobotsTest, RandomTreesOfNodesAreWhatAssimpReads) {
  test::Random random(3);
  for (int i = 0; i < 300; ++i) {
    test::ColladaText text;
    text.asset = "<unit meter=\"" + std::string(random.chance(0.5) ? "0.01" : "0.0254") +
                 "\"/><up_axis>Y_UP</up_axis>";
    text.libraries = "<library_nodes><node id=\"l\">" + randomTransforms(random) +
                     "<instance_geometry url=\"#g\"/></node></library_nodes>";
    text.nodes = randomNode(random, random.integer(0, 3));
    SCOPED_TRACE(text.nodes);
    const std::string content = test::collada(text);
    const AssimpMesh expected = readByAssimp(content, "dae");
    const Mesh mesh = readMesh(content, "a.dae", {});
    EXPECT_LE(furthest(mesh.vertices, expected.vertices), 1e-5);
    EXPECT_LE(furthest(expected.vertices, mesh.vertices), 1e-5);
  }
}

TEST(MeshFileRobotsTest, HandMadeObjAndAsciiStlAreWhatAssimpReads) {
  expectAsAssimp(test::kObj, "obj");
  expectAsAssimp(test::kAsciiStl, "stl");
}

}  // namespace
}  // namespace tccm
