#pragma once

#include "fit/primitives_file.h"
#include "tccm_monitor/robot_model.h"

namespace tccm {

/// A model's shapes, as a file of primitives has them.
[[nodiscard]] inline LinkPrimitives primitivesOf(const RobotModel& model) {
  LinkPrimitives links;
  for (std::size_t i = 0; i < model.shapes().size(); ++i) {
    const LinkShape& shape = model.shapes()[i];
    links[model.linkOf(i)].push_back({shape.shape, shape.T_link_shape});
  }
  return links;
}

}  // namespace tccm
