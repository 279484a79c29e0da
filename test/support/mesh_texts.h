#pragma once

#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "tccm_monitor/pose.h"

namespace tccm::test {

/// A binary STL of triangles of three corners each.
inline std::string binaryStl(const std::vector<std::array<Vector3, 3>>& triangles,
                             std::string header = "made by hand") {
  header.resize(80, ' ');
  const auto count = static_cast<std::uint32_t>(triangles.size());
  std::string content = header + std::string(reinterpret_cast<const char*>(&count), 4);
  for (const auto& triangle : triangles) {
    content += std::string(12, '\0');
    for (const Vector3& corner : triangle) {
      const Eigen::Vector3f p = corner.cast<float>();
      content += std::string(reinterpret_cast<const char*>(p.data()), 12);
    }
    content += std::string(2, '\0');
  }
  return content;
}

inline const char* const kAsciiStl = R"(solid two triangles
  facet normal 0 0 1
    outer loop
      vertex 0 0 0
      vertex 1 0 0
      vertex 0 2 0
    endloop
  endfacet
  facet normal nan nan nan
    outer loop
      vertex 1 0 0
      vertex 0 2 0
      vertex 0 0 -3e0
    endloop
  endfacet
endsolid two triangles
)";

inline const char* const kObj = R"(# a square and a line
mtllib missing.mtl
o thing
v 0 0 0
v 1 0 0 0.5 0.5 0.5
v 1 2 0
v 0 2 0
v 0 0 -3
vn 0 0 1
usemtl nothing
f 1//1 2//1 \
  3//1 4//1
l -1 1
)";

/// What differs between the COLLADA files of the tests.
struct ColladaText {
  std::string asset = "<unit meter=\"1\"/><up_axis>Z_UP</up_axis>";
  /// In <mesh>, after source #s of the vertices (0 0 0), (1 0 0), (0 2 0), (0 0 3) as #v.
  std::string faces =
      "<triangles count=\"2\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>"
      "<p>0 1 2 0 2 3</p></triangles>";
  std::string nodes = "<node id=\"n\"><instance_geometry url=\"#g\"/></node>";
  std::string libraries;
  std::string array = "<float_array id=\"a\" count=\"12\">0 0 0 1 0 0 0 2 0 0 0 3</float_array>";
  std::string accessor = "source=\"#a\" count=\"4\" stride=\"3\"";
};

inline std::string collada(const ColladaText& text) {
  return R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>)" +
         text.asset + R"(</asset>
<library_images><image id="i"><init_from>missing.png</init_from></image></library_images>
<library_geometries><geometry id="g"><mesh><source id="s">)" +
         text.array + "<technique_common><accessor " + text.accessor +
         R"(><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>)" +
         text.faces + "</mesh></geometry></library_geometries>" + text.libraries +
         "<library_visual_scenes><visual_scene id=\"sc\">" + text.nodes +
         "</visual_scene></library_visual_scenes>"
         "<scene><instance_visual_scene url=\"#sc\"/></scene></COLLADA>\n";
}

}  // namespace tccm::test
