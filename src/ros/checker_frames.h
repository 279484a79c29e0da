#pragma once

#include <string>

#include "ros/transform_history.h"
#include "tccm_monitor/checker.h"

namespace tccm {

/// Tells a checker where transforms put the roots of its robot, and the frames of exemptions.
void placeFrames(const TransformHistory& transforms, const std::string& fixed_frame,
                 Checker& checker);
/// The frames of exemptions alone.
void placeExemptFrames(const TransformHistory& transforms, const std::string& fixed_frame,
                       Checker& checker);
/// Where fixed frame and a root are one, no transform has to be heard.
void placeRootsInFixedFrame(const std::string& fixed_frame, Checker& checker);

}  // namespace tccm
