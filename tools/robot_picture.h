#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tccm_monitor/robot_model.h"

namespace tccm {

/// A model's primitives for scripts/draw_primitives. @param T_fixed_shapes one for each of them.
[[nodiscard]] nlohmann::ordered_json primitivesJson(const RobotModel& model,
                                                    const std::vector<Pose>& T_fixed_shapes);
/// @param scene as scripts/draw_primitives reads it. @param picture PNG file to write.
/// @throws InputError where it could not be drawn.
void drawPrimitives(const nlohmann::ordered_json& scene, const std::string& picture);

}  // namespace tccm
