/// Mesh files that are odd and harmless, and such as look like them and may hide a part of a body.

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "mesh/mesh.h"
#include "support/error_of.h"
#include "support/mesh_texts.h"
#include "support/random.h"
#include "support/shared_data.h"

namespace tccm {
namespace {

using test::binaryStl;
using test::collada;
using test::ColladaText;
using test::errorOf;
using test::Random;

using Triangles = std::vector<std::array<Vector3, 3>>;

constexpr unsigned kMembers = 30;
const std::string kInput = R"(<input semantic="VERTEX" source="#v" offset="0"/>)";

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

Triangles randomTriangles(Random& random, int least = 1) {
  Triangles triangles;
  for (int i = random.integer(least, 20); i > 0; --i) {
    triangles.push_back({random.point(0.4), random.point(0.4), random.point(0.4)});
  }
  return triangles;
}

/// At least one.
std::string randomBytes(Random& random, int most) {
  std::string bytes;
  for (int i = random.integer(1, most); i > 0; --i) {
    bytes += static_cast<char>(random.integer(0, 255));
  }
  return bytes;
}

/// Each corner its own vertex, after some that no face uses.
std::string objOf(const Triangles& triangles, const std::vector<Vector3>& unused) {
  std::ostringstream text;
  text.precision(17);
  for (const Vector3& p : unused) text << "v " << p.transpose() << "\n";
  for (const auto& triangle : triangles) {
    for (const Vector3& p : triangle) text << "v " << p.transpose() << "\n";
    text << "f -3 -2 -1\n";
  }
  return text.str();
}

/// The made file with further vertices behind its own four.
ColladaText withVertices(int count, const std::string& numbers) {
  ColladaText text;
  const std::string floats = std::to_string(12 + 3 * count);
  text.array = "<float_array id=\"a\" count=\"" + floats + "\">0 0 0 1 0 0 0 2 0 0 0 3" + numbers +
               "</float_array>";
  text.accessor = "source=\"#a\" count=\"" + std::to_string(4 + count) + "\" stride=\"3\"";
  return text;
}

TEST(MeshFileOdditiesTest, VerticesThatNoFaceUsesAreLeftOutAndCounted) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    const Triangles triangles = randomTriangles(random);
    std::vector<Vector3> unused;
    for (int i = random.integer(1, 50); i > 0; --i) unused.push_back(random.point(5.0));
    const Mesh whole = readMesh(objOf(triangles, {}), "a.obj", {});
    const Mesh mesh = readMesh(objOf(triangles, unused), "a.obj", {});
    EXPECT_EQ(mesh.vertices, whole.vertices) << seed;
    EXPECT_EQ(mesh.triangles, whole.triangles) << seed;
    EXPECT_TRUE(whole.warnings.empty()) << seed;
    ASSERT_EQ(mesh.warnings.size(), 1U) << seed;
    EXPECT_TRUE(has(mesh.warnings[0], std::to_string(unused.size()) + " of its ")) << seed;
  }
}

TEST(MeshFileOdditiesTest, VerticesOfAColladaFileThatNoFaceUsesAreLeftOutAndCounted) {
  const Mesh whole = readMesh(collada({}), "a.dae", {});
  EXPECT_TRUE(whole.warnings.empty());
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    const int unused = random.integer(1, 50);
    std::ostringstream more;
    for (int i = 0; i < unused; ++i) more << " " << random.point(5.0).transpose();
    const Mesh mesh = readMesh(collada(withVertices(unused, more.str())), "a.dae", {});
    EXPECT_EQ(mesh.vertices, whole.vertices) << seed;
    EXPECT_EQ(mesh.triangles, whole.triangles) << seed;
    ASSERT_EQ(mesh.warnings.size(), 1U) << seed;
    EXPECT_TRUE(has(mesh.warnings[0], std::to_string(unused) + " of its ")) << seed;
  }
}

TEST(MeshFileOdditiesTest, WhereAnUnusedVertexIsMattersToNobody) {
  for (const char* place : {"nan 0 0", "1e9 0 0", "inf inf inf"}) {
    const Mesh mesh =
        readMesh("v 0 0 0\nv 1 0 0\nv 0 1 0\nv " + std::string(place) + "\nf 1 2 3\n", "a.obj", {});
    EXPECT_EQ(mesh.vertices.size(), 3U) << place;
  }
}

TEST(MeshFileOdditiesTest, BytesBehindTheLastFacetOfAnStlArePassedOver) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    const Triangles triangles = randomTriangles(random);
    const std::string stl = binaryStl(triangles, random.chance(0.5) ? "solid x" : "x");
    const std::string behind =
        seed % 3 == 0 ? std::string(seed + 1, '\0') : randomBytes(random, 200);
    const Mesh mesh = readMesh(stl + behind, "a.stl", {});
    EXPECT_EQ(mesh.triangles.size(), triangles.size()) << seed;
    ASSERT_EQ(mesh.warnings.size(), 1U) << seed;
    EXPECT_TRUE(has(mesh.warnings[0], std::to_string(behind.size()) + " byte")) << seed;
    EXPECT_TRUE(readMesh(stl, "a.stl", {}).warnings.empty()) << seed;
  }
}

TEST(MeshFileOdditiesTest, BytesBehindTheEndOfAnAsciiStlArePassedOver) {
  std::vector<std::string> tails{std::string("\0", 1), "exported by hand\n", "\n\x1a",
                                 std::string(512, '\0')};
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    tails.push_back("x" + randomBytes(random, 200));
    const std::string blank(static_cast<std::size_t>(random.integer(0, 50)), " \n\t"[seed % 3]);
    EXPECT_TRUE(readMesh(test::kAsciiStl + blank, "a.stl", {}).warnings.empty()) << seed;
  }
  for (const std::string& behind : tails) {
    const Mesh mesh = readMesh(test::kAsciiStl + behind, "a.stl", {});
    EXPECT_EQ(mesh.triangles.size(), 2U);
    EXPECT_EQ(mesh.warnings.size(), 1U);
  }
}

TEST(MeshFileOdditiesTest, FacetsBehindThoseThatTheHeaderCountsAreRefused) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    const Triangles triangles = randomTriangles(random, 2);
    std::string stl = binaryStl(triangles);
    const auto counted =
        static_cast<std::uint32_t>(random.integer(0, static_cast<int>(triangles.size()) - 1));
    std::memcpy(&stl[80], &counted, sizeof counted);
    EXPECT_TRUE(has(errorOf([&] { (void)readMesh(stl, "a.stl", {}); }), "count")) << seed;
  }
  const std::string more =
      "facet outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet";
  EXPECT_TRUE(has(errorOf([&] { (void)readMesh(test::kAsciiStl + more, "a.stl", {}); }),
                  "more facets follow"));
}

TEST(MeshFileOdditiesTest, AWholeFileOfNothingIsAnEmptyMesh) {
  ColladaText bare;
  bare.faces = "";
  ColladaText none;
  none.faces = "<triangles count=\"0\"/>";
  ColladaText unplaced;
  unplaced.nodes = "<node/>";
  const std::vector<std::pair<std::string, std::string>> files{
      {binaryStl({}), "a.stl"},           {"solid a\nendsolid a\n", "a.stl"},
      {"# made by hand\no a\n", "a.obj"}, {collada(bare), "a.dae"},
      {collada(none), "a.dae"},           {collada(unplaced), "a.dae"}};
  for (const auto& [content, uri] : files) {
    const Mesh mesh = readMesh(content, uri, {});
    EXPECT_TRUE(mesh.vertices.empty() && mesh.triangles.empty()) << content;
    ASSERT_FALSE(mesh.warnings.empty()) << content;
    EXPECT_TRUE(has(mesh.warnings.back(), "empty")) << content;
  }
}

/// A whole file of each kind around those triangles, written as programs do.
std::pair<std::string, std::string> fileAround(const Triangles& triangles, Random& random) {
  const std::string made = "made by " + std::to_string(random.integer(0, 1000000));
  const std::string blank(static_cast<std::size_t>(random.integer(0, 3)), '\n');
  switch (random.integer(0, 3)) {
    case 0:
      return {binaryStl(triangles, random.chance(0.5) ? "solid " + made : made), "a.stl"};
    case 1:
      return {"solid " + made + "\n" + blank +
                  (triangles.empty() ? ""
                                     : "facet outer loop vertex 0 0 0 vertex 1 0 0 "
                                       "vertex 0 1 0 endloop endfacet\n") +
                  "endsolid " + (random.chance(0.5) ? made : "") + "\n",
              "a.stl"};
    case 2:
      return {"# " + made + "\n" + blank + "o part\n" + objOf(triangles, {}), "a.obj"};
    default:
      ColladaText text;
      text.asset += "<!-- " + made + " -->";
      if (!triangles.empty()) return {collada(text), "a.dae"};
      (random.chance(0.5) ? text.faces : text.nodes) = "";
      if (random.chance(0.3)) text.faces = "<triangles count=\"0\"/>";
      return {collada(text), "a.dae"};
  }
}

TEST(MeshFileOdditiesTest, RandomFilesOfNothingAreEmptyMeshesAndOthersHaveNoWarning) {
  for (unsigned seed = 0; seed < 4 * kMembers; ++seed) {
    Random random(seed);
    const auto [nothing, uri] = fileAround({}, random);
    const Mesh empty = readMesh(nothing, uri, {});
    EXPECT_TRUE(empty.vertices.empty() && empty.triangles.empty()) << nothing;
    ASSERT_FALSE(empty.warnings.empty()) << nothing;
    EXPECT_TRUE(has(empty.warnings.back(), "empty")) << nothing;
    const auto [something, its_uri] = fileAround(randomTriangles(random), random);
    const Mesh mesh = readMesh(something, its_uri, {});
    EXPECT_FALSE(mesh.triangles.empty()) << something;
    EXPECT_TRUE(mesh.warnings.empty()) << something;
  }
}

TEST(MeshFileOdditiesTest, WhatMayBeCutOffBeforeItsFacesIsNoEmptyMesh) {
  for (const std::string content :
       {"v 1 2 3\nv 4 5 6\n", "x", " \n\n", "<html>404</html>", "o a\nv 1 2 3\n"}) {
    EXPECT_TRUE(has(errorOf([&] { (void)readMesh(content, "a.obj", {}); }), "no face")) << content;
  }
  EXPECT_NE(errorOf([] { (void)readMesh(std::string(134, '\0'), "a.stl", {}); }), "");
}

TEST(MeshFileOdditiesTest, ColladaGeometriesWithoutFacesAreLeftOutBesideOneThatHasSome) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    const int bare = random.integer(1, 5);
    ColladaText text;
    text.libraries = "<library_geometries>";
    for (int i = 0; i < bare; ++i) {
      const std::string id = "h" + std::to_string(i);
      const std::vector<std::string> meshes{
          "<mesh/>", "<mesh><vertices id=\"w\"/></mesh>", "<mesh><triangles count=\"0\"/></mesh>",
          "<mesh><polylist count=\"0\">" + kInput + "</polylist></mesh>", "<spline/>"};
      const auto kind = static_cast<std::size_t>(random.integer(0, 4));
      text.libraries += "<geometry id=\"" + id + "\">" + meshes[kind] + "</geometry>";
      text.nodes += "<node><instance_geometry url=\"#" + id + "\"/></node>";
    }
    text.libraries += "</library_geometries>";
    const Mesh mesh = readMesh(collada(text), "a.dae", {});
    EXPECT_EQ(mesh.triangles.size(), 2U) << seed;
    ASSERT_EQ(mesh.warnings.size(), 1U) << seed;
    EXPECT_TRUE(has(mesh.warnings[0], std::to_string(bare) + " of its ")) << seed;
    ColladaText whole;
    for (int i = 0; i < bare; ++i) whole.nodes += whole.nodes.substr(whole.nodes.rfind("<node"));
    EXPECT_TRUE(readMesh(collada(whole), "a.dae", {}).warnings.empty()) << seed;
  }
}

TEST(MeshFileOdditiesTest, TheSharedMeshesThatWereRefusedAreLoadedWithAWarning) {
  const std::string folder = test::sharedDataFolder() + "/cases/mesh-too-strict/packages/m/";
  for (const char* name : {"emptygeo.dae", "trail1.stl"}) {
    std::ifstream file(folder + name, std::ios::binary);
    if (!file) GTEST_SKIP() << "no " << folder << name;
    const std::string content{std::istreambuf_iterator<char>(file), {}};
    const Mesh mesh = readMesh(content, name, {});
    EXPECT_FALSE(mesh.triangles.empty()) << name;
    EXPECT_EQ(mesh.warnings.size(), 1U) << name;
  }
}

}  // namespace
}  // namespace tccm
