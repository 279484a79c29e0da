#pragma once

#include <string>

#include "simulation/simulator.h"

namespace tccm::simulation {

/// Another monitor of the simulated robot, which its arms obey in place of the one beside them.
class Guardian {
 public:
  struct Word {
    bool stop = true;
    double speed_scale = 0.0;
    std::string reason;  ///< the gravest; empty where all is clear
  };
  virtual ~Guardian() = default;
  /// Hears what came up in the simulator's last step. @return what is allowed now.
  virtual Word watch(const Simulator& simulator, const StepOutput& output) = 0;
};

}  // namespace tccm::simulation
