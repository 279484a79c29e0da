#pragma once

#include <vector>

#include "robot/robot_model.h"

namespace tccm {

/// The model's shapes that a use takes, expanded; not placed yet.
inline Body bodyOf(const RobotModel& model, const UsedShapes& used) {
  Body body;
  for (std::size_t i = 0; i < used.shapes.size(); ++i) {
    body.shapes.push_back(expanded(model.shapes()[used.shapes[i]].shape, used.expansions[i]));
  }
  body.poses.resize(body.shapes.size(), Pose::Identity());
  return body;
}

/// @param poses of all of the model's shapes.
inline void place(const std::vector<std::size_t>& shapes, const std::vector<Pose>& poses,
                  Body& body) {
  for (std::size_t i = 0; i < shapes.size(); ++i) body.poses[i] = poses[shapes[i]];
}

/// Around each shape's frame, with whatever it may grow by.
inline std::vector<double> radiiOf(const Body& body, double margin_m) {
  std::vector<double> radii;
  for (const Shape& shape : body.shapes) {
    radii.push_back(boundingRadius(expanded(shape, {1.0, margin_m})));
  }
  return radii;
}

}  // namespace tccm
