#pragma once

#include <nlohmann/json.hpp>

#include "check/checker_config.h"
#include "ros/stop_cause.h"

namespace tccm {

/// What a check found, to be drawn; all places in the fixed frame [m].
///
/// robot, robot_ahead: the primitives as they are checked, paddings included; the latter where what
/// is ahead decides. concerned: links. flagged: cuboids, and why: touched, hides, or of what
/// brought the stop about (was_touched, was_hiding). cuboids, held: the map's others around.
/// regions: to keep out of. unseen: places that links go through. sensors: where each was, and
/// whether it saw what is flagged. point: what all is about. Missing is what is not known or of no
/// concern.
/// @param cause as it follows the verdicts, this one included.
[[nodiscard]] nlohmann::ordered_json sceneOf(const Verdict& verdict, const Checker& checker,
                                             const StopCause& cause);

/// The primitives as they are checked for collision where they were placed last.
[[nodiscard]] nlohmann::ordered_json placedShapes(const PoseCheck& check, const RobotModel& model);

/// Of a map, the cuboids, least x, y, z and largest, apart by whether they are held; of too many
/// those nearest to a place. left_out is how many are not there.
[[nodiscard]] nlohmann::ordered_json cuboidsOf(const CuboidMap& map, const Vector3& near,
                                               std::size_t count_max);

[[nodiscard]] nlohmann::ordered_json coordinates(const Vector3& place);

}  // namespace tccm
