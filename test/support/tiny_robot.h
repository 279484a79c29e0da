#pragma once

#include <memory>
#include <string>

#include "tccm_monitor/robot_model.h"

namespace tccm::test {

/// URDF text put together by hand. Numbers are handed over as text, so that they may be wrong.
inline namespace urdf_text {

inline std::string robotOf(const std::string& elements) {
  return "<robot name=\"tiny\">" + elements + "</robot>";
}

inline std::string collisionOf(const std::string& geometry, const std::string& xyz = "0 0 0") {
  return "<collision><origin xyz=\"" + xyz + "\"/><geometry>" + geometry +
         "</geometry></collision>";
}

inline std::string sphereOf(const std::string& radius) {
  return "<sphere radius=\"" + radius + "\"/>";
}

inline std::string linkOf(const std::string& name, const std::string& collisions = "") {
  return "<link name=\"" + name + "\">" + collisions + "</link>";
}

/// A link with one ball of 50 mm.
inline std::string ballLink(const std::string& name) {
  return linkOf(name, collisionOf(sphereOf("0.05")));
}

inline std::string jointOf(const std::string& name, const std::string& type,
                           const std::string& parent, const std::string& child,
                           const std::string& more = "") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent +
         "\"/><child link=\"" + child + "\"/>" + more + "</joint>";
}

inline std::string axisOf(const std::string& xyz) { return "<axis xyz=\"" + xyz + "\"/>"; }

inline std::string limitOf(const std::string& lower, const std::string& upper) {
  return "<limit lower=\"" + lower + "\" upper=\"" + upper + "\" effort=\"1\" velocity=\"1\"/>";
}

}  // namespace urdf_text

/// Two balls of 50 mm that slide along x: "hand" by the joint "slide" from -0.5 to 1.0 m, at y = 0,
/// and "other" by the joint "glide" without such limits, at y = 0.5. Both at z = 0.5.
inline std::string sliderUrdf() {
  const std::string along_x = axisOf("1 0 0");
  return robotOf(linkOf("base") + ballLink("hand") + ballLink("other") +
                 jointOf("slide", "prismatic", "base", "hand",
                         "<origin xyz=\"0 0 0.5\"/>" + along_x + limitOf("-0.5", "1.0")) +
                 jointOf("glide", "prismatic", "base", "other",
                         "<origin xyz=\"0 0.5 0.5\"/>" + along_x + limitOf("-100", "100")));
}

inline std::shared_ptr<const RobotModel> modelOf(const std::string& urdf,
                                                 const RobotModel::Config& config = {}) {
  return std::make_shared<const RobotModel>(urdf, config);
}

inline std::shared_ptr<const RobotModel> sliderModel() { return modelOf(sliderUrdf()); }

}  // namespace tccm::test
