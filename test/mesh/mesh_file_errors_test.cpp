/// Mesh files that are damaged, cut off, or made to do harm.

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "mesh/mesh.h"
#include "support/mesh_texts.h"
#include "support/random.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using test::binaryStl;
using test::collada;
using test::ColladaText;

/// The error's text, which has to be one line that begins with the URI.
std::string errorOf(const std::string& content, const std::string& uri) {
  try {
    (void)readMesh(content, uri, {});
  } catch (const ConfigError& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.rfind(uri + ": ", 0), 0U) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    EXPECT_LT(text.size(), 1000U);
    return text;
  }
  ADD_FAILURE() << uri << ": nothing was thrown";
  return {};
}

void expectRefused(const ColladaText& text, const std::string& part) {
  const std::string error = errorOf(collada(text), "a.dae");
  EXPECT_NE(error.find(part), std::string::npos) << error;
}

std::string times(const std::string& text, int count) {
  std::string repeated;
  for (int i = 0; i < count; ++i) repeated += text;
  return repeated;
}

const std::string kInput = R"(<input semantic="VERTEX" source="#v" offset="0"/>)";
const Vector3 kOrigin = Vector3::Zero();

TEST(MeshFileErrorsTest, EmptyFilesGarbageAndOtherFormatsAreRefused) {
  test::Random random(1);
  std::string garbage;
  for (int i = 0; i < 100000; ++i) garbage += static_cast<char>(random.integer(0, 255));
  for (const char* uri : {"a.stl", "a.dae", "a.obj"}) {
    EXPECT_NE(errorOf("", uri).find("empty"), std::string::npos);
    for (const std::string& content :
         {garbage, std::string("x"), std::string(134, '\0'), std::string(" \n\n"),
          std::string("<html>404</html>"), std::string("version https://git-lfs\noid 1\n")}) {
      EXPECT_FALSE(errorOf(content, uri).empty());
    }
  }
  for (const char* uri : {"a.step", "a", "dir.stl/a", ".", "a.", "package://p/mesh.zae"}) {
    EXPECT_NE(errorOf(collada({}), uri).find("only"), std::string::npos);
  }
}

TEST(MeshFileErrorsTest, AnErrorStaysOneLineWhateverTheUriHolds) {
  try {
    (void)readMesh("", "a\nb\r\n\x01.stl" + std::string(5000, 'x'), {});
    FAIL() << "nothing was thrown";
  } catch (const ConfigError& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.find_first_of("\n\r\x01"), std::string::npos);
    EXPECT_LT(text.size(), 1000U);
  }
}

TEST(MeshFileErrorsTest, EveryCutOffStlIsRefused) {
  const std::string binary = binaryStl({{kOrigin, Vector3::UnitX(), Vector3::UnitY()}}, "solid");
  for (std::size_t size = 0; size < binary.size(); ++size) errorOf(binary.substr(0, size), "a.stl");
  const std::string ascii = test::kAsciiStl;
  const std::size_t whole = ascii.rfind("endsolid") + 8;
  for (std::size_t size = 0; size < whole; ++size) errorOf(ascii.substr(0, size), "a.stl");
}

TEST(MeshFileErrorsTest, EveryCutOffColladaIsRefused) {
  const std::string whole = collada({});
  for (std::size_t size = 0; size + 2 < whole.size(); ++size) {
    errorOf(whole.substr(0, size), "a.dae");
  }
}

TEST(MeshFileErrorsTest, CoordinatesThatAreNotFiniteOrBeyondAKilometreAreRefused) {
  for (const char* bad : {"nan", "inf", "-inf", "1e999", "1001", "-1000.1"}) {
    const std::string obj = "v 0 0 " + std::string(bad) + "\nv 0 0 0\nl 1 2\n";
    EXPECT_NE(errorOf(obj, "a.obj").find("1000 m"), std::string::npos);
    ColladaText text;
    text.array = "<float_array id=\"a\" count=\"12\">0 0 0 1 0 0 0 2 0 0 0 " + std::string(bad) +
                 "</float_array>";
    expectRefused(text, "1000 m");
    text.array.replace(text.array.find(bad), std::string(bad).size(), "3x");
    expectRefused(text, "3x");
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  errorOf(binaryStl({{kOrigin, kOrigin, Vector3(0, nan, 0)}}), "a.stl");
}

TEST(MeshFileErrorsTest, ObjFacesThatNameNoVertexAreRefused) {
  for (const char* face : {"f 1 2 4", "f 0 1 2", "f -4 1 2", "f 1 x 2", "f 1 2 99999999999", "f"}) {
    errorOf("v 0 0 0\nv 1 0 0\nv 0 1 0\n" + std::string(face) + "\n", "a.obj");
  }
  errorOf("v 0 0\n", "a.obj");
  errorOf("v 0 0 0 0\n", "a.obj");
}

TEST(MeshFileErrorsTest, ColladaCountsThatDoNotFitAreRefused) {
  for (const char* accessor :
       {"source=\"#a\" count=\"5\" stride=\"3\"", "source=\"#a\" count=\"300000000\" stride=\"3\"",
        "source=\"#a\" count=\"-1\" stride=\"3\"", "source=\"#a\" count=\"4\" stride=\"0\"",
        "source=\"#a\" count=\"4\" stride=\"2147483647\"",
        "source=\"#a\" count=\"4\" offset=\"1\" stride=\"3\"", "source=\"#b\" count=\"4\"",
        "source=\"other.dae#a\" count=\"4\"", "count=\"4\"", "source=\"#g\" count=\"4\""}) {
    ColladaText text;
    text.accessor = accessor;
    expectRefused(text, "a.dae: a");
  }
  for (const std::string& faces : std::vector<std::string>{
           "<triangles count=\"1\">" + kInput + "<p>0 1 4</p></triangles>",
           "<triangles count=\"1\">" + kInput + "<p>0 1 -1</p></triangles>",
           "<triangles count=\"2\">" + kInput + "<p>0 1 2</p></triangles>",
           "<triangles count=\"1\">" + kInput + "<p>0 1</p></triangles>",
           "<triangles count=\"1\"><p>0 1 2</p></triangles>",
           "<polylist count=\"1\">" + kInput + "<vcount>4</vcount><p>0 1 2</p></polylist>",
           "<polylist count=\"1\">" + kInput + "<vcount>2</vcount><p>0 1 2</p></polylist>",
           "<polylist count=\"2\">" + kInput + "<vcount>3</vcount><p>0 1 2</p></polylist>",
           "<polylist count=\"1\">" + kInput + "<vcount>-3</vcount><p>0 1 2</p></polylist>"}) {
    ColladaText text;
    text.faces = faces;
    expectRefused(text, "a <");
  }
}

TEST(MeshFileErrorsTest, ColladaTransformsAndUnitsThatAreNoneAreRefused) {
  for (const char* transform :
       {"<matrix>1 0 0 0 0 1 0 0 0 0 1 0</matrix>", "<rotate>0 0 0 90</rotate>",
        "<matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 0</matrix>", "<translate>nan 0 0</translate>",
        "<scale>1 1</scale>", "<skew>1 1 1 1 1 1 1</skew>", "<translate/>"}) {
    ColladaText text;
    text.nodes = "<node>" + std::string(transform) + "<instance_geometry url=\"#g\"/></node>";
    errorOf(collada(text), "a.dae");
  }
  for (const char* unit : {"0", "-1", "nan", "inf", "x", "1e9"}) {
    ColladaText text;
    text.asset = "<unit meter=\"" + std::string(unit) + "\"/>";
    errorOf(collada(text), "a.dae");
  }
}

TEST(MeshFileErrorsTest, CirclesAndBombsOfInstancesEnd) {
  ColladaText text;
  text.nodes = R"(<node id="n"><instance_geometry url="#g"/><instance_node url="#n"/></node>)";
  expectRefused(text, "circle");
  text.nodes = R"(<node><instance_controller url="#c"/></node>)";
  text.libraries = R"(<library_controllers><controller id="c"><skin source="#c"/></controller>
</library_controllers>)";
  expectRefused(text, "circle");
  text.nodes = R"(<node><instance_node url="#n40"/></node>)";
  text.libraries = R"(<library_nodes><node id="n0"/>)";
  for (int i = 1; i <= 40; ++i) {
    text.libraries += "<node id=\"n" + std::to_string(i) + "\">" +
                      times("<instance_node url=\"#n" + std::to_string(i - 1) + "\"/>", 2) +
                      "</node>";
  }
  text.libraries += "</library_nodes>";
  expectRefused(text, "too many");
}

TEST(MeshFileErrorsTest, DeepNestingAndEntityBombsEnd) {
  ColladaText text;
  text.nodes = times("<node>", 200000) + times("</node>", 200000);
  expectRefused(text, "DEPTH");
  std::string bomb = "<?xml version=\"1.0\"?><!DOCTYPE COLLADA [<!ENTITY a \"aaaaaaaaaa\">";
  for (char c = 'b'; c < 'p'; ++c) {
    const std::string before = "&" + std::string(1, static_cast<char>(c - 1)) + ";";
    bomb += "<!ENTITY " + std::string(1, c) + " \"" + times(before, 10) + "\">";
  }
  errorOf(bomb + "]><COLLADA>&o;</COLLADA>", "a.dae");
  errorOf(times("<a/>", 2'500'000), "a.dae");
}

TEST(MeshFileErrorsTest, FilesAndMeshesThatAreTooLargeAreRefused) {
  EXPECT_NE(errorOf(std::string(kMeshBytesMax + 1, 'x'), "a.obj").find("256 MB"),
            std::string::npos);
  std::string vertices, line = "l";
  for (std::size_t i = 0; i <= kMeshVerticesMax; ++i) {
    vertices += "v 0 0 " + std::to_string(static_cast<double>(i) * 1e-4) + "\n";
    line += " " + std::to_string(i + 1);
  }
  EXPECT_NE(errorOf(vertices + line, "a.obj").find("2 million"), std::string::npos);
}

/// Reads what may be damaged. @return whether it was taken for a mesh.
bool survives(const std::string& content, const std::string& uri) {
  try {
    const Mesh mesh = readMesh(content, uri, {});
    for (const Mesh::Triangle& t : mesh.triangles) {
      for (const std::uint32_t index : t) EXPECT_LT(index, mesh.vertices.size());
    }
    for (const Vector3& p : mesh.vertices) EXPECT_LE(p.cwiseAbs().maxCoeff(), 1e3);
    return true;
  } catch (const ConfigError&) {
    return false;
  }
}

TEST(MeshFileErrorsTest, RandomlyDamagedFilesAreReadOrRefusedAndNothingElse) {
  test::Random random(2);
  ColladaText text;
  text.faces += "<polylist count=\"2\">" + kInput +
                "<vcount>4 3</vcount><p>0 1 2 3 0 1 2</p></polylist><tristrips count=\"1\">" +
                kInput + "<p>0 1 2 3</p></tristrips>";
  text.nodes = R"(<node><matrix>0 -1 0 1 1 0 0 2 0 0 1 3 0 0 0 1</matrix><rotate>0 0 1 90</rotate>
<instance_geometry url="#g"/><instance_node url="#l"/></node>)";
  text.libraries = R"(<library_nodes><node id="l"><instance_geometry url="#g"/></node>
</library_nodes>)";
  const std::vector<std::pair<std::string, std::string>> files{
      {"a.stl", test::kAsciiStl},
      {"a.stl", binaryStl({{kOrigin, Vector3::UnitX(), Vector3::UnitY()},
                           {kOrigin, Vector3::UnitX(), Vector3::UnitZ()}})},
      {"a.obj", test::kObj},
      {"a.dae", collada(text)}};
  for (const auto& [uri, whole] : files) {
    ASSERT_TRUE(survives(whole, uri));
    int taken = 0;
    for (int i = 0; i < 5000; ++i) {
      std::string damaged = whole;
      const int last = static_cast<int>(whole.size()) - 1;
      if (random.chance(0.2)) damaged.resize(static_cast<std::size_t>(random.integer(0, last)));
      for (int flips = random.integer(0, 4); flips > 0 && !damaged.empty(); --flips) {
        const int place = random.integer(0, static_cast<int>(damaged.size()) - 1);
        damaged[static_cast<std::size_t>(place)] = static_cast<char>(
            random.chance(0.5) ? random.integer('0', '9') : random.integer(0, 255));
      }
      taken += survives(damaged, uri) ? 1 : 0;
    }
    EXPECT_GT(taken, 0) << uri;
    EXPECT_LT(taken, 5000) << uri;
  }
}

}  // namespace
}  // namespace tccm
