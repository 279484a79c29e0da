#include "ros/checker_frames.h"

#include <cstddef>
#include <vector>

namespace tccm {

void placeFrames(const TransformHistory& transforms, const std::string& fixed_frame,
                 Checker& checker) {
  const std::vector<std::string>& roots = checker.model()->rootFrames();
  for (std::size_t i = 0; i < roots.size(); ++i) {
    const auto root = transforms.newest(fixed_frame, roots[i]);
    if (root) checker.setRootPose(i, root->stamp, root->pose, root->is_static);
  }
  placeExemptFrames(transforms, fixed_frame, checker);
}

void placeExemptFrames(const TransformHistory& transforms, const std::string& fixed_frame,
                       Checker& checker) {
  for (const std::string& frame : checker.exemptFrames()) {
    const auto place = transforms.newest(fixed_frame, frame);
    if (place) checker.setExemptFrame(frame, place->stamp, place->pose, place->is_static);
  }
}

void placeRootsInFixedFrame(const std::string& fixed_frame, Checker& checker) {
  const std::vector<std::string>& roots = checker.model()->rootFrames();
  for (std::size_t i = 0; i < roots.size(); ++i) {
    if (roots[i] == fixed_frame) checker.setRootPose(i, Time(), Pose::Identity(), true);
  }
}

}  // namespace tccm
