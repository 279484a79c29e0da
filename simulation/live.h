#pragma once

#include <ros/node_handle.h>
#include <ros/rate.h>

#include <cstdint>

#include "simulation/depth_image.h"
#include "tccm_monitor/time.h"

namespace tccm::simulation {

// What nodes share that simulate a robot live.

/// The parameter `seed`; 1 where it is not there. @throws ConfigError
[[nodiscard]] std::uint64_t seedOf(const ros::NodeHandle& node);
/// A camera with the parameter `camera_width`. @param width where it is not there. @throws
/// ConfigError
[[nodiscard]] Pinhole pinholeOf(const ros::NodeHandle& node, int width);

[[nodiscard]] Time wallNow();

/// Answers what came in, and has the simulation keep up with the wall clock, until shut down.
/// @param start of the simulation. @param wall_start when that was, or is taken to have been.
/// @param rate its seconds in one of the wall clock.
/// @param simulated its now() is moved on by step(). @param longest after which it ends; 0: never.
template <typename Simulated, typename Step>
void keepUp(const Simulated& simulated, Time start, Time wall_start, double rate, Duration longest,
            Step&& step) {
  ros::WallRate turns(500.0);
  while (ros::ok()) {
    const Duration elapsed = fromSeconds(rate * toSeconds(wallNow() - wall_start));
    ros::spinOnce();
    while (simulated.now() < start + elapsed && ros::ok()) step();
    if (longest > Duration::zero() && elapsed > longest) return;
    turns.sleep();
  }
}

}  // namespace tccm::simulation
