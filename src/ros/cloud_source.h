#pragma once

#include <boost/shared_ptr.hpp>

#include "monitor_config.h"
#include "ros/scan_source.h"
#include "scan/cloud.h"

namespace tccm {

/// A cloud that waits is megabytes, used again when it has gone.
using SharedCloud = boost::shared_ptr<Cloud>;

[[nodiscard]] inline Time stampOf(const SharedCloud& cloud) { return cloud->stamp; }
[[nodiscard]] inline Time firstTimeOf(const SharedCloud& cloud) { return cloud->first(); }
[[nodiscard]] inline Time lastTimeOf(const SharedCloud& cloud) { return cloud->last(); }

/// Holds clouds until they can be placed.
class CloudSource : public WaitingScans<SharedCloud> {
 public:
  CloudSource(const CloudAssemblerConfig& config, const std::vector<std::string>& root_frames,
              const TransformHistory& transforms)
      : WaitingScans({config.fixed_frame, config.cloud.future_max_s, config.transform_sample_s,
                      config.transform_wait_max_s, kWaitingMax},
                     root_frames, transforms) {}

 private:
  static constexpr std::size_t kWaitingMax = 20;
};

}  // namespace tccm
