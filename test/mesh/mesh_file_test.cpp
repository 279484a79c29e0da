#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include "mesh/mesh.h"
#include "support/mesh_texts.h"
#include "support/near.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using test::binaryStl;
using test::collada;
using test::ColladaText;

using Place = std::array<double, 3>;

/// Rounded to 1 nm.
std::set<Place> places(const std::vector<Vector3>& points) {
  std::set<Place> found;
  for (const Vector3& p : points) {
    const Vector3 nm = (p * 1e9).array().round();
    found.insert({nm.x() + 0.0, nm.y() + 0.0, nm.z() + 0.0});
  }
  return found;
}

std::set<Place> places(const Mesh& mesh) { return places(mesh.vertices); }

Vector3 corner(const Mesh& mesh, std::size_t triangle, std::size_t index) {
  return mesh.vertices.at(mesh.triangles.at(triangle).at(index));
}

void expectWhole(const Mesh& mesh) {
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const Mesh::Triangle& t : mesh.triangles) {
    for (const std::uint32_t index : t) used.at(index) = true;
  }
  EXPECT_EQ(std::count(used.begin(), used.end(), false), 0) << "vertices without a triangle";
  EXPECT_EQ(places(mesh).size(), mesh.vertices.size()) << "a vertex more than once";
}

Mesh readWhole(const std::string& content, const std::string& uri,
               const MeshScaling& scaling = {}) {
  const Mesh mesh = readMesh(content, uri, scaling);
  expectWhole(mesh);
  return mesh;
}

/// The error's text, which has to be one line that begins with the URI.
std::string errorOf(const std::string& content, const std::string& uri,
                    const MeshScaling& scaling = {}) {
  try {
    (void)readMesh(content, uri, scaling);
  } catch (const ConfigError& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.rfind(uri + ": ", 0), 0U) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    return text;
  }
  ADD_FAILURE() << uri << ": nothing was thrown";
  return {};
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

const std::vector<Vector3> kTetrahedron{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
const std::string kInput = R"(<input semantic="VERTEX" source="#v" offset="0"/>)";

std::vector<Vector3> moved(const Eigen::Affine3d& T, std::vector<Vector3> points) {
  for (Vector3& p : points) p = T * p;
  return points;
}

TEST(MeshFileTest, BinaryStlIsReadAlsoWhereItBeginsWithSolid) {
  for (const char* header : {"made by hand", "solid made by hand"}) {
    const Mesh mesh = readWhole(binaryStl({{Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(0, 2, 0)},
                                           {Vector3(0, 0, 0), Vector3(0, 2, 0), Vector3(0, 0, 3)}},
                                          header),
                                "a.stl");
    EXPECT_EQ(places(mesh), places(kTetrahedron));
    EXPECT_EQ(mesh.triangles.size(), 2U);
    EXPECT_TRUE(test::isNearly(corner(mesh, 1, 2), {0, 0, 3}, 0.0));
  }
}

TEST(MeshFileTest, AsciiStlIsReadWhateverItsNormalsCaseAndNumberOfSolids) {
  const Mesh one = readWhole(test::kAsciiStl, "package://robot/meshes/a.STL");
  EXPECT_EQ(places(one), places({{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, -3}}));
  EXPECT_EQ(one.triangles.size(), 2U);
  const std::string upper =
      "SOLID\nFACET OUTER LOOP VERTEX 5 0 0 VERTEX 6 0 0 VERTEX 5 1 0 ENDLOOP ENDFACET\nENDSOLID";
  const Mesh two = readWhole(test::kAsciiStl + upper, "a.stl");
  EXPECT_EQ(two.triangles.size(), 3U);
  EXPECT_EQ(two.vertices.size(), 7U);
}

TEST(MeshFileTest, ObjIsReadWithoutItsMaterials) {
  const Mesh mesh = readWhole(test::kObj, "file:///a.Obj");
  EXPECT_EQ(places(mesh), places({{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 2, 0}, {0, 0, -3}}));
  ASSERT_EQ(mesh.triangles.size(), 3U) << "a square's two triangles, and a line";
  EXPECT_EQ(mesh.triangles[2], (Mesh::Triangle{4, 0, 0}));
}

TEST(MeshFileTest, ColladaIsReadWithoutItsTextures) {
  const Mesh mesh = readWhole(collada({}), "a.DAE");
  EXPECT_EQ(places(mesh), places(kTetrahedron));
  ASSERT_EQ(mesh.triangles.size(), 2U);
  EXPECT_TRUE(test::isNearly(corner(mesh, 1, 2), {0, 0, 3}, 0.0));
}

TEST(MeshFileTest, ScaleIsPerAxisAndMayMirror) {
  MeshScaling scaling;
  scaling.scale = {0.001, -2.0, 3.0};
  const auto expected = places({{0, 0, 0}, {0.001, 0, 0}, {0, -4, 0}, {0, 0, 9}});
  EXPECT_EQ(places(readWhole(collada({}), "a.dae", scaling)), expected);
  const std::string stl = binaryStl({{kTetrahedron[0], kTetrahedron[1], kTetrahedron[2]},
                                     {kTetrahedron[0], kTetrahedron[1], kTetrahedron[3]}});
  EXPECT_EQ(places(readWhole(stl, "a.stl", scaling)), expected);
}

TEST(MeshFileTest, ScalesOfZeroNaNAndBeyondAThousandAreRefused) {
  for (const double bad : {0.0, std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity(), 1000.1, -1e9}) {
    MeshScaling scaling;
    scaling.scale.y() = bad;
    EXPECT_TRUE(contains(errorOf(collada({}), "a.dae", scaling), "scale")) << bad;
  }
}

TEST(MeshFileTest, TheUnitThatColladaStatesIsApplied) {
  for (const double meter : {0.01, 0.0254, 0.001, 1.0}) {
    ColladaText text;
    text.asset = "<unit name=\"some\" meter=\"" + std::to_string(meter) + "\"/>";
    text.nodes = R"(<node><translate>10 0 0</translate><instance_geometry url="#g"/></node>)";
    const Eigen::Affine3d T = Eigen::Scaling(meter) * Eigen::Translation3d(10, 0, 0);
    EXPECT_EQ(places(readWhole(collada(text), "a.dae")), places(moved(T, kTetrahedron))) << meter;
  }
}

TEST(MeshFileTest, CoordinatesStayAsTheyStandWhateverUpAxisIsStated) {
  for (const std::string up : {"X_UP", "Y_UP", "Z_UP"}) {
    ColladaText text;
    text.asset = "<up_axis>" + up + "</up_axis>";
    EXPECT_EQ(places(readWhole(collada(text), "a.dae")), places(kTetrahedron)) << up;
  }
}

TEST(MeshFileTest, TheStatedUpAxisBecomesZWhereAsked) {
  MeshScaling scaling;
  scaling.apply_up_axis = true;
  scaling.scale = {1, 1, 10};
  const std::vector<std::pair<std::string, std::vector<Vector3>>> cases{
      {"<up_axis>X_UP</up_axis>", {{0, 0, 0}, {0, 0, 10}, {-2, 0, 0}, {0, -3, 0}}},
      {"<up_axis>Y_UP</up_axis>", {{0, 0, 0}, {1, 0, 0}, {0, 0, 20}, {0, -3, 0}}},
      {"", {{0, 0, 0}, {1, 0, 0}, {0, 0, 20}, {0, -3, 0}}},
      {"<up_axis>Z_UP</up_axis>", {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 30}}}};
  for (const auto& [asset, expected] : cases) {
    ColladaText text;
    text.asset = asset;
    EXPECT_EQ(places(readWhole(collada(text), "a.dae", scaling)), places(expected)) << asset;
  }
  EXPECT_EQ(places(readWhole(test::kObj, "a.obj", scaling)).count({0, 0, -30e9}), 1U)
      << "other formats state no up axis";
}

TEST(MeshFileTest, EveryInstanceStandsWhereItsNodesPutIt) {
  ColladaText text;
  text.nodes = R"(
<node><matrix>0 -1 0 1  1 0 0 2  0 0 1 3  0 0 0 1</matrix>
  <node><rotate>0 0 2 90</rotate><scale>1 2 -1</scale><instance_geometry url="#g"/></node>
  <instance_node url="#l"/>
</node><node><instance_geometry url="#g"/></node>)";
  text.libraries = R"(<library_nodes><node id="l"><translate>0 0 7</translate><node>
<translate>5 0 0</translate><rotate>1 0 0 180</rotate><instance_geometry url="#g"/>
</node></node></library_nodes>)";
  Eigen::Affine3d matrix = Eigen::Affine3d::Identity();
  matrix.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  matrix.translation() << 1, 2, 3;
  const Eigen::Affine3d first =
      matrix * Eigen::AngleAxisd(M_PI / 2, Vector3::UnitZ()) * Eigen::Scaling(1.0, 2.0, -1.0);
  const Eigen::Affine3d second = matrix * Eigen::Translation3d(0, 0, 7) *
                                 Eigen::Translation3d(5, 0, 0) *
                                 Eigen::AngleAxisd(M_PI, Vector3::UnitX());
  std::set<Place> expected = places(kTetrahedron);
  expected.merge(places(moved(first, kTetrahedron)));
  expected.merge(places(moved(second, kTetrahedron)));
  const Mesh mesh = readWhole(collada(text), "a.dae");
  EXPECT_EQ(places(mesh), expected);
  EXPECT_EQ(mesh.triangles.size(), 6U);
}

TEST(MeshFileTest, SkinsAndMorphsShowTheirGeometry) {
  ColladaText text;
  text.nodes = R"(<node><instance_controller url="#c"/></node>)";
  text.libraries = R"(<library_controllers><controller id="c"><skin source="#d"/></controller>
<controller id="d"><morph source="#g"/></controller></library_controllers>)";
  EXPECT_EQ(places(readWhole(collada(text), "a.dae")), places(kTetrahedron));
}

TEST(MeshFileTest, EveryKindOfColladaFaceListIsRead) {
  const std::vector<std::pair<std::string, std::size_t>> lists{
      {"<polylist count=\"2\">" + kInput + "<vcount>4 3</vcount><p>0 1 2 3 0 1 2</p></polylist>",
       3},
      {"<polygons count=\"2\">" + kInput + "<p>0 1 2 3</p><ph><p>0 1 2</p><h>3</h></ph></polygons>",
       3},
      {"<tristrips count=\"1\">" + kInput + "<p>0 1 2 3</p></tristrips>", 2},
      {"<trifans count=\"1\">" + kInput + "<p>0 1 2 3</p></trifans>", 2},
      {"<lines count=\"2\">" + kInput + "<p>0 1 2 3</p></lines>", 2},
      {"<linestrips count=\"1\">" + kInput + "<p>0 1 2 3</p></linestrips>", 3},
      {"<triangles count=\"1\">" + kInput +
           "<input semantic=\"NORMAL\" source=\"#none\" offset=\"1\"/>"
           "<p>0 9 1 9 2 9</p></triangles><lines count=\"1\">" +
           kInput + "<p>2 3</p></lines>",
       2}};
  for (const auto& [faces, count] : lists) {
    ColladaText text;
    text.faces = faces;
    const Mesh mesh = readWhole(collada(text), "a.dae");
    EXPECT_EQ(places(mesh), places(kTetrahedron)) << faces;
    EXPECT_EQ(mesh.triangles.size(), count) << faces;
  }
}

TEST(MeshFileTest, VerticesThatNoFaceUsesAreLeftOut) {
  ColladaText text;
  text.faces = "<triangles count=\"1\">" + kInput + "<p>0 1 2</p></triangles>";
  const Mesh mesh = readWhole(collada(text), "a.dae");
  EXPECT_EQ(places(mesh), places({{0, 0, 0}, {1, 0, 0}, {0, 2, 0}}));
  EXPECT_EQ(mesh.warnings.size(), 1U);
}

TEST(MeshFileTest, VerticesAtOnePlaceAreMerged) {
  const Mesh mesh =
      readWhole("v 0 0 0\nv 1 0 0\nv 0 1 0\nv -0 1.0 0e0\nf 1 2 3\nf 1 2 4\n", "a.obj");
  EXPECT_EQ(mesh.vertices.size(), 3U);
  EXPECT_EQ(mesh.triangles[0], mesh.triangles[1]);
}

TEST(MeshFileTest, AnAccessorMayPassOverNumbers) {
  ColladaText text;
  text.array = "<float_array id=\"a\" count=\"9\">9 0 0 0 7 1 2 3 7</float_array>";
  text.accessor = "source=\"#a\" count=\"2\" offset=\"1\" stride=\"4\"";
  text.faces = "<lines count=\"1\">" + kInput + "<p>0 1</p></lines>";
  EXPECT_EQ(places(readWhole(collada(text), "a.dae")), places({{0, 0, 0}, {1, 2, 3}}));
}

}  // namespace
}  // namespace tccm
